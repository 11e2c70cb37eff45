//! The operator: what they see while a job runs, and what they ask for.

/// Where a job tells how far it is, and whom it asks.
pub trait Progress {
    /// A new part of the job begins.
    fn phase(&mut self, text: &str);

    /// The machine is `done_mm` along a path of `length_mm`.
    fn travel(&mut self, done_mm: f64, length_mm: f64);

    /// What the operator asks for now, if anything; asked often.
    fn word(&mut self) -> Option<Word> {
        None
    }

    /// A line that the operator entered, in jobs that are led by lines and not by words; asked often.
    fn line(&mut self) -> Option<Line> {
        None
    }

    /// Tells the operator something that they asked for.
    fn say(&mut self, _text: &str) {}

    /// Whether the machine shall wait after every block of the program.
    fn single_block(&self) -> bool {
        false
    }
}

/// Something that the operator asks for while a job runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Word {
    /// To go on after a hold, or with the next block; nothing where the machine does not wait.
    GoOn,
    /// Beams off, and a stop on the path.
    Hold,
    /// Back along the path, from a hold.
    Back,
    /// Another feed override, 0…2.
    Override(f64),
    /// There is nobody any more who could ask.
    Gone,
}

/// A line that an operator enters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Line {
    /// What it says.
    Said(String),
    /// There will be no more.
    Over,
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn phase(&mut self, _text: &str) {}

    fn travel(&mut self, _done_mm: f64, _length_mm: f64) {}
}
