//! A machine's parameters, checked and in the units the ticks use.

use super::beams::BeamLimits;
use super::homing::HomingPlan;
use super::servo::ServoSetup;
use super::{MotionConfig, SERVO_PERIOD_S};
use crate::control::{Gantry, Pid};
use crate::io::{AXES, MOTOR_NAMES, MOTORS};
use crate::kinematics::{AxisLimits, DualBeam, violations};
use crate::parameter::ParameterError;

/// What the path tick knows of its machine.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Kinematics.
    pub kinematics: DualBeam,
    /// Reference marks and squaring.
    pub homing: HomingPlan,
    /// Limits of the beams.
    pub beams: BeamLimits,
    /// The PC may be silent for so long while a path runs \[µs\].
    pub link_timeout_us: u64,
    limits: [AxisLimits; AXES],
    gantry: Gantry,
}

impl Machine {
    /// Checks the parameters; those of the servo loops are returned beside the rest, because they live in another task.
    pub fn build(config: &MotionConfig) -> Result<(Self, ServoSetup), ParameterError> {
        if config.link_timeout_ms == 0 {
            return Err(ParameterError::new("link", "link_timeout_ms", 0.0));
        }
        let pid = |motor: usize| Pid::build(MOTOR_NAMES[motor], &config.motors[motor], 1.0, SERVO_PERIOD_S);
        let gantry = Gantry::build(&config.gantry, [pid(0)?, pid(1)?], SERVO_PERIOD_S)?;
        let machine = Self {
            kinematics: config.kinematics.build()?,
            homing: HomingPlan::build(config)?,
            beams: BeamLimits::build(&config.beams)?,
            link_timeout_us: u64::from(config.link_timeout_ms) * 1000,
            limits: AxisLimits::build_all(&config.axes)?,
            gantry,
        };
        Ok((machine, ServoSetup::build(&config.motors, gantry)?))
    }

    /// Motors from axes: X1 and X2 stand so that the beam is square.
    pub fn motors(&self, axes: &[f64; AXES]) -> [f64; MOTORS] {
        let [x1, x2] = self.gantry.motors(axes[0]);
        [x1, x2, axes[1], axes[2], axes[3], axes[4], axes[5]]
    }

    /// Axes from motors, X where the beam carries the ram (SPEC 0.10).
    pub fn axes(&self, motors: &[f64; MOTORS]) -> [f64; AXES] {
        let ram = self.gantry.ram([motors[0], motors[1]], motors[2]);
        [ram.x, motors[2], motors[3], motors[4], motors[5], motors[6]]
    }

    /// First axis beyond its travel, if any.
    pub fn beyond_travel(&self, axes: &[f64; AXES]) -> Option<usize> {
        let outside = violations(axes, &self.limits);
        (0..AXES).find(|axis| outside.get(*axis))
    }
}
