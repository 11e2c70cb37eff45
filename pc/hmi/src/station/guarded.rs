//! What needs an access level, and what is put on record.

use super::{Action, Station};
use crate::access::{Access, Event, Level, Refusal};
use crate::live::Earlier;
use anyhow::bail;
use host_link::{ByHand, Command};
use std::time::Duration;

impl Action {
    /// The level that it needs.
    pub fn level(self) -> Level {
        match self {
            Self::Load
            | Self::Start
            | Self::Stop
            | Self::Hold
            | Self::Resume
            | Self::Back
            | Self::Override
            | Self::Off => Level::Operator,
            Self::Home
            | Self::ByHand
            | Self::Jog
            | Self::Teach
            | Self::Lesson
            | Self::WorkOffsets
            | Self::Tools
            | Self::WeldData => Level::Setter,
            Self::Write | Self::Commission => Level::Engineer,
        }
    }
}

/// The level that `command` needs: what stops or ends something needs none.
pub(super) fn level_of(command: &Command) -> Level {
    match command {
        Command::ByHand(ByHand::Jog(_) | ByHand::Block(_)) | Command::Answer(_) => Level::Setter,
        Command::ByHand(ByHand::LetGo | ByHand::Off)
        | Command::Hold
        | Command::Resume
        | Command::Back
        | Command::Override(_)
        | Command::Stop
        | Command::SingleBlock(_)
        | Command::Unattended => Level::Operator,
    }
}

impl Station {
    /// Who may do what.
    pub fn access(&self) -> &Access {
        &self.access
    }

    /// Whether the level is enough for `action`, whether or not it makes sense now.
    pub fn allows(&self, action: Action) -> bool {
        self.access.allows(action.level())
    }

    /// The same, as an error.
    ///
    /// # Errors
    /// The level that it needs.
    pub(super) fn check(&self, action: Action) -> anyhow::Result<()> {
        if !self.allows(action) {
            bail!("needs the access level {}", action.level());
        }
        Ok(())
    }

    /// Does `what` to what is being taught, if the level is enough for it.
    ///
    /// # Errors
    /// The level that it needs, or what comes of it.
    pub fn teach<T>(&self, what: impl FnOnce() -> anyhow::Result<T>) -> anyhow::Result<T> {
        self.check(Action::Teach)?;
        what()
    }

    /// With the PINs of before.
    pub fn set_access(&mut self, access: Access) {
        self.access = access;
    }

    /// Somebody touches the screen.
    pub fn touch(&mut self, now: Duration) {
        self.access.touch(now);
    }

    /// Lets in by a PIN.
    ///
    /// # Errors
    /// It is wrong, or has to wait.
    pub fn enter(&mut self, pin: &str, now: Duration) -> Result<(), Refusal> {
        self.put_on_record(now);
        let entered = self.access.enter(pin, now);
        match entered {
            Ok(level) => self.live.journal.access(now, Event::Entered(level)),
            Err(Refusal::WrongPin) => self.live.journal.access(now, Event::WrongPin),
            Err(_) => {}
        }
        entered.map(|_| ())
    }

    /// An operator's again.
    pub fn lock(&mut self, now: Duration) {
        self.put_on_record(now);
        if self.access.lock() {
            self.live.journal.access(now, Event::Locked);
        }
    }

    /// Sets the PIN of `level`, or takes it away.
    ///
    /// # Errors
    /// Why not.
    pub fn set_pin(&mut self, level: Level, pin: Option<&str>, now: Duration) -> Result<(), Refusal> {
        self.access.set_pin(level, pin)?;
        let event = match pin {
            Some(_) => Event::PinSet(level),
            None => Event::PinTakenAway(level),
        };
        self.live.journal.access(now, event);
        Ok(())
    }

    /// What is on record of before the screen was opened, oldest first.
    pub fn earlier(&self) -> &[Earlier] {
        &self.earlier
    }

    /// Puts on record what happened since the last turn, at the level that it happened at, and falls back from that after a while.
    pub(super) fn guard(&mut self, now: Duration) {
        self.put_on_record(now);
        if self.access.turn(now) {
            self.live.journal.access(now, Event::FellBack);
        }
    }

    fn put_on_record(&mut self, now: Duration) {
        for entry in self.live.journal.take_unrecorded() {
            self.record.add(&entry, self.access.level());
        }
        if let Some(error) = self.record.trouble() {
            let error = config::sentence(error.as_ref());
            self.live.journal.record_unwritten(now, &error);
        }
    }
}

/// What is left is put on record too, before it is closed.
pub(super) fn close(station: &mut Station) {
    station.put_on_record(Duration::ZERO);
}
