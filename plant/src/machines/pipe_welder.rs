//! The pipe welder: radial X, axial Z, torch tilt B, waist C.

use crate::motor::{Motor, Motors};

/// It was switched off with the torch drawn out and up, as its marks are.
pub static MOTORS: Motors = [
    Some(Motor::linear(60.0, [20.0, 200.0], 190.0, 176.31)),
    None,
    None,
    Some(Motor::linear(60.0, [60.0, 360.0], 340.0, 325.44)),
    None,
    Some(Motor::rotary(60.0, [-10.0, 100.0], 2.6)),
    Some(Motor::rotary(60.0, [-20.0, 380.0], 3.9)),
];
