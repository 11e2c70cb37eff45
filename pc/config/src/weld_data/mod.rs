//! Weld data: named sets of what a weld is made with, in TOML (mm, seconds, the units of the machine file).

mod check;
#[cfg(test)]
mod tests;

use crate::RangeError;
use crate::toml_file::{self, TomlError};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use thiserror::Error;

/// What messages call the file.
const WHAT: &str = "weld data";
/// Name of the file beside a program.
pub const FILE: &str = "welddata.toml";

/// Why weld data cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum WeldDataError {
    /// It cannot be read, is not TOML, or a key is missing, unknown or of the wrong type.
    #[error(transparent)]
    File(#[from] TomlError),
    /// A value makes no sense.
    #[error("weld data {path}: {source}")]
    Value {
        /// The file.
        path: String,
        /// Which, and what it has to be.
        source: RangeError,
    },
    /// A pin does not burn.
    #[error(
        "weld data {path}: {set} has stir, and with it no {key}: its spindle turns evenly from before the plunge until after the retraction"
    )]
    Stirs {
        /// The file.
        path: String,
        /// The set.
        set: String,
        /// What it cannot have.
        key: &'static str,
    },
}

/// Sets by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeldData {
    /// The file, for messages; empty if there is none.
    pub path: String,
    /// The sets.
    pub sets: BTreeMap<String, WeldSet>,
}

/// What a weld is made with.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeldSet {
    /// 1 or 2.
    #[serde(default = "first_beam")]
    pub beam: u8,
    /// Power of the beam, or of the arc's source \[W\].
    pub power: f64,
    /// Digital outputs that are on from before the weld until after it, by name: shielding gas.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// Analog outputs during the weld, by name: speed of the wire.
    #[serde(default)]
    pub levels: BTreeMap<String, f64>,
    /// The outputs are on for so long before the beam goes on \[s\].
    #[serde(default)]
    pub pre_flow_s: f64,
    /// And after it went off \[s\].
    #[serde(default)]
    pub post_flow_s: f64,
    /// The beam first burns at rest.
    pub ignition: Option<AtRest>,
    /// Then its power goes evenly to that of the weld.
    pub ramp_up: Option<Ramp>,
    /// Towards the end it goes evenly to another one.
    pub ramp_down: Option<Ramp>,
    /// The beam burns at rest in the end.
    pub crater_fill: Option<AtRest>,
    /// Power in proportion to the path speed.
    pub by_speed: Option<BySpeed>,
    /// The tip swings across the seam.
    pub weave: Option<Weave>,
    /// The weld lies so far beside the programmed seam: to the left of travel, and along the tool away from the work \[mm\].
    #[serde(default)]
    pub offset_mm: [f64; 2],
    /// Stretches of the seam that are welded already.
    #[serde(default)]
    pub tacks: Vec<Tack>,
    /// Changes on the way.
    #[serde(default)]
    pub changes: Vec<Change>,
    /// The beam is a spindle whose pin goes into the work.
    pub stir: Option<Stir>,
}

fn first_beam() -> u8 {
    1
}

/// A time at rest.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtRest {
    /// Power \[W\].
    pub power: f64,
    /// How long \[s\].
    pub time_s: f64,
}

/// A length over which the power changes evenly.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    /// Power at its outer end \[W\]; after an ignition that of the ignition.
    pub power: f64,
    /// Its length \[mm\].
    pub over_mm: f64,
}

/// How the power depends on the path speed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BySpeed {
    /// From this speed on it is full \[mm/s\].
    pub full_mm_s: f64,
    /// The part that it keeps at rest, 0 to 1.
    pub least: f64,
}

/// A swing across the seam.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weave {
    /// How it crosses.
    pub form: WeaveForm,
    /// To either side \[mm\].
    pub amplitude_mm: f64,
    /// At the feed of the seam \[Hz\].
    pub frequency_hz: f64,
    /// How long it goes along at either side \[s\]; these times are part of the period.
    #[serde(default)]
    pub dwell_s: f64,
}

/// How a weave goes from one side to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WeaveForm {
    /// As a cosine.
    Sine,
    /// Straight.
    Triangle,
}

/// A stretch of the seam that a tack holds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tack {
    /// From the beginning of the seam \[mm\].
    pub from_mm: f64,
    /// To there \[mm\].
    pub to_mm: f64,
    /// Power over it \[W\]; the beam is off where none is given.
    pub power: Option<f64>,
}

/// Friction stir: how the pin goes into the work and out of it, along the tool.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stir {
    /// The seam is programmed so far above the surface \[mm\].
    pub clearance_mm: f64,
    /// The tip of the pin is so far below the surface during the weld \[mm\].
    pub depth_mm: f64,
    /// The spindle runs up for so long, above the work \[s\].
    pub spin_up_s: f64,
    /// Speed of the plunge \[mm/s\].
    pub plunge_mm_s: f64,
    /// The pin then turns in place for so long \[s\].
    pub dwell_s: f64,
    /// Speed of the retraction \[mm/s\].
    pub retract_mm_s: f64,
}

/// A change on the way.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// From the beginning of the seam \[mm\].
    pub at_mm: f64,
    /// Evenly over so much of it \[mm\].
    #[serde(default)]
    pub over_mm: f64,
    /// To this power \[W\].
    pub power: Option<f64>,
    /// Analog outputs to these values, by name.
    #[serde(default)]
    pub levels: BTreeMap<String, f64>,
}

impl WeldData {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// As of [`WeldDataError`].
    pub fn read(path: &Path) -> Result<Self, WeldDataError> {
        Self::parse(&path.display().to_string(), &toml_file::text(WHAT, path)?)
    }

    /// [`FILE`] in the folder of `program`, if it is there; no sets if not.
    ///
    /// # Errors
    /// As of [`WeldDataError`].
    pub fn beside(program: &Path) -> Result<Self, WeldDataError> {
        let file = program.with_file_name(FILE);
        match file.exists() {
            true => Self::read(&file),
            false => Ok(Self::default()),
        }
    }

    /// Understands `text`; `path` is used in messages only.
    ///
    /// # Errors
    /// As of [`WeldDataError`].
    pub fn parse(path: &str, text: &str) -> Result<Self, WeldDataError> {
        let sets: BTreeMap<String, WeldSet> = toml_file::parse(WHAT, path, text)?;
        for (name, set) in &sets {
            set.check().map_err(|error| WeldDataError::Value {
                path: path.to_owned(),
                source: error.within(name),
            })?;
            if let Some(key) = set.burns_while_stirring() {
                return Err(WeldDataError::Stirs {
                    path: path.to_owned(),
                    set: name.clone(),
                    key,
                });
            }
        }
        Ok(Self {
            path: path.to_owned(),
            sets,
        })
    }
}

impl WeldSet {
    /// Number of the beam, from 0.
    pub fn side(&self) -> u8 {
        self.beam - 1
    }
}
