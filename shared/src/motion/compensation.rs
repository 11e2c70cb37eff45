//! Error compensation: where each motor belongs so that the tool is where the axes say, from measured deviations.

use super::segment::MotorReference;
use crate::config::{
    DEVIATION_POINTS, DEVIATION_POINTS_IN_ALL, DEVIATIONS, DeviationConfig, MOST_DEVIATION,
    STEEPEST_DEVIATION, smooth,
};
use crate::io::{AXES, MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use crate::kinematics::{AXIS_UNIT, AxisMotion};
use crate::parameter::{ParameterError, check, positive, within};
use heapless::Vec;

/// Passes of the inverse: each leaves [`STEEPEST_DEVIATION`] of what was left before, for every table of an axis.
const PASSES: usize = 3;

/// A deviation is kept in so many parts of [`MOST_DEVIATION`]: to 0.03 µm.
const PARTS: f64 = i16::MAX as f64;

/// One table, in mm and rad: as small as it may be, there is not much memory.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Table {
    axis: u8,
    motor: u8,
    /// Its points among those of all tables.
    count: u8,
    first: u16,
    from: f32,
    per_step: f32,
    /// Of one part of a deviation.
    unit: f32,
}

/// Deviation of a motor at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Deviation {
    axis: usize,
    motor: usize,
    value: f64,
    /// Its change along the axis.
    slope: f64,
}

/// The deviations of a machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compensation {
    tables: Vec<Table, DEVIATIONS>,
    /// Of all tables.
    points: Vec<i16, DEVIATION_POINTS_IN_ALL>,
}

impl Compensation {
    /// Without any.
    pub const NONE: Self = Self {
        tables: Vec::new(),
        points: Vec::new(),
    };

    /// Takes one more table, of a motor that is `fitted`.
    pub fn add(&mut self, config: &DeviationConfig, fitted: &[bool; MOTORS]) -> Result<(), ParameterError> {
        let owner = check_table(config, fitted)?;
        let full = || ParameterError::new(owner, "deviation.values", config.values.len() as f64);
        let another = |table: &Table| (table.axis, table.motor) == (config.axis, config.motor);
        if self.tables.iter().any(another) {
            return Err(ParameterError::new(owner, "deviation.axis", config.axis.into()));
        }
        if self.points.len() + config.values.len() > self.points.capacity() {
            return Err(full());
        }
        let along = AXIS_UNIT[usize::from(config.axis)];
        let across = AXIS_UNIT[MOTOR_AXIS[usize::from(config.motor)]];
        let table = Table {
            axis: config.axis,
            motor: config.motor,
            count: config.values.len() as u8,
            first: self.points.len() as u16,
            from: (config.from * along) as f32,
            per_step: (1.0 / (config.step * along)) as f32,
            unit: (MOST_DEVIATION / PARTS * across) as f32,
        };
        self.tables.push(table).map_err(|_| full())?;
        for value in &config.values {
            let parts = libm::round(f64::from(*value) / MOST_DEVIATION * PARTS);
            self.points.push(parts as i16).map_err(|_| full())?;
        }
        Ok(())
    }

    /// All deviations at `axes`.
    fn at(&self, axes: &[f64; AXES]) -> impl Iterator<Item = Deviation> {
        self.tables.iter().map(|table| {
            let points = &self.points[usize::from(table.first)..][..usize::from(table.count)];
            let (axis, per_step, unit) = (
                usize::from(table.axis),
                f64::from(table.per_step),
                f64::from(table.unit),
            );
            let place = (axes[axis] - f64::from(table.from)) * per_step;
            let [value, slope] = smooth(points.len(), |point| f64::from(points[point]), place);
            Deviation {
                axis,
                motor: usize::from(table.motor),
                value: unit * value,
                slope: unit * slope * per_step,
            }
        })
    }

    /// Motors, which would follow `reference`, to where the tool is where the `axes` say. Of accelerations v²·d″ is left out, 10⁻⁴ of them.
    pub fn correct(&self, axes: &AxisMotion, reference: &mut MotorReference) {
        for deviation in self.at(&axes.position) {
            let Deviation {
                axis,
                motor,
                value,
                slope,
            } = deviation;
            reference.position[motor] -= value;
            reference.velocity[motor] -= slope * axes.velocity[axis];
            reference.acceleration[motor] -= slope * axes.acceleration[axis];
        }
    }

    /// Axes of `motors`, where `axes_of` says them without deviations.
    pub fn axes(
        &self,
        motors: &[f64; MOTORS],
        axes_of: impl Fn(&[f64; MOTORS]) -> [f64; AXES],
    ) -> [f64; AXES] {
        let mut axes = axes_of(motors);
        if self.tables.is_empty() {
            return axes;
        }
        for _ in 0..PASSES {
            axes = axes_of(&self.actual(motors, &axes));
        }
        axes
    }

    /// Where the motors are, whose gratings say `motors`, at `axes`.
    pub fn actual(&self, motors: &[f64; MOTORS], axes: &[f64; AXES]) -> [f64; MOTORS] {
        let mut actual = *motors;
        for deviation in self.at(axes) {
            actual[deviation.motor] += deviation.value;
        }
        actual
    }
}

/// The name of its motor, if the table makes sense.
fn check_table(config: &DeviationConfig, fitted: &[bool; MOTORS]) -> Result<&'static str, ParameterError> {
    let motor = usize::from(config.motor);
    let owner = MOTOR_NAMES
        .get(motor)
        .filter(|_| fitted[motor])
        .copied()
        .ok_or(ParameterError::new(
            "kinematics",
            "deviation.motor",
            config.motor.into(),
        ))?;
    let axis = usize::from(config.axis);
    let has_axis = (0..MOTORS).any(|motor| fitted[motor] && MOTOR_AXIS[motor] == axis);
    check(owner, "deviation.axis", config.axis.into(), |_| has_axis)?;
    check(owner, "deviation.from", config.from, |_| true)?;
    let step = positive(owner, "deviation.step", config.step)?;
    let points = config.values.len() as f64;
    within(owner, "deviation.values", points, 2.0..=DEVIATION_POINTS as f64)?;
    for value in &config.values {
        let range = -MOST_DEVIATION..=MOST_DEVIATION;
        within(owner, "deviation.values", f64::from(*value), range)?;
    }
    for pair in config.values.windows(2) {
        let [before, value] = [pair[0], pair[1]].map(f64::from);
        let most = STEEPEST_DEVIATION * step;
        within(owner, "deviation.values", value, before - most..=before + most)?;
    }
    Ok(owner)
}
