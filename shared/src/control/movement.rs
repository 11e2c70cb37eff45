//! Detects a drive that is commanded to move while its encoder does not change.
//!
//! A broken encoder at standstill shows no following error: the loop sees the axis where it was, and sends it on and
//! on to remove an error of some counts. It is detected by the distance that the commands add up to.

/// Counts that a dead encoder may flicker by.
const FLICKER: u64 = 2;
/// Part of the speed at 10 V that holds a healthy drive at rest against the offset of its analog input: 10 mV.
const OFFSET: f64 = 1e-3;

/// Detects a drive whose encoder does not change while it is commanded to move, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovementCheck {
    /// Commands below this may be the offset of the drive.
    min_velocity: f64,
    /// Way that commands may make without a movement.
    limit: f64,
}

/// Memory of a [`MovementCheck`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovementState {
    /// Where the encoder stands.
    counts: i64,
    /// Way that was commanded since it came there.
    commanded: f64,
}

impl MovementState {
    /// Nothing was commanded.
    pub const fn new() -> Self {
        Self {
            counts: 0,
            commanded: 0.0,
        }
    }
}

impl MovementCheck {
    /// Of a drive with the speed `full_scale` at 10 V, whose commands may add up to `limit` before its
    /// encoder must have changed.
    pub fn new(full_scale: f64, limit: f64) -> Self {
        Self {
            min_velocity: libm::fabs(full_scale) * OFFSET,
            limit,
        }
    }

    /// Way that may be commanded without a movement.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// One tick of `period` \[s\] with the encoder at `counts`, after the command `velocity`. The distance
    /// that was commanded if that is more than the limit.
    pub fn step(&self, state: &mut MovementState, counts: i64, velocity: f64, period: f64) -> Option<f64> {
        if counts.abs_diff(state.counts) > FLICKER {
            *state = MovementState {
                counts,
                commanded: 0.0,
            };
        }
        if libm::fabs(velocity) > self.min_velocity {
            state.commanded += velocity * period;
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
    fn a_loop_that_only_trembles_is_left_alone() {
        let check = MovementCheck::new(100.0, 0.5);
        let mut state = MovementState::new();
        for tick in 0..100_000 {
            let velocity = if tick % 20 < 10 { 1.0 } else { -1.0 };
            assert_eq!(check.step(&mut state, 0, velocity, 1e-3), None);
        }
    }
}
