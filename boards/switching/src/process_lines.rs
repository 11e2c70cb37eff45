//! Gates of the beams and digital outputs of a motion board.

use crate::{OneShot, Switching};
use shared::io::{HeldLines, Lines, MotionCommand, MotionFeedback};

/// The pins of a board.
pub trait LinePort {
    /// Time on the board's clock \[µs\].
    fn now_us(&self) -> u64;
    /// Sets all lines.
    fn set(&mut self, lines: Lines);
}

/// Lines that are switched at servo ticks and between them.
pub struct ProcessLines<T, P> {
    switching: Switching<T>,
    port: P,
    held: HeldLines,
    /// When the period of the last servo tick began.
    began_us: u64,
}

impl<T: OneShot, P: LinePort> ProcessLines<T, P> {
    /// The lines of `port`, switched in time by `timer`.
    pub const fn new(timer: T, port: P) -> Self {
        Self {
            switching: Switching::new(timer),
            port,
            held: HeldLines::NONE,
            began_us: 0,
        }
    }

    /// Tells `feedback` what was switched in the period that has just ended.
    pub fn read(&mut self, feedback: &mut MotionFeedback) {
        feedback.switched = self.held.take();
    }

    /// Sets the lines at a servo tick whose period began at `began_us`, after all else is written, and switches them as `command`
    /// says until the next one.
    pub fn write(&mut self, command: &MotionCommand, began_us: u64) {
        self.began_us = began_us;
        let since_us = self.since_us();
        self.set(command.lines(), since_us);
        if let Some(lines) = self.switching.arm(&command.changes, since_us) {
            self.set(lines, since_us);
        }
    }

    /// The interrupt between two ticks.
    pub fn switch(&mut self) {
        let since_us = self.since_us();
        if let Some(lines) = self.switching.due(since_us) {
            self.set(lines, since_us);
        }
    }

    fn set(&mut self, lines: Lines, since_us: u16) {
        self.port.set(lines);
        self.held.set(lines, since_us);
    }

    fn since_us(&self) -> u16 {
        u16::try_from(self.port.now_us() - self.began_us).unwrap_or(u16::MAX)
    }
}
