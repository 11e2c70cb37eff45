//! Detects a drive that is commanded to move while its encoder does not change.
//!
//! A broken encoder at standstill shows no following error: the loop sees the axis where it was, and sends it on and
//! on to remove an error of some counts. It is detected by the distance that the commands add up to.
//!
//! A healthy drive with an offset at its input is held at rest by a command, too: the one with which it came to rest. So what
//! counts is what is commanded beyond that. Behind a dead encoder the command grows, for the integral part never gets what
//! it wants.

/// Counts that a dead encoder may flicker by.
const FLICKER: u64 = 2;
/// Part of the speed at 10 V by which the command of a healthy drive at rest changes: 10 mV.
const TREMBLE: f64 = 1e-3;
/// Part of the speed at 10 V that may hold a drive at rest against the offset of its analog input: 50 mV.
pub const MOST_OFFSET: f64 = 5e-3;
/// The command that holds it is the mean over this time while it moves slowly \[s\].
const MEAN_S: f64 = 0.05;
/// A single movement counts for no longer \[s\]: a grating that jumps when it dies must not be taken for one.
const LONGEST_S: f64 = 0.005;

/// Detects a drive whose encoder does not change while it is commanded to move, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovementCheck {
    /// Commands that are closer than this to the one that holds it are no movement.
    min_velocity: f64,
    /// No command beyond this holds a drive at rest.
    most_held: f64,
    /// Way that commands may make without a movement.
    limit: f64,
}

/// Memory of a [`MovementCheck`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovementState {
    /// Where the encoder stands.
    counts: i64,
    /// Way that was commanded since it came there, beyond what holds it.
    commanded: f64,
    /// The mean command while it moved slowly.
    held: f64,
    /// Time since it came there \[s\].
    since: f64,
}

impl MovementState {
    /// Nothing was commanded.
    pub const fn new() -> Self {
        Self {
            counts: 0,
            commanded: 0.0,
            held: 0.0,
            since: 0.0,
        }
    }
}

impl MovementCheck {
    /// Of a drive with the speed `full_scale` at 10 V, whose commands may add up to `limit` before its
    /// encoder must have changed.
    pub fn new(full_scale: f64, limit: f64) -> Self {
        Self {
            min_velocity: libm::fabs(full_scale) * TREMBLE,
            most_held: 0.0,
            limit,
        }
    }

    /// The same, of a drive with the speed `full_scale` at 10 V in a loop with an integral part, which holds it against an
    /// offset. One without comes to rest within some micrometres, too short a way to tell what holds it.
    #[must_use]
    pub fn against_offset(self, full_scale: f64) -> Self {
        Self {
            most_held: libm::fabs(full_scale) * MOST_OFFSET,
            ..self
        }
    }

    /// Way that may be commanded without a movement.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// One tick of `period` \[s\] with the encoder at `counts`, after the command `velocity`. The distance
    /// that was commanded if that is more than the limit.
    pub fn step(&self, state: &mut MovementState, counts: i64, velocity: f64, period: f64) -> Option<f64> {
        state.since += period;
        if counts.abs_diff(state.counts) > FLICKER {
            // What is told at speed says nothing of rest.
            if libm::fabs(velocity) <= self.most_held {
                state.held += (velocity - state.held) * libm::fmin(state.since, LONGEST_S) / MEAN_S;
            }
            state.counts = counts;
            state.commanded = 0.0;
            state.since = 0.0;
        }
        // Up to what holds it a drive may be told anything, to either side: friction holds it against both, and a loop that hunts
        // about 0 must not add up on one of them.
        let beyond = libm::fabs(velocity) - libm::fabs(state.held);
        if beyond > self.min_velocity {
            state.commanded += libm::copysign(beyond, velocity) * period;
        }
        let way = libm::fabs(state.commanded);
        (way > self.limit).then_some(way)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_that_no_encoder_saw_is_told_at_the_limit_and_a_drives_offset_is_not() {
        let check = MovementCheck::new(-100.0, 0.5);
        let mut state = MovementState::new();
        for tick in 0..100_000 {
            assert_eq!(check.step(&mut state, tick % 3, 0.099, 1e-3), None);
        }
        // 10 mm/s: 0.5 mm in 50 ms, however its last counts flicker.
        let told = (0..100).find(|tick| check.step(&mut state, tick % 3, -10.0, 1e-3).is_some());
        assert!(matches!(told, Some(48..=51)), "{told:?}");
        for tick in 0..1000 {
            assert_eq!(check.step(&mut state, 3 * tick, 10.0, 1e-3), None);
        }
    }

    #[test]
    fn a_drive_with_an_offset_is_held_at_rest_and_one_that_is_sent_on_is_told() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0);
        let mut state = MovementState::new();
        // It comes to rest at 30 mV, and stays there for a minute.
        for counts in 0..1000 {
            assert_eq!(check.step(&mut state, counts, 0.3, 1e-3), None);
        }
        for _ in 0..60_000 {
            assert_eq!(check.step(&mut state, 999, 0.35, 1e-3), None);
        }
        // Its encoder dies: the integral part grows by 0.1 mm/s in a second, and the way from 10 mV on is 0.5 mm after 3.4 s.
        let growing = |tick: i32| 0.3 + 1e-4 * f64::from(tick);
        let told = (0..10_000).find(|tick| check.step(&mut state, 999, growing(*tick), 1e-3).is_some());
        assert!(matches!(told, Some(3200..=3400)), "{told:?}");
    }

    #[test]
    fn a_drive_that_was_moving_when_its_encoder_died_is_told() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0);
        let mut state = MovementState::new();
        for tick in 0..100 {
            assert_eq!(check.step(&mut state, 10 * tick, 20.0, 1e-3), None);
        }
        let told = (0..100).find(|_| check.step(&mut state, 990, 20.0, 1e-3).is_some());
        assert!(told.is_some());
    }

    #[test]
    fn a_loop_that_hunts_about_rest_within_what_held_it_is_left_alone() {
        let check = MovementCheck::new(100.0, 0.5).against_offset(100.0);
        let mut state = MovementState::new();
        for counts in 0..1000 {
            assert_eq!(check.step(&mut state, 3 * counts, 0.3, 1e-3), None);
        }
        for tick in 0..60_000 {
            let command = if tick / 500 % 2 == 0 { 0.28 } else { -0.28 };
            assert_eq!(check.step(&mut state, 2997, command, 1e-3), None, "{tick}");
        }
    }

    #[test]
    fn a_loop_that_only_trembles_is_left_alone() {
        let check = MovementCheck::new(100.0, 0.5);
        let mut state = MovementState::new();
        for tick in 0..100_000 {
            let velocity = if tick % 20 < 10 { 1.0 } else { -1.0 };
            assert_eq!(check.step(&mut state, 0, velocity, 1e-3), None);
        }
    }
}
