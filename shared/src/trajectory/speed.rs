//! The speed along a path: how the path length s goes with time.

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
