//! The speed along a path: how the path length s goes with time.

use super::ramp::Ramps;
use thiserror::Error;

/// Limits along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimits {
    /// Speed \[mm/s\].
    pub velocity: f64,
    /// Acceleration and deceleration \[mm/s²\].
    pub acceleration: f64,
    /// Jerk \[mm/s³\].
    pub jerk: f64,
}

/// Path length and its derivatives over time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedState {
    /// Path length \[mm\].
    pub s: f64,
    /// Path speed \[mm/s\].
    pub v: f64,
    /// Path acceleration \[mm/s²\].
    pub a: f64,
}

impl SpeedState {
    /// At rest at `s` \[mm\].
    pub const fn at_rest(s: f64) -> Self {
        Self { s, v: 0.0, a: 0.0 }
    }
}

/// Why there is no speed along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SpeedError {
    /// A limit is zero, negative or not finite, or they are so far apart that no time comes out.
    #[error("the limits of speed, acceleration and jerk must be positive")]
    Limits,
    /// The end lies before the start, or a number is not finite, or the path is traversed backwards.
    #[error("the speed must go forward between finite path lengths")]
    Range,
    /// A step to a speed that is not positive, or steps out of order.
    #[error("the steps of the speed must be positive and in order of the path")]
    Step,
    /// No room for another step.
    #[error("the speed has more than {capacity} different limits along the path")]
    TooManySteps {
        /// What fits.
        capacity: u16,
    },
}

impl SpeedLimits {
    /// Way from rest to the speed, or from it to rest \[mm\].
    pub fn ramp(&self) -> f64 {
        let ramps = Ramps {
            acceleration: self.acceleration,
            jerk: self.jerk,
        };
        ramps.length(0.0, self.velocity)
    }

    pub(super) fn check(&self) -> Result<(), SpeedError> {
        let ok = |x: f64| x.is_finite() && x > 0.0;
        if ok(self.velocity) && ok(self.acceleration) && ok(self.jerk) {
            Ok(())
        } else {
            Err(SpeedError::Limits)
        }
    }
}
