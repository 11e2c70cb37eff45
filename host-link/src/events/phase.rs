//! The phases of a job, and its questions to the operator.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use shared::io::MOTOR_NAMES;
use std::borrow::Cow;
use std::fmt;

/// The name of a motor, one of [`MOTOR_NAMES`].
type MotorName = &'static str;

/// A part of a job. Its text is a short description in plain English.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// The boards get the machine's parameters.
    SettingUp,
    /// The axes search their reference marks.
    Homing,
    /// The boards relate their clocks.
    RelatingClocks,
    /// On the way to where the work begins.
    Approaching,
    /// On the path of a weld, with the beams off.
    RunningIn,
    /// The path is held before a weld, until the slides have found the seams.
    SearchingSeam,
    /// A beam is on.
    Welding,
    /// Between two welds.
    MovingOn,
    /// On the way to what a probe touches.
    Probing,
    /// At rest for a time that the program asks for.
    Dwelling,
    /// At rest until an input of the process comes.
    WaitingForInput {
        /// Its number, from 1.
        number: u8,
        /// Line of the program.
        line: u32,
    },
    /// In single block: this line of the program.
    Line(u32),
    /// A point of a panel is taught.
    TeachingPoint {
        /// Its number, from 1.
        number: usize,
        /// How many there are.
        of: usize,
    },
    /// A point of a seam is taught.
    TeachingSeam {
        /// Its number, from 1.
        number: usize,
    },
    /// Pictures for a calibration are taken.
    Calibrating {
        /// Number of the place, from 1.
        place: u32,
        /// How many there are.
        of: u32,
    },
    /// A motor is excited, and what it does is captured.
    Exciting {
        /// The motor.
        #[serde(deserialize_with = "motor_name")]
        motor: MotorName,
        /// Number of the excitation, from 1.
        number: usize,
        /// How many there are.
        of: usize,
    },
    /// The operator jogs the machine.
    Jogging,
    /// The machine goes to its park position.
    Parking,
    /// A controlled stop, after a fault or a command.
    Stopping,
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SettingUp => f.write_str("setting up the boards"),
            Self::Homing => f.write_str("searching reference marks"),
            Self::RelatingClocks => f.write_str("relating the clocks"),
            Self::Approaching => f.write_str("approaching"),
            Self::RunningIn => f.write_str("running in"),
            Self::SearchingSeam => f.write_str("searching the seam"),
            Self::Welding => f.write_str("welding"),
            Self::MovingOn => f.write_str("moving on"),
            Self::Probing => f.write_str("probing"),
            Self::Dwelling => f.write_str("dwelling"),
            Self::WaitingForInput { number, line } => write!(f, "waiting for input {number} (line {line})"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::TeachingPoint { number, of } => write!(f, "teaching point {number} of {of}"),
            Self::TeachingSeam { number } => write!(f, "teaching point {number}"),
            Self::Calibrating { place, of } => write!(f, "place {place} of {of}"),
            Self::Exciting { motor, number, of } => {
                write!(f, "exciting {motor}, {number} of {of}")
            }
            Self::Jogging => f.write_str("jogging"),
            Self::Parking => f.write_str("parking"),
            Self::Stopping => f.write_str("stopping"),
        }
    }
}

/// What the machine waits for until the operator answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Question {
    /// May it continue, in single block? [`crate::Command::Resume`] says so.
    GoOn {
        /// With what.
        next: Next,
    },
    /// The program stops here (M0, M1, M60). [`crate::Command::Resume`] continues.
    Stop {
        /// The code.
        code: Cow<'static, str>,
        /// Line of the program.
        line: u32,
        /// What the program says of it.
        text: Option<String>,
    },
    /// The program goes on with another tool. [`crate::Command::Resume`] says that it is in.
    Tool {
        /// Its number; 0 is none.
        tool: u32,
        /// Line of the program.
        line: u32,
        /// What the program says of it.
        text: Option<String>,
    },
    /// The motion board holds it, since the feed is too low for the beam: raise the override, then resume.
    FeedTooLow,
    /// What to do, by hand; [`crate::Command::ByHand`] says it.
    ByHand,
    /// Where to jog, or what to teach; [`crate::Command::Answer`] says it.
    Jog,
}

/// What comes next in single block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Next {
    /// A line of the program.
    Line(u32),
    /// The next move of the approach.
    Approach,
    /// The way to the park position.
    Parking,
}

impl fmt::Display for Next {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Approach => f.write_str("the next move of the approach"),
            Self::Parking => f.write_str("parking"),
        }
    }
}

fn motor_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<MotorName, D::Error> {
    let told = Cow::<str>::deserialize(deserializer)?;
    let known = MOTOR_NAMES.into_iter().find(|name| *name == told);
    known.ok_or_else(|| D::Error::custom(format_args!("there is no motor {told}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_with_a_motor_is_read_back_and_an_unknown_motor_refused() {
        let phase = Phase::Exciting {
            motor: MOTOR_NAMES[1],
            number: 2,
            of: 7,
        };
        let mut bytes = [0; 16];
        let length = postcard::to_slice(&phase, &mut bytes).unwrap().len();
        assert_eq!(postcard::from_bytes(&bytes[..length]), Ok(phase));
        let place = bytes.windows(2).position(|pair| pair == b"X2").unwrap();
        bytes[place] = b'?';
        assert!(postcard::from_bytes::<Phase>(&bytes[..length]).is_err());
    }
}
