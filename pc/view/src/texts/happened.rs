//! What happened, in words.

use super::{Text, Words};
use crate::access::{Event, Level};
use crate::live::What;

impl Words {
    /// What happened.
    pub fn happened(self, what: &What) -> String {
        match what {
            What::Phase(phase) => self.phase(*phase),
            What::Question(question) => self.question(question),
            What::Connected(firmware) => self.with(Text::Connected, &[&firmware.join(", ")]),
            What::Finished => self.say(Text::JobFinished).to_owned(),
            What::MotionFault(fault) => self.fault(fault),
            What::TrackerFault(fault) => self.tracker_fault(fault),
            What::Stopped => self.say(Text::StoppedByOperator).to_owned(),
            What::FileWritten(file, version) => self.with(Text::FileWritten, &[file, version]),
            What::FileMade(file) => self.with(Text::FileMade, &[file]),
            What::Parameter(change) => self.change(change),
            What::Access(event) => self.access(*event),
            What::RecordUnwritten(error) => self.with(Text::RecordUnwritten, &[error]),
            What::SettingsUnread(error) => self.with(Text::SettingsUnread, &[error]),
            What::SettingsUnwritten(error) => self.with(Text::SettingsUnwritten, &[error]),
            What::Said(text) => text.clone(),
        }
    }

    /// The name of a level.
    pub fn level(self, level: Level) -> &'static str {
        self.say(match level {
            Level::Operator => Text::Operator,
            Level::Setter => Text::Setter,
            Level::Engineer => Text::Engineer,
        })
    }

    fn access(self, event: Event) -> String {
        match event {
            Event::Entered(level) => self.with(Text::LevelEntered, &[self.level(level)]),
            Event::Locked => self.say(Text::ScreenLocked).to_owned(),
            Event::FellBack => self.say(Text::LevelFellBack).to_owned(),
            Event::WrongPin => self.say(Text::WrongPinEntered).to_owned(),
            Event::PinSet(level) => self.with(Text::PinSet, &[self.level(level)]),
            Event::PinTakenAway(level) => self.with(Text::PinTakenAway, &[self.level(level)]),
        }
    }
}
