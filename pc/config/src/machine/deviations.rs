//! Measured deviations of the axes: `[deviations.OF.ALONG]`.

use super::Mistake;
use crate::in_range;
use serde::Deserialize;
use shared::config::{
    DEVIATION_POINTS, DEVIATION_POINTS_IN_ALL, DEVIATIONS, DeviationConfig, MOST_DEVIATION, MotionConfig,
    STEEPEST_DEVIATION,
};
use shared::io::{AXIS_NAMES, MOTOR_NAMES, MOTORS, is_called};
use shared::motion::Machine;
use std::collections::BTreeMap;

/// As they are written: by what deviates, and then by the axis along which that was measured.
pub type Tables = BTreeMap<String, BTreeMap<String, Table>>;

/// One table (mm, degrees).
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Coordinate of the axis at the first value.
    from: f64,
    /// From one value to the next.
    step: f64,
    /// Actual place less target.
    values: Vec<f64>,
}

/// All tables, one for each motor, those of both motors of a gantry where the axis is named; as the board will take them.
pub(super) fn build(tables: &Tables, motion: &MotionConfig) -> Result<Vec<DeviationConfig>, Mistake> {
    let mut all = Vec::new();
    for (of, by_axis) in tables {
        let motors = motors(of, motion);
        if motors.is_empty() {
            let key = format!("deviations.{of}");
            return Err(unusable(key, "is of no motor and no axis of this machine"));
        }
        for (along, table) in by_axis {
            let key = format!("deviations.{of}.{along}");
            let axis = AXIS_NAMES.iter().position(|name| name == along);
            let Some(axis) = axis.filter(|axis| motion.axes[*axis].is_some()) else {
                return Err(unusable(key, "is along no axis of this machine"));
            };
            table.check(&key)?;
            for motor in &motors {
                let config = table.config(axis, *motor);
                if all
                    .iter()
                    .any(|other: &DeviationConfig| (other.axis, other.motor) == (config.axis, config.motor))
                {
                    let motor = MOTOR_NAMES[*motor];
                    return Err(unusable(key, &format!("is of {motor}, which has another one")));
                }
                all.push(config);
            }
        }
    }
    if all.len() > DEVIATIONS {
        let key = "deviations".to_owned();
        let what = format!(
            "are {}, but at most {DEVIATIONS} may be, one for each motor",
            all.len()
        );
        return Err(unusable(key, &what));
    }
    let points: usize = all.iter().map(|table| table.values.len()).sum();
    if points > DEVIATION_POINTS_IN_ALL {
        let key = "deviations".to_owned();
        let what = format!(
            "have {points} values, but the board takes {DEVIATION_POINTS_IN_ALL}, each for every motor of its axis: choose longer steps"
        );
        return Err(unusable(key, &what));
    }
    Ok(all)
}

/// What is wrong with the first that `machine` does not take.
pub(super) fn check(deviations: &[DeviationConfig], machine: &mut Machine) -> Result<(), Mistake> {
    for deviation in deviations {
        let (motor, axis) = (usize::from(deviation.motor), usize::from(deviation.axis));
        machine
            .compensate(deviation)
            .map_err(|error| Mistake::Deviations {
                key: format!("deviations.{}.{}", MOTOR_NAMES[motor], AXIS_NAMES[axis]),
                what: format!("cannot be: {error}"),
            })?;
    }
    Ok(())
}

impl Table {
    fn check(&self, key: &str) -> Result<(), Mistake> {
        in_range(format!("{key}.from"), self.from, true, "a finite number")?;
        in_range(format!("{key}.step"), self.step, self.step > 0.0, "above 0")?;
        let count = self.values.len();
        if !(2..=DEVIATION_POINTS).contains(&count) {
            let what = format!("has {count} values, but must have from 2 to {DEVIATION_POINTS}");
            return Err(unusable(key.to_owned(), &what));
        }
        for value in &self.values {
            let key = format!("{key}.values");
            in_range(key, *value, value.abs() <= MOST_DEVIATION, "between -1 and 1")?;
        }
        let most = STEEPEST_DEVIATION * self.step;
        let steep = |pair: &&[f64]| (pair[1] - pair[0]).abs() > most;
        if let Some(pair) = self.values.windows(2).find(steep) {
            let what = format!(
                "goes from {} to {} in one step, but may change by {most:.4} at most, 1 % of the step: are the values in mm, not in µm?",
                pair[0], pair[1]
            );
            return Err(unusable(key.to_owned(), &what));
        }
        Ok(())
    }

    fn config(&self, axis: usize, motor: usize) -> DeviationConfig {
        DeviationConfig {
            axis: axis as u8,
            motor: motor as u8,
            from: self.from,
            step: self.step,
            values: self.values.iter().map(|value| *value as f32).collect(),
        }
    }
}

/// Numbers of the motors that are called so.
fn motors(name: &str, motion: &MotionConfig) -> Vec<usize> {
    (0..MOTORS)
        .filter(|motor| motion.motors[*motor].is_some() && is_called(*motor, name))
        .collect()
}

fn unusable(key: String, what: &str) -> Mistake {
    Mistake::Deviations {
        key,
        what: what.to_owned(),
    }
}
