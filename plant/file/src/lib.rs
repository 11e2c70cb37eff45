//! Plant files: what is true of a simulated machine, as its machine file is what the controller believes.
//!
//! Each shipped machine has one, `machines/NAME.plant.toml`, which is part of the programs. Another one can be read, or
//! drawn at random around the shipped one ([`Quality`]). Fields are those of [`plant::PlantConfig`], by the names of motors
//! and slides, and of [`CameraMount`].

mod check;
mod draw;
mod read;
mod shipped;

pub use draw::{Defect, Quality};
pub use read::PlantFileError;
pub use shipped::{COMMISSIONED, DEFAULT_MACHINE, names};

use plant::{AngularErrors, Growth, LONGEST, MotionPlant, PlantConfig, SlidePlant, TrueChain};
use serde::Deserialize;
use shared::config::MotionConfig;
use shared::io::{AXES, MOTOR_NAMES, SIDES};
use shared::kinematics::KinematicsConfig;
use shared::parameter::ParameterError;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// What is true of a simulated machine.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantFile {
    /// What the boards are wired to.
    pub plant: PlantConfig,
    /// How the cameras are mounted.
    pub cameras: [CameraMount; SIDES],
    /// The geometry; that of the machine file if left out.
    pub kinematics: Option<KinematicsConfig>,
    /// Angles by which the joints of the axes turn what they carry.
    pub angular: [AngularErrors; AXES],
}

/// How a camera is mounted, against what the machine file says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraMount {
    /// The camera is so far beside the place where it would be right above the spot's path, in U and V \[mm\]. What it sees
    /// seems to be as far on the other side.
    #[serde(default)]
    pub beside_spot_mm: [f64; 2],
    /// How far it is ahead of the spot \[mm\]; the lead of the machine file if left out.
    #[serde(default)]
    pub lead_mm: Option<f64>,
    /// So much further ahead than that \[mm\].
    #[serde(default)]
    pub lead_error_mm: f64,
    /// It exposes so long after its strobe \[s\].
    #[serde(default)]
    pub delay_s: f64,
    /// Up to so much later than that, another time at each strobe \[s\].
    #[serde(default)]
    pub jitter_s: f64,
    /// It is turned by so much more than believed, about T \[deg\].
    #[serde(default)]
    pub turned_deg: f64,
    /// As it warms, it goes so far beside where it was, in U and V \[mm\].
    #[serde(default)]
    pub drift_mm: [Growth; 2],
}

/// Which plant.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum PlantChoice {
    /// The shipped one of the machine.
    #[default]
    Shipped,
    /// Of a file.
    File(PathBuf),
    /// Drawn at random around the shipped one.
    Drawn {
        /// How good it is.
        quality: Quality,
        /// Which one.
        seed: u32,
    },
}

impl FromStr for PlantChoice {
    type Err = String;

    /// `draw:QUALITY:SEED`, or the name of a file.
    fn from_str(text: &str) -> Result<Self, String> {
        let Some(drawn) = text.strip_prefix("draw:") else {
            return Ok(Self::File(text.into()));
        };
        let (quality, seed) = drawn
            .split_once(':')
            .ok_or("say which one: draw:usual:SEED, draw:poor:SEED or draw:bad:SEED, with a whole number")?;
        Ok(Self::Drawn {
            quality: quality.parse()?,
            seed: seed
                .parse()
                .map_err(|_| format!("{seed} is no seed: give a whole number from 0 to {}", u32::MAX))?,
        })
    }
}

impl fmt::Display for PlantChoice {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Shipped => f.write_str("as shipped"),
            Self::File(path) => path.display().fmt(f),
            Self::Drawn { quality, seed } => write!(f, "draw:{quality}:{seed}"),
        }
    }
}

impl PlantChoice {
    /// The plant for the machine that is called so, as its kinematics are.
    pub fn of(&self, machine: &str) -> Result<PlantFile, PlantFileError> {
        match self {
            Self::Shipped => PlantFile::shipped(machine),
            Self::File(path) => {
                let file = PlantFile::read(path)?;
                match file.kinematics.as_ref().map(KinematicsConfig::name) {
                    Some(name) if name != machine => Err(PlantFileError::OfAnotherMachine {
                        path: path.display().to_string(),
                        name,
                        machine: machine.to_owned(),
                    }),
                    _ => Ok(file),
                }
            }
            Self::Drawn { quality, seed } => Ok(draw::around(PlantFile::shipped(machine)?, *quality, *seed)),
        }
    }
}

/// Which motor of `draw:bad:SEED` of the machine that is called so has what defect.
///
/// # Errors
/// There is no such machine.
pub fn defect(machine: &str, seed: u32) -> Result<Option<(&'static str, Defect)>, PlantFileError> {
    let found = draw::defect(&PlantFile::shipped(machine)?, seed);
    Ok(found.map(|(motor, defect)| (MOTOR_NAMES[motor], defect)))
}

impl PlantFile {
    /// The motors.
    pub fn motion(&self) -> MotionPlant {
        MotionPlant::new(&self.plant)
    }

    /// The slides.
    pub fn slides(&self) -> SlidePlant {
        SlidePlant::new(&self.plant)
    }

    /// Where the tool truly is, on a machine whose controller believes `motion`.
    ///
    /// # Errors
    /// The geometry is one of another machine, or none.
    pub fn chain(&self, motion: &MotionConfig) -> Result<TrueChain, ParameterError> {
        let truly = MotionConfig {
            kinematics: self
                .kinematics
                .clone()
                .unwrap_or_else(|| motion.kinematics.clone()),
            ..motion.clone()
        };
        let joints = (0..AXES).filter_map(|number| truly.kinematics.joint(number));
        Ok(TrueChain::new(truly.kinematics()?, joints, self.angular))
    }

    /// The plant as an emulated board reads it.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = vec![0; LONGEST];
        let used = postcard::to_slice(&self.plant, &mut bytes).map(|used| used.len());
        // Numbers of bounded count; a test holds the largest against the room.
        bytes.truncate(used.unwrap_or_default());
        bytes
    }
}

#[cfg(test)]
mod tests;
