//! Lines that are switched between two servo ticks, for both boards: the core's SysTick counts down to the next change.
#![no_std]

mod process_lines;
#[cfg(target_os = "none")]
mod systick;

pub use process_lines::{LinePort, ProcessLines};
#[cfg(target_os = "none")]
pub use systick::SysTick;

use shared::io::{LineChanges, Lines};

/// A timer that interrupts once.
pub trait OneShot {
    /// Interrupts after so many microseconds, at least one.
    fn start(&mut self, after_us: u16);
    /// Does not interrupt any more.
    fn stop(&mut self);
}

/// What is still to be switched before the next servo tick.
pub struct Switching<T> {
    timer: T,
    changes: LineChanges,
    /// The changes up to this time after the tick are done \[µs\]; none yet.
    done_us: Option<u16>,
}

impl<T: OneShot> Switching<T> {
    /// Nothing to switch.
    pub const fn new(timer: T) -> Self {
        Self {
            timer,
            changes: LineChanges::NONE,
            done_us: None,
        }
    }

    /// From a servo tick on, which began `since_us` ago, lines change as `changes` says; what an earlier tick said is void.
    /// The lines that are due already, if any are.
    pub fn arm(&mut self, changes: &LineChanges, since_us: u16) -> Option<Lines> {
        self.timer.stop();
        self.changes = *changes;
        self.done_us = None;
        self.due(since_us)
    }

    /// The lines as they are to be now, `since_us` after the tick began, if they change; the timer runs for the next change.
    pub fn due(&mut self, since_us: u16) -> Option<Lines> {
        let mut lines = None;
        for change in self.changes.iter() {
            if self.done_us.is_some_and(|done| change.after_us <= done) {
                continue;
            }
            if change.after_us > since_us {
                self.timer.start(change.after_us - since_us);
                break;
            }
            lines = Some(change.lines);
        }
        self.done_us = Some(since_us);
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::io::LineChange;

    #[derive(Default)]
    struct Timer(Option<u16>);

    impl OneShot for Timer {
        fn start(&mut self, after_us: u16) {
            self.0 = Some(after_us);
        }

        fn stop(&mut self) {
            self.0 = None;
        }
    }

    fn changes(instants: &[(u16, u16)]) -> LineChanges {
        let mut changes = LineChanges::NONE;
        for (after_us, lines) in instants {
            changes.push(LineChange {
                after_us: *after_us,
                lines: Lines(*lines),
            });
        }
        changes
    }

    #[test]
    fn every_change_comes_once_and_in_its_time() {
        let mut switching = Switching::new(Timer::default());
        let changes = changes(&[(10, 1), (30, 3), (120, 2), (240, 0)]);
        // The tick itself has taken 35 µs: the first two are due, as one.
        assert_eq!(switching.arm(&changes, 35), Some(Lines(3)));
        assert_eq!(switching.timer.0.take(), Some(85));
        assert_eq!(switching.due(121), Some(Lines(2)));
        assert_eq!(switching.timer.0.take(), Some(119));
        assert_eq!(switching.due(240), Some(Lines(0)));
        assert_eq!((switching.timer.0, switching.due(245)), (None, None));
    }

    #[test]
    fn a_timer_that_is_early_is_started_again() {
        let mut switching = Switching::new(Timer::default());
        assert_eq!(switching.arm(&changes(&[(100, 1)]), 20), None);
        assert_eq!(switching.due(99), None);
        assert_eq!(switching.timer.0.take(), Some(1));
        assert_eq!(switching.due(100), Some(Lines(1)));
    }

    #[test]
    fn the_next_tick_makes_void_what_was_not_switched_yet() {
        let mut switching = Switching::new(Timer::default());
        switching.arm(&changes(&[(200, 1)]), 20);
        assert_eq!(switching.arm(&LineChanges::NONE, 20), None);
        assert_eq!((switching.timer.0, switching.due(250)), (None, None));
    }
}
