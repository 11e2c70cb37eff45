//! What the motors of a machine are told, to be measured.

use crate::plan::{Planned, SETTLE_PERIODS, TRAVEL, TURNS_HZ, WAY, plan, plan_at_rest, swing, turns};
use shared::config::MotionConfig;
use shared::control::GantryConfig;
use shared::io::MOTOR_AXIS;
use shared::motion::most_following_error_base;
use shared::protocol::{CaptureSample, Excitation, Excited};

/// Part of its proportional gains with which a machine is measured.
const SOFTENED: f64 = 0.25;
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

/// The machine with loops that are too slow to ring, whatever its gains are: in a loop that swings by itself nothing is measured. A
/// motor trips where its drive is told as much as before, but not further from its place than an excitation may bring it, and not for
/// vibrating: whether its loop does is what is to be found.
pub fn softened(machine: &MotionConfig) -> MotionConfig {
    let mut softened = machine.clone();
    for (index, motor) in softened.motors.iter_mut().enumerate() {
        let (Some(motor), Some(axis)) = (motor, &machine.axes[MOTOR_AXIS[index]]) else {
            continue;
        };
        motor.kp *= SOFTENED;
        motor.ki *= SOFTENED * SOFTENED;
        motor.kd = 0.0;
        let most = most_following_error_base(motor, axis).min(TRAVEL);
        let base = motor.following_error_base;
        motor.following_error_base = (base / SOFTENED).min(most).max(base);
        motor.vibration_limit = 0.0;
    }
    if let Some(gantry) = &mut softened.gantry {
        gantry.coupling *= SOFTENED;
        gantry.coupling_derivative = 0.0;
    }
    softened
}

/// What the motor with this `index` is told, in its order: chirps on its way, a swing in which it turns round, chirps at rest, and a
/// sine on its way that asks for the acceleration of its axis.
pub fn excitations(machine: &MotionConfig, index: usize) -> Vec<Excitation> {
    let axis = machine.axes[MOTOR_AXIS[index]].as_ref();
    let (speed, acceleration) = axis.map_or((0.0, 0.0), |axis| (axis.max_velocity, axis.max_acceleration));
    // To one side there is half of the travel at least.
    let room = axis.map_or(0.0, |axis| {
        (axis.travel_max - axis.travel_min) / 2.0 - 2.0 * TRAVEL
    });
    let way = WAY.min(room).max(0.0);
    let speed = OF_SPEED * speed;
    let turning = Excitation {
        motor: index as u8,
        excited: Excited::Reference,
        amplitude: turns(speed, acceleration),
        from_hz: TURNS_HZ,
        to_hz: TURNS_HZ,
        settle_periods: SETTLE_PERIODS,
        way: 0.0,
        max_travel: TRAVEL,
        max_speed: speed,
    };
    let shaken = |planned: Planned, way| Excitation {
        excited: Excited::Command,
        amplitude: planned.amplitude,
        from_hz: planned.from_hz,
        to_hz: planned.to_hz,
        way,
        ..turning
    };
    let motor = machine.motors[index].as_ref();
    let at_rest = motor.map(|motor| plan_at_rest(motor.counts_per_unit, acceleration));
    let at_rest = at_rest.into_iter().flatten().map(|planned| shaken(planned, 0.0));
    let on_the_way = plan(way, acceleration)
        .into_iter()
        .map(|planned| shaken(planned, way));
    on_the_way
        .chain([turning])
        .chain(at_rest)
        .chain([shaken(swing(way.abs().max(TRAVEL), acceleration, speed), way)])
        .collect()
}

/// The gantry, if the motor with this `index` is one of its two.
fn gantry(machine: &MotionConfig, index: usize) -> Option<&GantryConfig> {
    machine
        .gantry
        .as_ref()
        .filter(|_| MOTOR_AXIS[index] == MOTOR_AXIS[0])
}

/// The lesser proportional gain of the motors of a gantry, where one of `kp` \[1/s\] stands for what the machine has.
pub(crate) fn least_kp(machine: &MotionConfig, kp: impl Fn(usize) -> Option<f64>) -> f64 {
    let motors = machine
        .motors
        .iter()
        .enumerate()
        .filter(|(index, _)| gantry(machine, *index).is_some());
    let gains = motors.filter_map(|(index, motor)| kp(index).or(Some(motor.as_ref()?.kp)));
    gains.fold(f64::INFINITY, f64::min)
}

/// Cross-coupling of the motor with this `index` to its partner, as a part of the lesser proportional gain of both; 0 without a partner.
pub(crate) fn coupling(machine: &MotionConfig, index: usize) -> f64 {
    gantry(machine, index).map_or(0.0, |gantry| gantry.coupling / least_kp(machine, |_| None))
}
