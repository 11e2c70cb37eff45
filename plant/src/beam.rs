//! The beam of a gantry: what its two motors feel of each other.

use crate::Drive;
use crate::config::BeamConfig;
use crate::motor::TICK;

/// From the beginning of a tick to its middle \[s\]: the five steps of a drive, each of which goes by the speed at its end, are half a
/// step ahead.
const AHEAD: f64 = TICK / 2.0 - TICK / 10.0;

/// A beam between two motors, which pulls them together as a spring and a damper do. Where one end is pushed forwards, the other one
/// swings back.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    stiffness: f64,
    damping: f64,
    share: f64,
    /// Speeds of the motors a tick ago, and what they gained in the tick before.
    before: [f64; 2],
    gained: [f64; 2],
}

impl Beam {
    /// With masses that are alike, the distance d of the motors swings as (1 − share) d″ + 2ζω d′ + ω² d = 0.
    pub fn new(config: &BeamConfig) -> Self {
        let omega = 2.0 * core::f64::consts::PI * config.yaw_hz;
        let body = 1.0 - config.share;
        Self {
            stiffness: omega * omega * body / 2.0,
            damping: config.damping * omega * body,
            share: config.share,
            before: [0.0; 2],
            gained: [0.0; 2],
        }
    }

    /// How both motors are accelerated in the coming tick \[1/s²\]. Places and accelerations are those of its middle, as far as they
    /// can be foreseen, so that the tick adds next to nothing to the swinging. That of the accelerations is stable up to a share of 1/3, of
    /// bodies without their resonances, which at high frequencies are lighter.
    pub fn pulls(&mut self, motors: [&Drive; 2]) -> [f64; 2] {
        let [first, second] = motors.map(Drive::body);
        let yaw_rate = first[1] - second[1];
        let yaw = first[0] - second[0] + yaw_rate * AHEAD;
        let speeds = [first[1], second[1]];
        let gained: [f64; 2] = core::array::from_fn(|i| speeds[i] - self.before[i]);
        let [first, second] = [0, 1].map(|i| -self.share * (2.0 * gained[i] - self.gained[i]) / TICK);
        (self.before, self.gained) = (speeds, gained);
        let pull = self.stiffness * yaw + self.damping * yaw_rate;
        [second - pull, first + pull]
    }
}
