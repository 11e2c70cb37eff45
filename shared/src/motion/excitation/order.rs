//! What may be asked of an excitation, and what the servo ticks are told of it.

use super::chirp::Chirp;
use super::way::Way;
use crate::io::MOTOR_NAMES;
use crate::kinematics::AxisLimits;
use crate::motion::servo::UNIT;
use crate::parameter::{ParameterError, within};
use crate::protocol::{CAPTURE_TICKS, Excitation, Excited};
use core::f64::consts::PI;

/// Farthest that a motor may be shaken from its place (mm or °).
const FARTHEST: f64 = 5.0;
/// Farthest way there and back (mm or °).
const FARTHEST_WAY: f64 = 100.0;
/// Fastest line \[Hz\]: a quarter of the rate of the servo ticks.
const HIGHEST_HZ: f64 = 1000.0;
/// Most periods before the capture: five seconds.
const MOST_PERIODS: f64 = 10.0;
/// Smallest amplitude, travel, speed (mm or °, s): anything that is above 0.
const LEAST: f64 = 1e-6;

/// Where a motor's axis stands, and what it may do (mm or rad).
#[derive(Clone, Copy, Debug)]
pub struct Limits<'a> {
    /// Of its axis.
    pub axis: &'a AxisLimits,
    /// Where that is.
    pub position: f64,
}

/// An excitation that was checked, in the units of the ticks (mm or rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExcitationOrder {
    /// Number of it: an order with another one begins another excitation.
    pub number: u32,
    pub motor: usize,
    /// Amplitude on the command, and on the reference; one of them is 0.
    pub command: f64,
    pub reference: f64,
    pub chirp: Chirp,
    pub settle_ticks: u32,
    pub way: Way,
    pub max_travel: f64,
    pub max_speed: f64,
}

impl ExcitationOrder {
    /// Checks `asked` for a motor that the machine has.
    pub fn build(asked: &Excitation, limits: Limits<'_>, number: u32) -> Result<Self, ParameterError> {
        let motor = usize::from(asked.motor);
        let (owner, unit) = (MOTOR_NAMES[motor], UNIT[motor]);
        let of = |field, value, most| within(owner, field, value, LEAST..=most);
        let fastest = limits.axis.velocity / unit;
        let max_speed = of("excitation.max_speed", asked.max_speed, fastest)?;
        let way = within(owner, "excitation.way", asked.way, -FARTHEST_WAY..=FARTHEST_WAY)? * unit;
        let ahead = limits.position + way;
        let room = libm::fmin(
            limits.axis.max - libm::fmax(limits.position, ahead),
            libm::fmin(limits.position, ahead) - limits.axis.min,
        );
        let farthest = libm::fmin(FARTHEST, libm::fmax(room / unit, LEAST));
        let max_travel = of("excitation.max_travel", asked.max_travel, farthest)?;
        let from = within(
            owner,
            "excitation.from_hz",
            asked.from_hz,
            Chirp::LINE_HZ..=HIGHEST_HZ,
        )?;
        let to = within(owner, "excitation.to_hz", asked.to_hz, from..=HIGHEST_HZ)?;
        let periods = f64::from(asked.settle_periods);
        within(owner, "excitation.settle_periods", periods, 1.0..=MOST_PERIODS)?;
        // What would end it at once is refused.
        let settle_ticks = u32::from(asked.settle_periods) * CAPTURE_TICKS as u32;
        // What is captured lies about its quarter.
        let ticks = if way == 0.0 {
            settle_ticks + CAPTURE_TICKS as u32
        } else {
            4 * settle_ticks + 2 * CAPTURE_TICKS as u32
        };
        let way = Way::new(way, ticks);
        let left = max_speed - way.speed() / unit;
        let most = match asked.excited {
            Excited::Command => libm::fmin(left, 2.0 * PI * from * max_travel),
            Excited::Reference => libm::fmin(max_travel, left / (2.0 * PI * to)),
        };
        let amplitude = of("excitation.amplitude", asked.amplitude, most)? * unit;
        let (command, reference) = match asked.excited {
            Excited::Command => (amplitude, 0.0),
            Excited::Reference => (0.0, amplitude),
        };
        Ok(Self {
            number,
            motor,
            command,
            reference,
            chirp: Chirp::new(from, to),
            settle_ticks,
            way,
            max_travel: max_travel * unit,
            max_speed: max_speed * unit,
        })
    }
}
