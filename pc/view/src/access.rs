//! Levels of those who use the screen, and what happens with them.

use serde::{Deserialize, Serialize};

/// What somebody at the screen may do; each level may what those before it may.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Level {
    /// Runs programs.
    #[default]
    Operator,
    /// Also sets the machine up, and teaches.
    Setter,
    /// Also writes parameters, and sets PINs.
    Engineer,
}

impl Level {
    /// All levels, lowest first.
    pub const ALL: [Self; 3] = [Self::Operator, Self::Setter, Self::Engineer];
}

impl std::fmt::Display for Level {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Operator => "operator",
            Self::Setter => "setter",
            Self::Engineer => "engineer",
        })
    }
}

/// Something about access that is put on record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Event {
    /// A PIN has let in.
    Entered(Level),
    /// The screen was locked.
    Locked,
    /// Nobody has touched the screen for a while.
    FellBack,
    /// A PIN that is none.
    WrongPin,
    /// A level has another PIN.
    PinSet(Level),
    /// A level has no PIN any more.
    PinTakenAway(Level),
}
