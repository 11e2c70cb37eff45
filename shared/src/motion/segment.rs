//! References of one millisecond, from the path tick to the servo ticks.

use crate::io::{DacCode, LEVELS, LineChange, LineChanges, Lines, MOTORS, SIDES};
use crate::ticks::{PATH_PERIOD_S, SERVO_TICKS_PER_PATH_TICK};

/// Position, velocity and acceleration reference of every motor at one instant (mm or rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorReference {
    /// Position.
    pub position: [f64; MOTORS],
    /// Velocity \[1/s\].
    pub velocity: [f64; MOTORS],
    /// Acceleration \[1/s²\].
    pub acceleration: [f64; MOTORS],
}

impl MotorReference {
    /// At rest at zero.
    pub const ZERO: Self = Self {
        position: [0.0; MOTORS],
        velocity: [0.0; MOTORS],
        acceleration: [0.0; MOTORS],
    };

    /// At rest at `position`.
    pub fn at_rest(position: [f64; MOTORS]) -> Self {
        Self {
            position,
            ..Self::ZERO
        }
    }
}

/// What goes to beams and process during one millisecond.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProcessOutput {
    /// Gates and digital outputs when it begins.
    pub lines: Lines,
    /// How they change in it.
    pub changes: LineChanges,
    /// Powers of the beams while their gates are open, then the analog outputs.
    pub levels: [DacCode; LEVELS],
}

impl ProcessOutput {
    /// Everything off.
    pub const OFF: Self = Self {
        lines: Lines::NONE,
        changes: LineChanges::NONE,
        levels: [DacCode::ZERO; LEVELS],
    };

    /// Gates that are open at any time in it.
    pub fn gates(&self) -> [bool; SIDES] {
        let lines = self.changes.iter().map(|change| change.lines.0);
        Lines(lines.fold(self.lines.0, |all, lines| all | lines)).gates()
    }

    /// The same, but that the lines of `shut` are off throughout.
    #[must_use]
    pub fn without(&self, shut: Lines) -> Self {
        let rest = Lines(!shut.0);
        let mut changes = LineChanges::NONE;
        for change in self.changes.iter() {
            changes.push(LineChange {
                lines: change.lines.only(rest),
                ..change
            });
        }
        Self {
            lines: self.lines.only(rest),
            changes,
            levels: self.levels,
        }
    }

    /// The part of it from `from_us` on that is `long_us` long: lines at its beginning, and changes from there on.
    pub fn part(&self, from_us: u16, long_us: u16) -> (Lines, LineChanges) {
        let mut lines = self.lines;
        let mut changes = LineChanges::NONE;
        for change in self.changes.iter() {
            if change.after_us <= from_us {
                lines = change.lines;
            } else if change.after_us < from_us + long_us {
                changes.push(LineChange {
                    after_us: change.after_us - from_us,
                    lines: change.lines,
                });
            }
        }
        (lines, changes)
    }
}

/// One motor's reference over one millisecond: the polynomial of fifth degree that meets position, velocity
/// and acceleration at both ends, so that references are smooth between path ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Quintic([f64; 6]);

/// A quintic's value and its first two derivatives.
type Triple = (f64, f64, f64);

impl Quintic {
    /// From one (position, velocity, acceleration) to another in [`PATH_PERIOD_S`].
    fn between(from: Triple, to: Triple) -> Self {
        const T: f64 = PATH_PERIOD_S;
        // Over τ = t/T the derivatives scale by T and T².
        let (p0, v0, a0) = (from.0, from.1 * T, from.2 * T * T * 0.5);
        let (p, v, a) = (
            to.0 - p0 - v0 - a0,
            to.1 * T - v0 - 2.0 * a0,
            to.2 * T * T * 0.5 - a0,
        );
        Self([
            p0,
            v0,
            a0,
            10.0 * p - 4.0 * v + a,
            -15.0 * p + 7.0 * v - 2.0 * a,
            6.0 * p - 3.0 * v + a,
        ])
    }

    /// At τ in 0…1.
    fn at(&self, tau: f64) -> Triple {
        const T: f64 = PATH_PERIOD_S;
        let [c0, c1, c2, c3, c4, c5] = self.0;
        let position = c0 + tau * (c1 + tau * (c2 + tau * (c3 + tau * (c4 + tau * c5))));
        let velocity = c1 + tau * (2.0 * c2 + tau * (3.0 * c3 + tau * (4.0 * c4 + tau * 5.0 * c5)));
        let acceleration = 2.0 * c2 + tau * (6.0 * c3 + tau * (12.0 * c4 + tau * 20.0 * c5));
        (position, velocity / T, acceleration / (T * T))
    }
}

/// References of one millisecond, and what goes to the process in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Segment {
    motors: [Quintic; MOTORS],
    /// Beams during the whole millisecond.
    pub process: ProcessOutput,
}

impl Segment {
    /// From one reference to the next.
    pub fn between(from: &MotorReference, to: &MotorReference, process: ProcessOutput) -> Self {
        let triple = |r: &MotorReference, m: usize| (r.position[m], r.velocity[m], r.acceleration[m]);
        let motors = core::array::from_fn(|m| Quintic::between(triple(from, m), triple(to, m)));
        Self { motors, process }
    }

    /// (position, velocity, acceleration) of `motor` at servo tick `phase` of the millisecond.
    pub fn at(&self, motor: usize, phase: u32) -> (f64, f64, f64) {
        self.motors[motor].at(f64::from(phase) / f64::from(SERVO_TICKS_PER_PATH_TICK))
    }

    /// The millisecond after this one at the speed it ends with, beams and outputs off: what a servo does that got no
    /// references in time.
    pub fn continued(&self) -> Self {
        let mut from = MotorReference::ZERO;
        let mut to = MotorReference::ZERO;
        for motor in 0..MOTORS {
            let (position, velocity, _) = self.at(motor, SERVO_TICKS_PER_PATH_TICK);
            from.position[motor] = position;
            to.position[motor] = position + velocity * PATH_PERIOD_S;
            from.velocity[motor] = velocity;
            to.velocity[motor] = velocity;
        }
        Self::between(&from, &to, ProcessOutput::OFF)
    }

    /// Moves the position of `motor` by `distance`, when its reference has just been found.
    pub fn shift(&mut self, motor: usize, distance: f64) {
        self.motors[motor].0[0] += distance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(position: f64, velocity: f64, acceleration: f64) -> MotorReference {
        MotorReference {
            position: [position; MOTORS],
            velocity: [velocity; MOTORS],
            acceleration: [acceleration; MOTORS],
        }
    }

    #[test]
    fn a_segment_meets_both_ends_to_the_second_derivative() {
        let (from, to) = (reference(1.0, 150.0, -2000.0), reference(1.149, 148.5, 1000.0));
        let segment = Segment::between(&from, &to, ProcessOutput::OFF);
        for (phase, end) in [(0, from), (SERVO_TICKS_PER_PATH_TICK, to)] {
            let (p, v, a) = segment.at(3, phase);
            assert!((p - end.position[3]).abs() < 1e-12);
            assert!((v - end.velocity[3]).abs() < 1e-9);
            assert!((a - end.acceleration[3]).abs() < 1e-6);
        }
    }

    #[test]
    fn constant_acceleration_is_reproduced_between_the_ends() {
        let at = |t: f64| reference(5.0 + 100.0 * t + 1000.0 * t * t, 100.0 + 2000.0 * t, 2000.0);
        let segment = Segment::between(&at(0.0), &at(0.001), ProcessOutput::OFF);
        let (p, v, a) = segment.at(0, 1);
        let middle = at(0.000_25);
        assert!((p - middle.position[0]).abs() < 1e-12);
        assert!((v - middle.velocity[0]).abs() < 1e-9);
        assert!((a - 2000.0).abs() < 1e-6);
    }

    #[test]
    fn a_shift_moves_the_position_only() {
        let mut segment = Segment::between(
            &reference(1.0, 2.0, 3.0),
            &reference(1.002, 2.0, 3.0),
            ProcessOutput::OFF,
        );
        let before = segment.at(2, 1);
        segment.shift(2, 10.0);
        assert_eq!(segment.at(2, 1), (before.0 + 10.0, before.1, before.2));
    }
}
