//! Of the page of the screen: the level now, and the PINs.

use super::View;
use super::access::{Purpose, ask, said};
use crate::access::Level;
use crate::station::Station;
use crate::texts::Text;
use eframe::egui::{Button, Label, RichText, Ui};

/// Size of a button \[points\].
const BUTTON: [f32; 2] = [250.0, 52.0];

/// What the page remembers between two frames: why a PIN was not taken away.
pub(super) type Refused = Option<Text>;

pub(super) fn show(ui: &mut Ui, view: &View, station: &mut Station, refused: &mut Refused) {
    let words = view.words;
    let access = station.access();
    ui.horizontal(|ui| {
        ui.label(words.say(Text::LevelNow));
        if access.is_restricted() {
            ui.label(RichText::new(words.level(access.level())).size(18.0).strong());
        }
    });
    let told = if access.is_unreadable() {
        Some((Text::PinsUnreadable, view.theme.bad))
    } else if access.is_restricted() {
        refused.map(|text| (text, view.theme.bad))
    } else {
        Some((Text::NoPinSet, view.theme.doubt))
    };
    if let Some((text, colour)) = told {
        ui.add(Label::new(RichText::new(words.say(text)).color(colour)).wrap());
    }
    let (may_lock, is_engineer) = (
        access.is_restricted() && access.level() > Level::Operator,
        access.allows(Level::Engineer),
    );
    let has = |level| station.access().has_pin(level);
    let pins = [Level::Engineer, Level::Setter].map(|level| (level, has(level)));
    let lets_in = access.pins().is_some();
    ui.horizontal(|ui| {
        ui.add_enabled_ui(lets_in, |ui| ask(ui, view, [160.0, BUTTON[1]]));
        let lock = Button::new(words.say(Text::LockScreen)).min_size([160.0, BUTTON[1]].into());
        if ui.add_enabled(may_lock, lock).clicked() {
            station.lock(view.now);
        }
    });
    for (level, is_set) in pins {
        ui.horizontal(|ui| {
            // Nobody else has one before the engineer.
            let may_set = is_engineer && (level == Level::Engineer || lets_in);
            let name = words.level(level);
            let set = Button::new(words.with(Text::SetPinOf, &[name])).min_size(BUTTON.into());
            if ui.add_enabled(may_set, set).clicked() {
                *refused = None;
                view.asks.set(Some(Purpose::Set(level)));
            }
            let take_away = Button::new(words.with(Text::TakePinAway, &[name])).min_size(BUTTON.into());
            if ui.add_enabled(is_engineer && is_set, take_away).clicked() {
                *refused = station.set_pin(level, None, view.now).err().map(said);
            }
        });
    }
    if !is_engineer {
        let text = words.with(Text::NeedsLevel, &[words.level(Level::Engineer)]);
        ui.label(RichText::new(text).color(view.theme.doubt));
    }
}
