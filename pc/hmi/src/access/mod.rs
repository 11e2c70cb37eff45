//! Who may do what at the screen: levels, which PINs let in.
//!
//! Without PINs everything is allowed. With them the screen is an operator's until a PIN is entered, and again when it is locked or
//! nobody has touched it for a while. There is no level between these: who may more may all that others may.

mod pins;

pub use pins::{HashedPin, Pins};
pub use view::access::{Event, Level};

use std::time::Duration;

/// A level that nobody has used for so long falls back to the operator's.
pub const UNTOUCHED: Duration = Duration::from_secs(600);
/// Wrong PINs one after the other before the first wait.
const WRONG_AT_ONCE: u32 = 3;
/// The first wait; each further wrong PIN doubles it.
const FIRST_WAIT: Duration = Duration::from_secs(10);
/// The longest wait.
const LONGEST_WAIT: Duration = Duration::from_secs(600);

/// Why something about PINs was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It is not the PIN of a level.
    WrongPin,
    /// After wrong ones, for so long.
    Wait(Duration),
    /// A PIN has 4 to 8 digits.
    NotAPin,
    /// Another level has it.
    Taken,
    /// The engineer's is set before others, and taken away after them.
    EngineerFirst,
    /// A level is needed for it.
    Needs(Level),
    /// There is no salt to be had.
    NoRandomness,
}

/// What lets in.
#[derive(Clone, Debug, Default, PartialEq)]
enum Lock {
    /// Everything is allowed.
    #[default]
    None,
    Pins(Pins),
    /// There may be PINs, but nobody can read them: nothing lets in.
    Unreadable,
}

/// See the module. Times are by the screen's clock.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Access {
    lock: Lock,
    level: Level,
    touched: Duration,
    /// Wrong PINs since the last right one.
    wrong: u32,
    /// No PIN is looked at before.
    waits_until: Duration,
}

impl Access {
    /// With `pins`, as an operator; without, everything is allowed.
    pub fn new(pins: Option<Pins>) -> Self {
        Self {
            lock: pins.map_or(Lock::None, Lock::Pins),
            ..Self::default()
        }
    }

    /// Where there may be PINs that cannot be read: as an operator, for good.
    pub fn closed() -> Self {
        Self {
            lock: Lock::Unreadable,
            ..Self::default()
        }
    }

    /// The level now.
    pub fn level(&self) -> Level {
        match self.lock {
            Lock::None => Level::Engineer,
            Lock::Pins(_) | Lock::Unreadable => self.level,
        }
    }

    /// Whether what needs `level` is allowed.
    pub fn allows(&self, level: Level) -> bool {
        self.level() >= level
    }

    /// Whether there are PINs, or may be.
    pub fn is_restricted(&self) -> bool {
        self.lock != Lock::None
    }

    /// Whether there may be PINs that nobody can read.
    pub fn is_unreadable(&self) -> bool {
        self.lock == Lock::Unreadable
    }

    /// The PINs, to be kept.
    pub fn pins(&self) -> Option<&Pins> {
        match &self.lock {
            Lock::Pins(pins) => Some(pins),
            Lock::None | Lock::Unreadable => None,
        }
    }

    /// Whether `level` has a PIN of its own.
    pub fn has_pin(&self, level: Level) -> bool {
        self.pins().is_some_and(|pins| pins.has(level))
    }

    /// How long no PIN is looked at, after wrong ones.
    pub fn wait(&self, now: Duration) -> Option<Duration> {
        let wait = self.waits_until.saturating_sub(now);
        (!wait.is_zero()).then_some(wait)
    }

    /// Somebody touches the screen.
    pub fn touch(&mut self, now: Duration) {
        self.touched = now;
    }

    /// Falls back if nobody has touched the screen for long; whether it has.
    pub fn turn(&mut self, now: Duration) -> bool {
        now.saturating_sub(self.touched) >= UNTOUCHED && self.lock()
    }

    /// An operator's again; false if it was already, or if there is nothing to lock.
    pub fn lock(&mut self) -> bool {
        self.is_restricted() && std::mem::take(&mut self.level) > Level::Operator
    }

    /// Lets in by a PIN.
    ///
    /// # Errors
    /// It is wrong, or has to wait.
    pub fn enter(&mut self, pin: &str, now: Duration) -> Result<Level, Refusal> {
        if let Some(wait) = self.wait(now) {
            return Err(Refusal::Wait(wait));
        }
        let Some(level) = self.pins().and_then(|pins| pins.level_of(pin)) else {
            self.wrong = self.wrong.saturating_add(1);
            if let Some(further) = self.wrong.checked_sub(WRONG_AT_ONCE) {
                let wait = FIRST_WAIT.saturating_mul(2u32.saturating_pow(further));
                self.waits_until = now + wait.min(LONGEST_WAIT);
            }
            return Err(Refusal::WrongPin);
        };
        (self.level, self.touched, self.wrong) = (level, now, 0);
        Ok(level)
    }

    /// Sets the PIN of `level`, or takes it away. Whoever sets the first one stays an engineer until it is locked.
    ///
    /// # Errors
    /// Why not; nothing is changed then.
    pub fn set_pin(&mut self, level: Level, pin: Option<&str>) -> Result<(), Refusal> {
        if !self.allows(Level::Engineer) {
            return Err(Refusal::Needs(Level::Engineer));
        }
        let before = self.pins().cloned();
        let after = match pin {
            Some(pin) => Some(Pins::with(before, level, pin)?),
            None => Pins::without(before, level)?,
        };
        (self.lock, self.level) = (after.map_or(Lock::None, Lock::Pins), Level::Engineer);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
