//! Lines that are switched on the path, gates of the beams and digital outputs: as they are, as they change within a tick, and
//! when they were switched.

use super::{Bits, LINES, SIDES};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Gates of the beams and digital outputs, one bit a line: bit 0 and 1 are the gates, the outputs follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Lines(pub u16);

impl Lines {
    /// Everything off.
    pub const NONE: Self = Self(0);
    /// The gates of the beams.
    pub const GATES: Self = Self((1 << SIDES) - 1);

    /// The gates of the beams, nothing else.
    pub fn of_gates(gates: [bool; SIDES]) -> Self {
        let mut lines = Self::NONE;
        for (line, on) in gates.into_iter().enumerate() {
            lines.set(line, on);
        }
        lines
    }

    /// Whether line `index` is on.
    pub fn get(self, index: usize) -> bool {
        self.0 & (1 << index) != 0
    }

    /// Switches line `index`.
    pub fn set(&mut self, index: usize, on: bool) {
        if on {
            self.0 |= 1 << index;
        } else {
            self.0 &= !(1 << index);
        }
    }

    /// The gates.
    pub fn gates(self) -> [bool; SIDES] {
        core::array::from_fn(|side| self.get(side))
    }

    /// The digital outputs.
    pub fn outputs(self) -> Bits {
        Bits((self.0 >> SIDES) as u8)
    }

    /// The lines that are on both here and in `mask`.
    #[must_use]
    pub fn only(self, mask: Self) -> Self {
        Self(self.0 & mask.0)
    }
}

/// Most instants of a tick at which lines are switched; what comes after joins the last.
pub const CHANGES: usize = 4;

/// Lines that change within a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineChange {
    /// After the tick began \[µs\].
    pub after_us: u16,
    /// All lines from then on.
    pub lines: Lines,
}

/// What the lines do within a tick, in order of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineChanges([Option<LineChange>; CHANGES]);

impl LineChanges {
    /// Nothing.
    pub const NONE: Self = Self([None; CHANGES]);

    /// Adds an instant, not before the last one.
    pub fn push(&mut self, change: LineChange) {
        let free = self.0.iter_mut().find(|place| place.is_none());
        match free {
            Some(place) => *place = Some(change),
            None => {
                self.0[CHANGES - 1] = Some(LineChange {
                    lines: change.lines,
                    ..self.0[CHANGES - 1].unwrap_or(change)
                })
            }
        }
    }

    /// The instants, in order.
    pub fn iter(&self) -> impl Iterator<Item = LineChange> + '_ {
        self.0.iter().flatten().copied()
    }
}

/// A line that was switched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Switched {
    /// Its number: 0 and 1 are the gates, the digital outputs follow.
    pub line: u8,
    /// On or off.
    pub on: bool,
    /// When, after the period of the tick began \[µs\].
    pub at_us: u16,
}

/// The first lines that were switched within a tick. Empty it is all zero bits, so that a start state with it takes no flash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SwitchedLines {
    count: u8,
    lines: [Switched; CHANGES],
}

impl SwitchedLines {
    /// None.
    pub const NONE: Self = Self {
        count: 0,
        lines: [Switched {
            line: 0,
            on: false,
            at_us: 0,
        }; CHANGES],
    };

    /// Adds one, if there is room.
    pub fn push(&mut self, switched: Switched) {
        if let Some(place) = self.lines.get_mut(usize::from(self.count)) {
            *place = switched;
            self.count += 1;
        }
    }

    /// In the order in which they were switched.
    pub fn iter(&self) -> impl Iterator<Item = Switched> + '_ {
        self.lines.iter().take(usize::from(self.count)).copied()
    }
}

/// Lines as a board holds them, with a note of what was switched and when.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldLines {
    now: Lines,
    noted: SwitchedLines,
}

impl HeldLines {
    /// Everything off.
    pub const NONE: Self = Self {
        now: Lines::NONE,
        noted: SwitchedLines::NONE,
    };

    /// From `at_us` after the tick began the lines are `lines`.
    pub fn set(&mut self, lines: Lines, at_us: u16) {
        let changed = Lines(self.now.0 ^ lines.0);
        self.now = lines;
        for line in (0..LINES).filter(|line| changed.get(*line)) {
            self.noted.push(Switched {
                line: line as u8,
                on: lines.get(line),
                at_us,
            });
        }
    }

    /// The lines now.
    pub fn now(&self) -> Lines {
        self.now
    }

    /// What was switched since the last call.
    pub fn take(&mut self) -> SwitchedLines {
        core::mem::take(&mut self.noted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_instants_than_there_are_places_join_the_last_one() {
        let mut changes = LineChanges::NONE;
        for k in 0..6 {
            changes.push(LineChange {
                after_us: 10 * k,
                lines: Lines(k),
            });
        }
        let last = changes.iter().last().unwrap();
        assert_eq!(
            (changes.iter().count(), last.after_us, last.lines),
            (4, 30, Lines(5))
        );
    }

    #[test]
    fn what_is_switched_is_noted_once_with_its_time() {
        let mut lines = HeldLines::NONE;
        lines.set(Lines(0b101), 7);
        lines.set(Lines(0b101), 20);
        lines.set(Lines(0b100), 31);
        let note = |line, on, at_us| Switched { line, on, at_us };
        let noted = lines.take();
        assert!(
            noted
                .iter()
                .eq([note(0, true, 7), note(2, true, 7), note(0, false, 31)])
        );
        assert_eq!((lines.take(), lines.now()), (SwitchedLines::NONE, Lines(0b100)));
    }
}
