//! What an operator asks of a machine by hand.

use std::time::{Duration, Instant};

/// A command while the machine is operated by hand.
#[derive(Clone, Debug, PartialEq)]
pub enum ByHand {
    /// To jog.
    Jog(Jog),
    /// To let go of what is jogged: it comes to rest at once.
    LetGo,
    /// To carry out a block of NC (MDI), which is checked as a program is.
    Block(String),
    /// To switch the drives off, which ends the job.
    Off,
}

/// A jog. One without a step goes on while the same is asked for again in time, and ends at the end of the travel; one with a
/// step ends after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jog {
    /// What moves.
    pub way: JogWay,
    /// How fast, and where to \[mm/s or °/s\].
    pub speed: f64,
    /// How far \[mm or °\]; positive.
    pub step: Option<f64>,
    /// When it was asked for.
    asked: Instant,
}

/// What a jog moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JogWay {
    /// One axis alone: X Y Z A B C.
    Axis(usize),
    /// The tip straight along X, Y or Z of the work; the attitude stays.
    Work(usize),
    /// The tip straight along T, B or N of the tool: along travel, to the left of it, away from the work.
    Tool(usize),
    /// The tool, by the rotary axis A, B or C (3, 4, 5); the tip stays.
    Turn(usize),
    /// A slide: U1 V1 U2 V2.
    Slide(usize),
}

impl Jog {
    /// Asks for it now.
    pub fn now(way: JogWay, speed: f64, step: Option<f64>) -> Self {
        Self {
            way,
            speed,
            step,
            asked: Instant::now(),
        }
    }

    /// The same, asked for now.
    pub fn again(&self) -> Self {
        Self::now(self.way, self.speed, self.step)
    }

    /// How long ago it was asked for.
    pub fn age(&self) -> Duration {
        self.asked.elapsed()
    }

    /// Whether it asks for the same again.
    pub fn renews(&self, other: &Self) -> bool {
        (self.way, self.speed, self.step) == (other.way, other.speed, other.step)
    }
}
