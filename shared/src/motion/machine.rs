//! A machine's parameters, checked and in the units the ticks use.

use super::beams::BeamLimits;
use super::compensation::Compensation;
use super::homing::HomingPlan;
use super::process_inputs::ProcessInputs;
use super::segment::MotorReference;
use super::sensible;
use super::servo::{ServoSetup, UNIT};
use super::superimposed::Superimposed;
use crate::config::{DeviationConfig, MotionConfig};
use crate::control::{Gantry, Pid};
use crate::io::{AXES, MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use crate::kinematics::{AXIS_OWNERS, AxisLimits, AxisMotion, Kinematics, KinematicsError};
use crate::parameter::ParameterError;
use crate::protocol::PathLimits;
use crate::ticks::{PATH_PERIOD_S, SERVO_PERIOD_S};
use crate::trajectory::{PlanLimits, SpeedLimits};

/// A stop is at rest after 0.4 s and four times what the slowest axis needs to slow down at its constant acceleration, to
/// which the planner is held; twice the first, for the pose beside the path comes to rest too.
const STOP_LATENCY_S: f64 = 0.8;
const STOP_TIMES: f64 = 4.0;
/// How far beyond its travel an axis may be, in ways to a stop: a path may slow down less than the axis alone could.
const OVERRUN: f64 = 2.0;
/// The second motor of a gantry.
const X2: usize = 1;

/// What the path tick knows of its machine.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Kinematics.
    pub kinematics: Kinematics,
    /// Reference marks and squaring.
    pub homing: HomingPlan,
    /// Limits of the beams.
    pub beams: BeamLimits,
    /// Inputs by which the process answers.
    pub inputs: ProcessInputs,
    /// The PC may be silent for so long while a path runs \[µs\].
    pub link_timeout_us: u64,
    /// Path ticks until a drive follows commands.
    pub enable_ticks: u32,
    /// Vibration limit of each motor (mm or rad), the usual one where it has none,
    pub vibration_limits: [f32; MOTORS],
    /// and the motors that stop the machine when they are above it.
    pub vibration_stops: [bool; MOTORS],
    limits: [AxisLimits; AXES],
    /// How far beyond its travel an axis may be: twice its way to a stop from its highest speed (mm, rad).
    overrun: [f64; AXES],
    gantry: Option<Gantry>,
    compensation: Compensation,
}

impl Machine {
    /// Checks the parameters; those of the servo loops are returned beside the rest, because they live in another task.
    pub fn build(config: &MotionConfig) -> Result<(Self, ServoSetup), ParameterError> {
        check_fitted(config)?;
        let limits = AxisLimits::build_all(&config.axes)?;
        let gantry = build_gantry(config)?;
        let beams = BeamLimits::build(&config.beams, &config.process)?;
        let machine = Self {
            inputs: ProcessInputs::build(config, beams.outputs())?,
            kinematics: config.kinematics.build(&limits)?,
            homing: HomingPlan::build(config)?,
            beams,
            link_timeout_us: u64::from(config.link_timeout_ms) * 1000,
            enable_ticks: config.drive_enable_ms,
            vibration_limits: core::array::from_fn(|index| match &config.motors[index] {
                Some(motor) => (sensible::vibration_limit(index, motor) * UNIT[index]) as f32,
                None => f32::INFINITY,
            }),
            vibration_stops: config
                .motors
                .each_ref()
                .map(|motor| motor.as_ref().is_some_and(|motor| motor.vibration_limit > 0.0)),
            overrun: limits.map(|axis| OVERRUN * full_stop(&axis)),
            limits,
            gantry,
            compensation: Compensation::NONE,
        };
        let servo = ServoSetup::build(&config.motors, &config.beams, gantry)?;
        sensible::check(config)?;
        Ok((machine, servo))
    }

    /// Limits of a path whose own are `path`.
    pub fn plan_limits(&self, path: &PathLimits) -> PlanLimits {
        PlanLimits::of(
            &self.limits,
            path.acceleration_mm_s2,
            path.jerk_mm_s3,
            path.tolerance_mm,
        )
    }

    /// Takes a table of measured deviations, beside those of other axes and motors.
    pub fn compensate(&mut self, deviation: &DeviationConfig) -> Result<(), ParameterError> {
        let fitted = core::array::from_fn(|motor| self.limits_of(motor).is_some());
        self.compensation.add(deviation, &fitted)
    }

    /// Motors from axes: X1 and X2 stand so that the beam is square, and all where measured deviations are made up for.
    pub fn motors(&self, axes: &AxisMotion) -> MotorReference {
        let [x1, x2] = self
            .gantry
            .map_or([axes.position[0], 0.0], |gantry| gantry.motors(axes.position[0]));
        let mut reference = MotorReference {
            position: with_x(x1, x2, &axes.position),
            velocity: self.rates(&axes.velocity),
            acceleration: self.rates(&axes.acceleration),
        };
        self.compensation.correct(axes, &mut reference);
        reference
    }

    /// Velocities or accelerations of the motors from those of the axes.
    fn rates(&self, axes: &[f64; AXES]) -> [f64; MOTORS] {
        let x2 = if self.gantry.is_some() { axes[0] } else { 0.0 };
        with_x(axes[0], x2, axes)
    }

    /// Axes from motors, X where the beam carries the ram (mathematics 0.10), without what was measured to deviate.
    pub fn axes(&self, motors: &[f64; MOTORS]) -> [f64; AXES] {
        self.compensation.axes(motors, |motors| {
            let x = self.gantry.map_or(motors[0], |gantry| {
                gantry.ram([motors[0], motors[1]], motors[2]).x
            });
            [x, motors[2], motors[3], motors[4], motors[5], motors[6]]
        })
    }

    /// By how much X1 leads X2 beyond what a square beam has \[mm\]; 0 without a gantry.
    pub fn skew(&self, motors: &[f64; MOTORS]) -> f64 {
        let actual = self.compensation.actual(motors, &self.axes(motors));
        self.gantry
            .map_or(0.0, |gantry| gantry.skew([actual[0], actual[1]]))
    }

    /// Limits of the axis of `motor`, if the machine has that motor.
    pub fn limits_of(&self, motor: usize) -> Option<&AxisLimits> {
        let fitted = motor != X2 || self.gantry.is_some();
        let axis = self.limits.get(*MOTOR_AXIS.get(motor)?)?;
        (fitted && axis.velocity.is_finite()).then_some(axis)
    }

    /// The axes for the pose beside the one of `planned`; a tick of `superimposed`, which continues only
    /// where the machine `goes` along its path.
    pub fn superimpose(
        &self,
        superimposed: &mut Superimposed,
        planned: &AxisMotion,
        goes: bool,
    ) -> Result<AxisMotion, KinematicsError> {
        superimposed.step(&self.kinematics, &self.limits, planned, goes)
    }

    /// First axis that would go from one path tick to the next further than twice its speed allows, if any: no
    /// planned path does, but an inverse near a pole or the end of a turn might.
    pub fn jump(&self, from: &[f64; AXES], to: &[f64; AXES]) -> Option<usize> {
        let too_far = |axis: &usize| {
            let step = libm::fabs(to[*axis] - from[*axis]);
            step > 2.0 * self.limits[*axis].velocity * PATH_PERIOD_S
        };
        (0..AXES).find(too_far)
    }

    /// Time in which the machine is at rest after a stop at these speeds of the motors, and along a path with these
    /// limits \[s\].
    pub fn stop_time(&self, motors: &[f64; MOTORS], along: f64, limits: &SpeedLimits) -> f64 {
        let slowing = |motor: usize| libm::fabs(motors[motor]) / self.limits[MOTOR_AXIS[motor]].acceleration;
        let along = libm::fabs(along) / limits.acceleration;
        STOP_LATENCY_S + STOP_TIMES * (0..MOTORS).map(slowing).fold(along, libm::fmax)
    }

    /// First axis further beyond its travel than a stop takes it, if any.
    pub fn overrun(&self, axes: &[f64; AXES]) -> Option<usize> {
        (0..AXES).find(|axis| {
            let AxisLimits { min, max, .. } = self.limits[*axis];
            let over = self.overrun[*axis];
            !(min - over..=max + over).contains(&axes[*axis])
        })
    }

    /// First axis beyond its travel, if any.
    pub fn beyond_travel(&self, axes: &[f64; AXES]) -> Option<usize> {
        (0..AXES).find(|axis| !self.limits[*axis].contains(axes[*axis]))
    }
}

/// Those of X1 and X2 before those of the other motors.
fn with_x(x1: f64, x2: f64, axes: &[f64; AXES]) -> [f64; MOTORS] {
    [x1, x2, axes[1], axes[2], axes[3], axes[4], axes[5]]
}

/// Way to a stop of an axis from its highest speed (mm, rad); of one that the machine does not have it has no end.
fn full_stop(axis: &AxisLimits) -> f64 {
    if !axis.velocity.is_finite() {
        return f64::INFINITY;
    }
    let limits = SpeedLimits {
        velocity: axis.velocity,
        acceleration: axis.acceleration,
        jerk: axis.jerk,
    };
    limits.ramp()
}

/// Every axis of the kinematics needs its limits and its motor, and no other may have them.
fn check_fitted(config: &MotionConfig) -> Result<(), ParameterError> {
    let fitted = config.kinematics.fitted();
    for (axis, wanted) in fitted.into_iter().enumerate() {
        if config.axes[axis].is_some() != wanted {
            return Err(ParameterError::new(
                AXIS_OWNERS[axis],
                "fitted",
                f64::from(!wanted),
            ));
        }
    }
    for motor in 0..MOTORS {
        let wanted = if motor == X2 {
            config.gantry.is_some()
        } else {
            fitted[MOTOR_AXIS[motor]]
        };
        if config.motors[motor].is_some() != wanted {
            return Err(ParameterError::new(
                MOTOR_NAMES[motor],
                "fitted",
                f64::from(!wanted),
            ));
        }
    }
    Ok(())
}

fn build_gantry(config: &MotionConfig) -> Result<Option<Gantry>, ParameterError> {
    let (Some(gantry), [Some(x1), Some(x2), ..]) = (&config.gantry, &config.motors) else {
        return Ok(None);
    };
    let pid = |motor: usize, config| Pid::build(MOTOR_NAMES[motor], config, 1.0, SERVO_PERIOD_S);
    Gantry::build(gantry, [pid(0, x1)?, pid(X2, x2)?], SERVO_PERIOD_S).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_is_not_there_never_needs_to_stop() {
        assert_eq!(full_stop(&AxisLimits::NOT_FITTED), f64::INFINITY);
    }
}
