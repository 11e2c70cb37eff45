//! The machine behind a board: the project's own model of drives, gratings and slides.

use crate::time::Time;
use plant::{MotionPlant, SlidePlant};
use shared::io::{Command, DacCode, Feedback, MOTORS, SIDES, SLIDES};

/// What a board is wired to.
#[derive(Debug)]
pub enum Machine {
    /// Nothing.
    None,
    /// Servo axes and beams, behind a motion board.
    Motion(Box<MotionPlant>),
    /// Slides, behind a tracker board.
    Tracker(Box<SlidePlant>),
}

/// What a machine shows after a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Counts of each encoder, and the count at a reference mark if one was passed.
    pub counts: Vec<(i64, Option<i64>)>,
    /// Switches pressed at the positive ends, a bit for each.
    pub limit_plus: u8,
    /// The same at the negative ends.
    pub limit_minus: u8,
}

/// A step: the lines and converter codes at its end, by which the machine was driven, and what it shows from then on.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Enables of the drives.
    pub enables: Vec<bool>,
    /// Gates of the beams, or permits.
    pub gates: Vec<bool>,
    /// Codes that the converters give out, four of each.
    pub codes: Vec<i16>,
    /// What the board can read until the next step.
    pub seen: Seen,
}

/// First output of the converters that is the power of a beam.
const FIRST_POWER: usize = 8;

impl Machine {
    /// Time of a step: the tick of its board.
    pub fn step(&self) -> Time {
        match self {
            Self::None => Time::NEVER,
            Self::Motion(_) => Time::us(250),
            Self::Tracker(_) => Time::ms(1),
        }
    }

    /// One step with these lines and converter codes.
    pub fn advance(&mut self, enables: &[bool], gates: &[bool], codes: &[i16]) -> Option<Seen> {
        match self {
            Self::None => None,
            Self::Motion(plant) => Some(see(&plant.advance(&command::<MOTORS>(enables, gates, codes)))),
            Self::Tracker(plant) => Some(see(&plant.advance(&command::<SLIDES>(enables, gates, codes)))),
        }
    }

    /// True positions (mm, rad).
    pub fn truth(&self) -> Vec<f64> {
        match self {
            Self::None => Vec::new(),
            Self::Motion(plant) => plant.truth().to_vec(),
            Self::Tracker(plant) => plant.truth().to_vec(),
        }
    }
}

/// The plants know one enable for all drives: it is on when all lines are.
fn command<const N: usize>(enables: &[bool], gates: &[bool], codes: &[i16]) -> Command<N> {
    let code = |index: usize| DacCode(codes.get(index).copied().unwrap_or(0));
    let mut command = Command::SAFE;
    command.enable = enables.iter().all(|on| *on);
    command.dac = std::array::from_fn(code);
    for side in 0..SIDES {
        command.beam_gate[side] = gates.get(side).copied().unwrap_or(false);
        command.beam_power[side] = code(FIRST_POWER + side);
    }
    command
}

fn see<const N: usize>(feedback: &Feedback<N>) -> Seen {
    Seen {
        counts: feedback.counts.into_iter().zip(feedback.mark).collect(),
        limit_plus: feedback.limit_plus.0,
        limit_minus: feedback.limit_minus.0,
    }
}
