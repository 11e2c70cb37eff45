//! The work offsets: origins of coordinate systems, as values or by where the tip stands.

use super::pad;
use super::sightings::Sightings;
use crate::screen::View;
use crate::station::{Action, Station};
use crate::texts::Text;
use config::sentence;
use config::work_offsets::{MOST, System, WorkOffset, WorkOffsets};
use eframe::egui::{Button, Color32, Grid, Id, Label, Modal, RichText, Ui, vec2};
use shared::io::{AXES, AXIS_NAMES, SIDES};

/// Width of the dialog \[points\].
const WIDTH: f32 = 900.0;
/// Size of a coordinate system \[points\].
const SYSTEM: [f32; 2] = [90.0, 44.0];
/// Size of a value \[points\].
const ROW: [f32; 2] = [170.0, 44.0];
/// Size of what is told of a seam \[points\].
const SEAM: [f32; 2] = [340.0, 52.0];
/// Index of the rotation among what is chosen: after the axes.
const ROTATION: usize = AXES;

/// What is being set.
pub(super) struct Dialog {
    before: WorkOffsets,
    edited: WorkOffsets,
    system: System,
    /// Index of an axis, or [`ROTATION`].
    chosen: usize,
    typed: String,
    failed: Option<String>,
    sightings: Sightings,
}

/// What was asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    Nothing,
    Save,
    Close,
}

impl Dialog {
    /// What the file says now.
    ///
    /// # Errors
    /// A sentence: it cannot be read.
    pub fn open(station: &Station) -> Result<Self, String> {
        let before = WorkOffsets::beside(station.machine_file()).map_err(|error| sentence(&error))?;
        Ok(Self {
            edited: before.clone(),
            before,
            system: System::G54,
            chosen: 0,
            typed: String::new(),
            failed: None,
            sightings: Sightings::default(),
        })
    }

    /// Whether it stays open.
    pub fn show(&mut self, ui: &mut Ui, view: &View, station: &mut Station) -> bool {
        if !station.may(Action::WorkOffsets, view.now) {
            return false;
        }
        let mut asked = Asked::Nothing;
        let modal = Modal::new(Id::unique("work offsets")).show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.heading(view.words.say(Text::WorkOffsetsTitle));
            let hint = RichText::new(view.words.say(Text::WorkOffsetsHint)).color(view.theme.faint);
            ui.add(Label::new(hint).wrap());
            ui.add_space(8.0);
            ui.horizontal(|ui| self.systems(ui));
            ui.add_space(8.0);
            let tip = tip(station);
            self.sightings.take(station);
            ui.horizontal_top(|ui| {
                ui.allocate_ui(vec2(WIDTH - pad::WIDTH - 24.0, 0.0), |ui| {
                    ui.vertical(|ui| {
                        self.values(ui, view, station, tip.as_ref());
                        self.by_camera(ui, view, station, tip.as_ref());
                    });
                });
                ui.add_space(40.0);
                ui.vertical(|ui| self.pad(ui, view, tip.as_ref()));
            });
            ui.add_space(8.0);
            if let Some(failed) = &self.failed {
                ui.add(Label::new(RichText::new(failed).color(view.theme.bad)).wrap());
            }
            ui.horizontal(|ui| asked = self.buttons(ui, view));
        });
        match asked {
            Asked::Save => match station.set_work_offsets(&self.edited, view.now) {
                Ok(()) => return false,
                Err(error) => self.failed = Some(sentence(error.as_ref())),
            },
            Asked::Close => return false,
            Asked::Nothing => {}
        }
        !modal.should_close()
    }

    fn systems(&mut self, ui: &mut Ui) {
        for system in System::ALL {
            let changed = self.edited.of(system) != self.before.of(system);
            let mark = if changed { "● " } else { "" };
            let text = RichText::new(format!("{mark}{}", system.name())).size(18.0);
            let button = Button::selectable(self.system == system, text).min_size(SYSTEM.into());
            if ui.add(button).clicked() {
                self.system = system;
            }
        }
    }

    /// Origin, and where the tip is from there.
    fn values(&mut self, ui: &mut Ui, view: &View, station: &Station, tip: Option<&[f64; AXES]>) {
        let words = view.words;
        let (offset, before) = (self.edited.of(self.system), self.before.of(self.system));
        let tip_in = words.with(Text::TipIn, &[self.system.name()]);
        let own = tip.map(|tip| offset.coordinates(tip));
        let fitted = fitted(station);
        Grid::new("work offset")
            .num_columns(3)
            .spacing([12.0, 4.0])
            .show(ui, |ui| {
                for heading in ["", words.say(Text::Origin), &tip_in] {
                    ui.label(RichText::new(heading).size(13.0).color(view.theme.faint));
                }
                ui.end_row();
                let axes = (0..AXES).filter(|axis| *axis < 3 || fitted[*axis]);
                for row in axes.chain([ROTATION]) {
                    let name = AXIS_NAMES
                        .get(row)
                        .copied()
                        .unwrap_or(words.say(Text::TurnAboutZ));
                    let label = ui.label(RichText::new(name).size(18.0).strong());
                    let value = value(&offset, row);
                    let mark = if value == self::value(&before, row) {
                        ""
                    } else {
                        "● "
                    };
                    let text = format!("{mark}{value:.3} {}", unit(row));
                    let text = RichText::new(text).monospace().size(18.0);
                    let button = Button::selectable(self.chosen == row, text).min_size(ROW.into());
                    if ui.add(button).labelled_by(label.id).clicked() {
                        self.chosen = row;
                    }
                    // No -0.
                    let here = own.and_then(|own| own.get(row).map(|here| (here * 1e3).round() / 1e3 + 0.0));
                    let here = here.map_or_else(String::new, |here| format!("{here:9.3} {}", unit(row)));
                    ui.label(RichText::new(here).monospace().size(18.0));
                    ui.end_row();
                }
            });
        if tip.is_none() {
            let text = RichText::new(words.say(Text::NotHomed)).color(view.theme.faint);
            ui.add(Label::new(text).wrap());
        }
    }

    /// Where the cameras see their seams in the system that is chosen, to be set for what is chosen.
    fn by_camera(&mut self, ui: &mut Ui, view: &View, station: &Station, tip: Option<&[f64; AXES]>) {
        let Some(tip) = tip else { return };
        let words = view.words;
        ui.add_space(8.0);
        let offset = self.edited.of(self.system);
        let typed = number(&self.typed);
        for side in (0..SIDES).filter(|side| station.live.pictures[*side].is_some()) {
            let seam = self.sightings.of(side, tip);
            let number = (side + 1).to_string();
            let at = seam.map_or_else(
                || words.say(Text::NoSeamInPicture).to_owned(),
                |seam| {
                    let [x, y, z, ..] = offset.coordinates(&seam).map(|at| (at * 1e3).round() / 1e3 + 0.0);
                    format!("X {x:.3}  Y {y:.3}  Z {z:.3} mm")
                },
            );
            let name = words.with(Text::SeamIn, &[&number, self.system.name()]);
            ui.horizontal(|ui| {
                ui.allocate_ui(SEAM.into(), |ui| {
                    ui.vertical(|ui| {
                        ui.set_min_size(SEAM.into());
                        ui.label(RichText::new(name).size(13.0).color(view.theme.faint));
                        ui.label(RichText::new(at).monospace().size(16.0));
                    });
                });
                let may = typed.is_some() && self.chosen < 3;
                let set = pad::button(words.with(Text::SeamIs, &[&number]));
                if let (true, Some(seam)) = (ui.add_enabled(may && seam.is_some(), set).clicked(), seam) {
                    self.set(typed, |offset, axis, typed| offset.touch_off(axis, &seam, typed));
                }
            });
        }
    }

    /// A value for what is chosen.
    fn pad(&mut self, ui: &mut Ui, view: &View, tip: Option<&[f64; AXES]>) {
        pad::show(ui, view, &mut self.typed, "");
        // Nothing typed is 0.
        let typed = number(&self.typed);
        if pad::sets(ui, view, Text::OriginIs, typed.is_some()) {
            self.set(typed, |offset, chosen, typed| match chosen {
                ROTATION => offset.rotation_deg = typed,
                axis => offset.origin[axis] = typed,
            });
        }
        let tip = tip.filter(|_| self.chosen != ROTATION);
        if pad::sets(ui, view, Text::TipIs, typed.is_some() && tip.is_some())
            && let Some(tip) = tip
        {
            self.set(typed, |offset, axis, typed| offset.touch_off(axis, tip, typed));
        }
        if typed.is_none() {
            let text = RichText::new(view.words.say(Text::NotAnOffset)).color(view.theme.doubt);
            ui.add(Label::new(text).wrap());
        }
    }

    fn set(&mut self, typed: Option<f64>, how: impl FnOnce(&mut WorkOffset, usize, f64)) {
        let Some(typed) = typed else { return };
        let mut offset = self.edited.of(self.system);
        how(&mut offset, self.chosen, typed);
        self.edited.set(self.system, offset);
        self.typed.clear();
    }

    fn buttons(&self, ui: &mut Ui, view: &View) -> Asked {
        let text = RichText::new(view.words.say(Text::Save))
            .size(20.0)
            .color(Color32::BLACK);
        let save = Button::new(text)
            .fill(view.theme.good)
            .min_size([200.0, 60.0].into());
        let cancel = Button::new(view.words.say(Text::Cancel)).min_size([200.0, 60.0].into());
        let changed = self.edited != self.before;
        let saved = ui.add_enabled(changed, save).clicked();
        match (saved, ui.add(cancel).clicked()) {
            (true, _) => Asked::Save,
            (_, true) => Asked::Close,
            _ => Asked::Nothing,
        }
    }
}

/// The tip, where the machine is under hand and knows it.
fn tip(station: &Station) -> Option<[f64; AXES]> {
    let (machine, motion) = station.by_hand().zip(station.live.motion.as_ref())?;
    let tip = machine.planner.tip(&motion.axes);
    let mut at = [0.0; AXES];
    at[..3].copy_from_slice(tip.position_mm.as_slice());
    at[3..].copy_from_slice(&tip.angles_deg);
    motion.homed.then_some(at)
}

/// The axes that the machine has; all of them where that is not known.
fn fitted(station: &Station) -> [bool; AXES] {
    station
        .by_hand()
        .map_or([true; AXES], |machine| machine.planner.fitted())
}

fn value(offset: &WorkOffset, row: usize) -> f64 {
    offset.origin.get(row).copied().unwrap_or(offset.rotation_deg)
}

fn unit(row: usize) -> &'static str {
    if row < 3 { "mm" } else { "°" }
}

/// What is typed; nothing is 0.
fn number(typed: &str) -> Option<f64> {
    let typed = typed.trim().replace(',', ".");
    if typed.is_empty() {
        return Some(0.0);
    }
    let number: f64 = typed.parse().ok()?;
    (number.abs() <= MOST).then_some(number)
}
