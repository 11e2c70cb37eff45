//! The friction-stir gantry: table X, slide Y, box Z, head C, B.

use crate::motor::{Motor, Motors};

/// It was switched off with the pin up and upright, and the table at the end where its mark is.
pub static MOTORS: Motors = [
    Some(Motor::linear(120.0, [-1500.0, 0.0], -20.0, -34.9)),
    None,
    Some(Motor::linear(120.0, [0.0, 1280.0], 20.0, 31.46)),
    Some(Motor::linear(60.0, [0.0, 480.0], 460.0, 447.8)),
    None,
    Some(Motor::rotary(15.0, [-10.0, 10.0], 0.7)),
    Some(Motor::rotary(60.0, [-180.0, 180.0], -3.4)),
];
