//! The dual-beam gantry: X on two motors, Y, Z, head C, B, A.

use crate::DriveConfig;
use crate::motor::{LINEAR, Motor, Motors};

/// 15 % slower than its partner and twice the friction.
const LAZY: DriveConfig = DriveConfig {
    bandwidth_hz: 68.0,
    friction: 300.0,
    ..LINEAR
};

/// The marks of X1 and X2 were mounted at 20 mm, half the square offset of 0.037 mm to either side: positions
/// counted from them differ by X1 − X2 = 0.037 mm when the beam is square. At power-up it is 0.06 mm out.
pub static MOTORS: Motors = [
    Some(Motor::linear(400.0, [0.0, 5000.0], 20.0 - 0.0185, 35.013)),
    Some(Motor::linear(400.0, [0.0, 5000.0], 20.0 + 0.0185, 34.953).with_drive(LAZY)),
    Some(Motor::linear(400.0, [0.0, 3000.0], 20.0, 41.27)),
    Some(Motor::linear(200.0, [0.0, 1000.0], 980.0, 955.4)),
    Some(Motor::rotary(150.0, [-100.0, 100.0], 3.2)),
    Some(Motor::rotary(150.0, [-30.0, 30.0], -1.7)),
    Some(Motor::rotary(150.0, [-90.0, 90.0], 2.4)),
];
