//! The five-axis laser cutter: X, Y, Z, head C, A.

use crate::motor::{Motor, Motors};

/// It was switched off at its corner, with the head up.
pub static MOTORS: Motors = [
    Some(Motor::linear(800.0, [0.0, 3000.0], 20.0, 33.62)),
    None,
    Some(Motor::linear(800.0, [0.0, 1500.0], 20.0, 38.19)),
    Some(Motor::linear(800.0, [0.0, 800.0], 780.0, 761.7)),
    Some(Motor::rotary(220.0, [-90.0, 90.0], -2.1)),
    None,
    Some(Motor::rotary(220.0, [-360.0, 360.0], 3.3)),
];
