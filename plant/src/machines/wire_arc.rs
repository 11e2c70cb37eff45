//! The wire-arc robot: X, Y, Z, torch tilt A; positioner with tilt B and turntable C.

use crate::motor::{Motor, Motors};

/// It was switched off at its corner, with the torch up and the table level.
pub static MOTORS: Motors = [
    Some(Motor::linear(200.0, [0.0, 1200.0], 20.0, 36.05)),
    None,
    Some(Motor::linear(200.0, [0.0, 800.0], 20.0, 29.87)),
    Some(Motor::linear(200.0, [0.0, 600.0], 580.0, 566.3)),
    Some(Motor::rotary(75.0, [-45.0, 45.0], 1.9)),
    Some(Motor::rotary(40.0, [-80.0, 80.0], -1.2)),
    Some(Motor::rotary(75.0, [-360.0, 360.0], 2.7)),
];
