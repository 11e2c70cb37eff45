//! What the motors of a machine are told, to be measured.

use crate::plan::{SETTLE_PERIODS, TRAVEL, TURNS_HZ, WAY, plan, turns};
use shared::config::MotionConfig;
use shared::io::MOTOR_AXIS;
use shared::protocol::{CaptureSample, Excitation, Excited};

/// Part of the acceleration of an axis that an excitation uses.
const OF_ACCELERATION: f64 = 0.5;
/// Part of its proportional gains with which a machine is measured.
const SOFTENED: f64 = 0.25;
/// Part of the skew that trips a gantry.
const OF_SKEW: f64 = 0.5;
/// Part of the speed of an axis that ends one.
const OF_SPEED: f64 = 0.9;

/// What was captured of one excitation.
#[derive(Clone, Debug, PartialEq)]
pub struct CapturedMotion {
    /// The excitation.
    pub excitation: Excitation,
    /// One sample each servo tick.
    pub samples: Vec<CaptureSample>,
}

/// The machine with loops that are too slow to ring, whatever its gains are: in a loop that swings by itself nothing is measured.
pub fn softened(machine: &MotionConfig) -> MotionConfig {
    let mut softened = machine.clone();
    for motor in softened.motors.iter_mut().flatten() {
        motor.kp *= SOFTENED;
        motor.ki *= SOFTENED * SOFTENED;
        motor.kd = 0.0;
    }
    softened
}

/// What the motor with this `index` is told, in its order; the last one has it turn round.
pub fn excitations(machine: &MotionConfig, index: usize) -> Vec<Excitation> {
    let axis = machine.axes[MOTOR_AXIS[index]].as_ref();
    let (speed, acceleration) = axis.map_or((0.0, 0.0), |axis| (axis.max_velocity, axis.max_acceleration));
    // To one side there is half of the travel at least.
    let room = axis.map_or(0.0, |axis| {
        (axis.travel_max - axis.travel_min) / 2.0 - 2.0 * TRAVEL
    });
    let way = WAY.min(room).max(0.0);
    let (speed, acceleration) = (OF_SPEED * speed, OF_ACCELERATION * acceleration);
    let turning = Excitation {
        motor: index as u8,
        excited: Excited::Reference,
        amplitude: turns(speed, acceleration).min(askew(machine, index)),
        from_hz: TURNS_HZ,
        to_hz: TURNS_HZ,
        settle_periods: SETTLE_PERIODS,
        way: 0.0,
        max_travel: TRAVEL,
        max_speed: speed,
    };
    let on_the_way = plan(way, acceleration).into_iter().map(|planned| Excitation {
        excited: Excited::Command,
        amplitude: planned.amplitude,
        from_hz: planned.from_hz,
        to_hz: planned.to_hz,
        way,
        ..turning
    });
    on_the_way.chain([turning]).collect()
}

/// How far motor `index` may go to either side of where it stands alone (mm or °): of a gantry, without tripping its skew.
fn askew(machine: &MotionConfig, index: usize) -> f64 {
    match &machine.gantry {
        Some(gantry) if MOTOR_AXIS[index] == MOTOR_AXIS[0] => OF_SKEW * gantry.skew_trip_mm,
        _ => f64::INFINITY,
    }
}
