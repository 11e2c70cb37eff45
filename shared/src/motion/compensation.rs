//! Error compensation: where each motor belongs so that the tool is where the axes say, from measured deviations.

use crate::config::{
    DEVIATION_POINTS, DEVIATIONS, DeviationConfig, MOST_DEVIATION, STEEPEST_DEVIATION, smooth,
};
use crate::io::{AXES, MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use crate::kinematics::AXIS_UNIT;
use crate::parameter::{ParameterError, check, positive, within};
use heapless::Vec;

/// Passes of the inverse: each leaves [`STEEPEST_DEVIATION`] of what was left before, for every table of an axis.
const PASSES: usize = 3;

/// One table, in mm and rad.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    axis: usize,
    motor: usize,
    from: f64,
    per_step: f64,
    values: Vec<f32, DEVIATION_POINTS>,
}

/// Deviation of a motor at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Deviation {
    value: f64,
    /// Its change along the axis.
    slope: f64,
}

impl Table {
    fn build(config: &DeviationConfig, fitted: &[bool; MOTORS]) -> Result<Self, ParameterError> {
        let motor = usize::from(config.motor);
        let owner = MOTOR_NAMES
            .get(motor)
            .filter(|_| fitted[motor])
            .ok_or(ParameterError::new(
                "kinematics",
                "deviation.motor",
                config.motor.into(),
            ))?;
        let axis = usize::from(config.axis);
        let has_axis = (0..MOTORS).any(|motor| fitted[motor] && MOTOR_AXIS[motor] == axis);
        check(owner, "deviation.axis", config.axis.into(), |_| has_axis)?;
        let (along, across) = (AXIS_UNIT[axis], AXIS_UNIT[MOTOR_AXIS[motor]]);
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
        Ok(Self {
            axis,
            motor,
            from: check(owner, "deviation.from", config.from, |_| true)? * along,
            per_step: 1.0 / (step * along),
            values: config
                .values
                .iter()
                .map(|value| (f64::from(*value) * across) as f32)
                .collect(),
        })
    }

    fn at(&self, axes: &[f64; AXES]) -> Deviation {
        let [value, slope] = smooth(&self.values, (axes[self.axis] - self.from) * self.per_step);
        Deviation {
            value,
            slope: slope * self.per_step,
        }
    }
}

/// The deviations of a machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compensation {
    tables: Vec<Table, DEVIATIONS>,
}

impl Compensation {
    /// Without any.
    pub const NONE: Self = Self { tables: Vec::new() };

    /// Takes one more table, of a motor that is `fitted`; one of the same axis and motor takes the place of the last.
    pub fn add(&mut self, config: &DeviationConfig, fitted: &[bool; MOTORS]) -> Result<(), ParameterError> {
        let table = Table::build(config, fitted)?;
        let same = |other: &&mut Table| (other.axis, other.motor) == (table.axis, table.motor);
        match self.tables.iter_mut().find(same) {
            Some(other) => *other = table,
            None => {
                let owner = MOTOR_NAMES[table.motor];
                let full = ParameterError::new(owner, "deviation.values", DEVIATIONS as f64);
                self.tables.push(table).map_err(|_| full)?;
            }
        }
        Ok(())
    }

    /// Motors, which would be at `motors`, to where the tool is where the `axes` say.
    pub fn place(&self, axes: &[f64; AXES], motors: &mut [f64; MOTORS]) {
        for table in &self.tables {
            motors[table.motor] -= table.at(axes).value;
        }
    }

    /// The same of velocities or accelerations `rates`, at `axes`. Of an acceleration v²·d″ is left out, 10⁻⁴ of it.
    pub fn rate(&self, axes: &[f64; AXES], rates: &[f64; AXES], motors: &mut [f64; MOTORS]) {
        for table in &self.tables {
            motors[table.motor] -= table.at(axes).slope * rates[table.axis];
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
        for table in &self.tables {
            actual[table.motor] += table.at(axes).value;
        }
        actual
    }
}
