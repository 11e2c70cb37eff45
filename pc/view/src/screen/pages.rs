//! The pages by name, and how one is chosen.

use super::{RAIL, View};
use crate::texts::Text;
use eframe::egui::{self, Key, Modifiers, RichText, TextWrapMode, Ui};

/// A page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Page {
    /// The job.
    #[default]
    Run,
    /// Setting up the machine.
    SetUp,
    /// Teaching places of the tip.
    Teach,
    /// Signals of the boards over time.
    Plot,
    /// What went wrong, and what happened.
    Alarms,
    /// Past jobs.
    Welds,
    /// The machine file.
    Parameters,
    /// Motors and circles.
    Commission,
    /// The screen itself.
    Settings,
}

impl Page {
    /// All pages, in the order of their keys.
    pub const ALL: [Self; 9] = [
        Self::Run,
        Self::SetUp,
        Self::Teach,
        Self::Plot,
        Self::Alarms,
        Self::Welds,
        Self::Parameters,
        Self::Commission,
        Self::Settings,
    ];

    /// Its name.
    pub fn name(self) -> Text {
        match self {
            Self::Run => Text::Run,
            Self::SetUp => Text::SetUp,
            Self::Teach => Text::Teach,
            Self::Plot => Text::LivePlot,
            Self::Alarms => Text::Alarms,
            Self::Welds => Text::Welds,
            Self::Parameters => Text::Parameters,
            Self::Commission => Text::Commission,
            Self::Settings => Text::Settings,
        }
    }
}

/// A button for each of `pages`; the one that is tapped.
pub fn rail(ui: &mut Ui, view: &View, pages: &[Page], shown: Page, open_alarms: usize) -> Option<Page> {
    let mut tapped = None;
    for page in pages {
        let mut name = view.words.say(page.name()).to_owned();
        if *page == Page::Alarms && open_alarms > 0 {
            name.push_str(&format!(" ({open_alarms})"));
        }
        let text = RichText::new(name).size(16.0);
        let button = egui::Button::selectable(shown == *page, text).wrap_mode(TextWrapMode::Extend);
        let button = button.min_size([RAIL - 16.0, 56.0].into());
        if ui.add(button).clicked() {
            tapped = Some(*page);
        }
    }
    tapped
}

/// The one of `pages` whose number is pressed with Ctrl.
pub fn by_key(ui: &Ui, pages: &[Page]) -> Option<Page> {
    let numbers = [
        Key::Num1,
        Key::Num2,
        Key::Num3,
        Key::Num4,
        Key::Num5,
        Key::Num6,
        Key::Num7,
        Key::Num8,
        Key::Num9,
    ];
    let pressed = |key| {
        ui.ctx()
            .input_mut(|input| input.consume_key(Modifiers::CTRL, key))
    };
    let mut numbered = numbers.into_iter().zip(pages);
    numbered.find(|(key, _)| pressed(*key)).map(|(_, page)| *page)
}
