//! Arms and pivots of a machine, from where its tip was seen while its attitude changed.
//!
//! The tip goes with the lengths p in `[kinematics]` as f(q; p), linear in them. Where it was seen beside f(q; p) is J δp and one
//! place more, that of the work in the machine, which all attitudes have alike: what they differ by is the lengths'. Least squares;
//! lengths, or sums of them, that no attitude tells from that place stay as they are.

use nalgebra::{SMatrix, SVector, SymmetricEigen, Vector3};
use serde::Deserialize;
use shared::io::AXES;
use shared::kinematics::{AxisLimits, Kinematics, KinematicsConfig};
use shared::parameter::ParameterError;
use thiserror::Error;
use toml::{Table, Value};

/// Most lengths that a machine has: a chain of six joints, tip and work.
const MOST: usize = 24;
/// A change of lengths that moves the tip by less than this part of it, rms, is not seen.
const SEEN: f64 = 0.02;
/// A length that is seen by less than this part is seen together with others.
const ALONE: f64 = 0.999;
/// How far linear axes may be beside their places by their scales, which no attitude tells from arms \[mm\]: those of the class
/// ±3 µm/m over the half metre or so that they go.
const ACCURACY: f64 = 0.0015;
/// Lengths are changed by so much to see how the tip goes with them \[mm\].
const STEP: f64 = 1.0;
/// No arm is further off than this \[mm\]: then something else is wrong.
const FARTHEST: f64 = 5.0;

/// Where the tip was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenTip {
    /// With the axes here (mm, rad).
    pub axes: [f64; AXES],
    /// So far beside where the machine file has it, in the frame of the work \[mm\].
    pub beside_mm: [f64; 3],
}

/// A length in `[kinematics]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Keys and indices that lead to it, from the table of the machine.
    path: Vec<Step>,
    /// As it was \[mm\].
    pub before_mm: f64,
    /// As it was found \[mm\].
    pub found_mm: f64,
    /// Of what was found: 2 σ of what is left, and what scales may make of it \[mm\]; `None` of one that is not seen, or only together with others.
    pub uncertainty_mm: Option<f64>,
}

/// Where a value is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Step {
    Key(String),
    Index(usize),
}

/// What was found of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Arms {
    /// Its lengths.
    pub all: Vec<Arm>,
    /// How far the tip was beside its place, that of the work taken off: largest and rms \[mm\].
    pub before_mm: [f64; 2],
    /// What the lengths do not explain of that.
    pub left_mm: [f64; 2],
}

/// Why nothing was found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoArms {
    /// There are too few attitudes.
    #[error("{seen} attitudes tell too little of {lengths} lengths: {wanted} are needed at least")]
    Few {
        /// That were seen.
        seen: usize,
        /// Lengths that there are.
        lengths: usize,
        /// Attitudes that are needed.
        wanted: usize,
    },
    /// A length is too far off.
    #[error(
        "{arm} would be {off_mm:.2} mm off, more than {FARTHEST} mm: look at the machine file, and at what was measured"
    )]
    Far {
        /// Its name.
        arm: String,
        /// How far.
        off_mm: f64,
    },
    /// The geometry has too many of them, or no names.
    #[error("the geometry of this machine has no lengths that can be looked for")]
    NoLengths,
    /// The geometry makes no sense.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl Arm {
    /// Its name in the machine file, with the coordinate: `o1_mm x`.
    pub fn name(&self) -> String {
        let mut name = String::new();
        for (number, step) in self.path.iter().enumerate() {
            let last = number + 1 == self.path.len();
            match step {
                Step::Key(key) if name.is_empty() => name.push_str(key),
                Step::Key(key) => name.extend([".", key]),
                Step::Index(index) if last => name.extend([" ", ["x", "y", "z"].get(*index).unwrap_or(&"")]),
                Step::Index(index) => name.push_str(&format!(".{index}")),
            }
        }
        name
    }

    /// Key and index of one that stands in the table of the machine itself.
    pub(crate) fn place(&self) -> Option<(&str, Option<usize>)> {
        match &self.path[..] {
            [Step::Key(key)] => Some((key, None)),
            [Step::Key(key), Step::Index(index)] => Some((key, Some(*index))),
            _ => None,
        }
    }
}

/// The lengths of `believed`, a machine whose axes have these `limits`, by where its tip was seen.
///
/// # Errors
/// Why there are none.
pub fn arms(
    believed: &KinematicsConfig,
    limits: &[AxisLimits; AXES],
    seen: &[SeenTip],
) -> Result<Arms, NoArms> {
    let table = Table::try_from(believed).map_err(|_| NoArms::NoLengths)?;
    let mut lengths = Vec::new();
    if let Some(own) = table.get(believed.name()) {
        find(own, &mut Vec::new(), &mut lengths);
    }
    let wanted = lengths.len().div_ceil(3) + 2;
    if lengths.is_empty() || lengths.len() > MOST {
        return Err(NoArms::NoLengths);
    }
    if seen.len() < wanted {
        return Err(NoArms::Few {
            seen: seen.len(),
            lengths: lengths.len(),
            wanted,
        });
    }
    let machine = believed.build(limits)?;
    let mut ways = Vec::new();
    for (path, value) in &lengths {
        let mut longer = table.clone();
        if let Some(place) = longer.get_mut(believed.name()).and_then(|own| at(own, path)) {
            *place = Value::Float(value + STEP);
        }
        let longer = KinematicsConfig::deserialize(longer).map_err(|_| NoArms::NoLengths)?;
        ways.push(way(&machine, &longer.build(limits)?, seen));
    }
    Ok(fitted(lengths, &ways, seen)).and_then(refuse_far)
}

/// Lengths in a table: what is called so by its unit.
fn find(value: &Value, path: &mut Vec<Step>, lengths: &mut Vec<(Vec<Step>, f64)>) {
    let is_length = path
        .iter()
        .any(|step| matches!(step, Step::Key(key) if key.ends_with("_mm")));
    match value {
        Value::Float(length) if is_length => lengths.push((path.clone(), *length)),
        Value::Array(values) => {
            for (index, value) in values.iter().enumerate() {
                path.push(Step::Index(index));
                find(value, path, lengths);
                path.pop();
            }
        }
        Value::Table(values) => {
            for (key, value) in values {
                path.push(Step::Key(key.clone()));
                find(value, path, lengths);
                path.pop();
            }
        }
        _ => {}
    }
}

/// The value at `path`.
fn at<'a>(value: &'a mut Value, path: &[Step]) -> Option<&'a mut Value> {
    path.iter().try_fold(value, |value, step| match step {
        Step::Key(key) => value.get_mut(key.as_str()),
        Step::Index(index) => value.get_mut(*index),
    })
}

/// How the tip goes with a length, the mean of all places taken off.
fn way(machine: &Kinematics, longer: &Kinematics, seen: &[SeenTip]) -> Vec<Vector3<f64>> {
    let goes =
        |seen: &SeenTip| (longer.forward(&seen.axes).position - machine.forward(&seen.axes).position) / STEP;
    about_mean(seen.iter().map(goes).collect())
}

fn about_mean(mut places: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let mean = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
    places.iter_mut().for_each(|place| *place -= mean);
    places
}

fn fitted(lengths: Vec<(Vec<Step>, f64)>, ways: &[Vec<Vector3<f64>>], seen: &[SeenTip]) -> Arms {
    let beside = about_mean(seen.iter().map(|seen| Vector3::from(seen.beside_mm)).collect());
    let (mut normal, mut right) = (SMatrix::<f64, MOST, MOST>::zeros(), SVector::<f64, MOST>::zeros());
    let product =
        |a: &[Vector3<f64>], b: &[Vector3<f64>]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    for (row, way) in ways.iter().enumerate() {
        right[row] = product(way, &beside);
        for (column, other) in ways.iter().enumerate() {
            normal[(row, column)] = product(way, other);
        }
    }
    let eigen = SymmetricEigen::new(normal);
    let least = SEEN * SEEN * seen.len() as f64;
    let (mut inverse, mut is_seen, mut count) = (normal * 0.0, [0.0; MOST], 0);
    for (value, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least {
            inverse += direction * direction.transpose() / *value;
            for (part, along) in is_seen.iter_mut().zip(&direction) {
                *part += along * along;
            }
            count += 1;
        }
    }
    let change = inverse * right;
    let together = |weights: &dyn Fn(usize) -> f64, stand: usize| -> Vector3<f64> {
        let each = ways.iter().enumerate().map(|(k, way)| way[stand] * weights(k));
        each.sum()
    };
    let left: Vec<_> = (0..seen.len())
        .map(|stand| beside[stand] - together(&|k| change[k], stand))
        .collect();
    let free = (3 * seen.len()).saturating_sub(count + 3).max(1);
    let variance = left.iter().map(Vector3::norm_squared).sum::<f64>() / free as f64;
    let arm = |(number, (path, before_mm)): (usize, (Vec<Step>, f64))| {
        let weight = |stand| together(&|k| inverse[(number, k)], stand).norm();
        let by_scales = ACCURACY * (0..seen.len()).map(weight).sum::<f64>();
        let by_scatter = 2.0 * (variance * inverse[(number, number)]).sqrt();
        Arm {
            path,
            before_mm,
            found_mm: before_mm + change[number],
            uncertainty_mm: (is_seen[number] > ALONE).then_some(by_scatter + by_scales),
        }
    };
    Arms {
        all: lengths.into_iter().enumerate().map(arm).collect(),
        before_mm: largest_and_rms(&beside),
        left_mm: largest_and_rms(&left),
    }
}

fn refuse_far(arms: Arms) -> Result<Arms, NoArms> {
    let off = |arm: &Arm| (arm.found_mm - arm.before_mm).abs();
    match arms
        .all
        .iter()
        .find(|arm| off(arm) > FARTHEST || !off(arm).is_finite())
    {
        Some(arm) => Err(NoArms::Far {
            arm: arm.name(),
            off_mm: off(arm),
        }),
        None => Ok(arms),
    }
}

fn largest_and_rms(places: &[Vector3<f64>]) -> [f64; 2] {
    let largest = places.iter().map(Vector3::norm).fold(0.0, f64::max);
    let squares: f64 = places.iter().map(Vector3::norm_squared).sum();
    [largest, (squares / places.len() as f64).sqrt()]
}
