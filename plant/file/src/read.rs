//! Reading a plant file.

use crate::{CameraMount, PlantFile, check};
use config::toml_file::{self, TomlError};
use plant::{
    AngularError, AngularErrors, BeamConfig, ERRORS, GeometryConfig, MotorConfig, PlantConfig, SlideConfig,
    TouchConfig, Wave,
};
use serde::Deserialize;
use shared::io::{AXES, AXIS_NAMES, MOTOR_NAMES, SLIDE_NAMES, is_called};
use shared::kinematics::KinematicsConfig;
use std::collections::BTreeMap;
use std::path::Path;
use thiserror::Error;

const WHAT: &str = "plant file";

/// Why there is no plant.
#[derive(Debug, Error)]
pub enum PlantFileError {
    /// The file cannot be read, is not TOML, or has a wrong key.
    #[error(transparent)]
    Toml(#[from] TomlError),
    /// A value makes no sense.
    #[error("plant file {path}, line {line}: {key} {what}")]
    Mistake {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// Dotted name of the value.
        key: String,
        /// What is wrong with it.
        what: String,
    },
    /// Its geometry is that of another machine.
    #[error("plant file {path}: kinematics.{name} is not the geometry of the machine, which is a {machine}")]
    OfAnotherMachine {
        /// The file.
        path: String,
        /// What it has.
        name: &'static str,
        /// What it must have.
        machine: String,
    },
    /// No machine is called so.
    #[error(
        "there is no plant for a machine called {machine}; there are {known}. Give one with --plant FILE"
    )]
    Unknown {
        /// The name.
        machine: String,
        /// The names there are.
        known: String,
    },
}

/// As it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    /// Start of all noise.
    #[serde(default = "first")]
    seed: u32,
    motors: BTreeMap<String, MotorConfig>,
    #[serde(default)]
    slides: BTreeMap<String, SlideConfig>,
    #[serde(default)]
    cameras: BTreeMap<String, CameraMount>,
    /// By what is beside its place, and by the axis along which it is.
    #[serde(default)]
    geometry: BTreeMap<String, BTreeMap<String, GeometryError>>,
    beam: Option<BeamConfig>,
    touch: Option<TouchConfig>,
    kinematics: Option<KinematicsConfig>,
    /// By the axis about which a joint turns, and by its own.
    #[serde(default)]
    angular: BTreeMap<String, BTreeMap<String, AngularError>>,
}

/// An error of geometry.
#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct GeometryError {
    #[serde(default)]
    slope: f64,
    #[serde(default)]
    wave: Wave,
}

fn first() -> u32 {
    1
}

/// Turns about x, y and z as files call them.
pub(crate) const ABOUT: [&str; 3] = ["A", "B", "C"];

/// Sides as files call them.
const CAMERA_NAMES: [&str; 2] = ["1", "2"];

impl PlantFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Names file, line and value.
    pub fn read(path: &Path) -> Result<Self, PlantFileError> {
        Self::parse(&path.display().to_string(), &toml_file::text(WHAT, path)?)
    }

    /// Understands `text`; `path` is used in messages only.
    ///
    /// # Errors
    /// As [`PlantFile::read`].
    pub fn parse(path: &str, text: &str) -> Result<Self, PlantFileError> {
        let document: Document = toml_file::parse(WHAT, path, text)?;
        let mistake = |(key, what): (String, String)| PlantFileError::Mistake {
            path: path.to_owned(),
            line: toml_file::line_of(text, &key),
            key,
            what,
        };
        let motors = in_order("motors", document.motors, MOTOR_NAMES).map_err(mistake)?;
        let slides = in_order("slides", document.slides, SLIDE_NAMES).map_err(mistake)?;
        let cameras = in_order("cameras", document.cameras, CAMERA_NAMES).map_err(mistake)?;
        let geometry = geometry(&document.geometry, &motors).map_err(mistake)?;
        let plant = PlantFile {
            plant: PlantConfig {
                motors,
                slides,
                geometry: geometry.into_iter().collect(),
                beam: document.beam,
                touch: document.touch,
                seed: document.seed,
            },
            cameras: cameras.map(Option::unwrap_or_default),
            kinematics: document.kinematics,
            angular: angular(document.angular).map_err(mistake)?,
        };
        check::plant(&plant).map_err(mistake)?;
        Ok(plant)
    }
}

/// Key and what is wrong with its value.
pub(crate) type Mistake = (String, String);

/// What is called by `names`, in their order.
fn in_order<T, const N: usize>(
    table: &str,
    mut named: BTreeMap<String, T>,
    names: [&str; N],
) -> Result<[Option<T>; N], Mistake> {
    let found = names.map(|name| named.remove(name));
    match named.into_keys().next() {
        Some(name) => Err((
            format!("{table}.{name}"),
            format!("is not known: there are {}", names.join(", ")),
        )),
        None => Ok(found),
    }
}

/// Errors of geometry by motors; one of an axis is that of all its motors.
fn geometry(
    errors: &BTreeMap<String, BTreeMap<String, GeometryError>>,
    motors: &[Option<MotorConfig>],
) -> Result<Vec<GeometryConfig>, Mistake> {
    let mut all = Vec::new();
    for (of, by_axis) in errors {
        for (along, error) in by_axis {
            let key = format!("geometry.{of}.{along}");
            let motors: Vec<usize> = (0..motors.len())
                .filter(|motor| motors[*motor].is_some() && is_called(*motor, of))
                .collect();
            let axis = AXIS_NAMES.iter().position(|name| name == along);
            let (false, Some(axis)) = (motors.is_empty(), axis) else {
                return Err((key, "names a motor or an axis that is not there".to_owned()));
            };
            all.extend(motors.into_iter().map(|motor| GeometryConfig {
                motor: motor as u8,
                axis: axis as u8,
                slope: error.slope,
                wave: error.wave,
            }));
        }
    }
    if all.len() > ERRORS {
        let what = format!("are {}, at most {ERRORS} may be, one for each motor", all.len());
        return Err(("geometry".to_owned(), what));
    }
    Ok(all)
}

/// Angular errors by axes. They are called as in ISO 230-1: `A.X` is roll of X.
fn angular(
    errors: BTreeMap<String, BTreeMap<String, AngularError>>,
) -> Result<[AngularErrors; AXES], Mistake> {
    let mut all = [AngularErrors::default(); AXES];
    for (about, by_axis) in errors {
        for (along, error) in by_axis {
            let place = ABOUT.iter().position(|name| *name == about);
            let axis = AXIS_NAMES.iter().position(|name| *name == along);
            let (Some(about), Some(axis)) = (place, axis) else {
                return Err((
                    format!("angular.{about}.{along}"),
                    "is not known: A, B or C turn, along X, Y, Z, A, B or C".to_owned(),
                ));
            };
            all[axis][about] = error;
        }
    }
    Ok(all)
}
