//! How often the controllers' ticks come.

/// Servo ticks in one path tick.
pub const SERVO_TICKS_PER_PATH_TICK: u32 = 4;
/// Time between two path ticks \[s\].
pub const PATH_PERIOD_S: f64 = 0.001;
/// Time between two servo ticks \[s\].
pub const SERVO_PERIOD_S: f64 = 0.000_25;
/// Time between two control ticks of the tracker board \[s\].
pub const TRACKER_PERIOD_S: f64 = 0.001;
