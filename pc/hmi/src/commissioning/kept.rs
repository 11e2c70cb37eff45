//! What was measured of a motor, on the disk: `NAME.commissioning/MOTOR.toml` beside the machine file `NAME.toml`.

use anyhow::Context;
use commission::CapturedMotion;
use serde::{Deserialize, Serialize};
use shared::control::MotorConfig;
use shared::io::MOTOR_NAMES;
use shared::protocol::{CaptureSample, Excitation};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// See the module.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Kept {
    /// RFC 3339.
    pub measured_at: String,
    /// What the machine file had of the motor then,
    pub motor: MotorConfig,
    /// and after what was found had been written.
    pub written: Option<MotorConfig>,
    /// In the order in which it was captured.
    pub captured: Vec<KeptCapture>,
}

/// A column of the samples of a capture is a list.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeptCapture {
    command: Vec<i16>,
    counts: Vec<i32>,
    error: Vec<f32>,
    excitation: Excitation,
}

impl From<&CapturedMotion> for KeptCapture {
    fn from(captured: &CapturedMotion) -> Self {
        let samples = captured.samples.iter();
        Self {
            command: samples.clone().map(|sample| sample.command).collect(),
            counts: samples.clone().map(|sample| sample.counts).collect(),
            error: samples.map(|sample| sample.error).collect(),
            excitation: captured.excitation,
        }
    }
}

impl From<KeptCapture> for CapturedMotion {
    /// Samples of which a column is missing are left out.
    fn from(kept: KeptCapture) -> Self {
        let columns = kept.command.into_iter().zip(kept.counts).zip(kept.error);
        let sample = |((command, counts), error)| CaptureSample {
            command,
            counts,
            error,
        };
        Self {
            excitation: kept.excitation,
            samples: columns.map(sample).collect(),
        }
    }
}

/// Keeps what was captured of the motor with this index, which the machine file `machine` has as `motor`, in place of what was kept
/// before.
///
/// # Errors
/// A sentence: it cannot be written.
pub fn keep(
    machine: &Path,
    index: usize,
    motor: &MotorConfig,
    captured: &[&CapturedMotion],
) -> anyhow::Result<()> {
    let kept = Kept {
        measured_at: jiff::ZonedDateTime::now()
            .strftime("%Y-%m-%dT%H:%M:%S%:z")
            .to_string(),
        motor: motor.clone(),
        written: None,
        captured: captured
            .iter()
            .map(|captured| KeptCapture::from(*captured))
            .collect(),
    };
    kept.write(machine, index)
}

impl Kept {
    /// Of the motor with this index, if there is any.
    ///
    /// # Errors
    /// A sentence with the file.
    pub fn read(machine: &Path, index: usize) -> anyhow::Result<Option<Self>> {
        let file = path(machine, index);
        let text = match std::fs::read_to_string(&file) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            text => text.with_context(|| format!("cannot read {}", file.display()))?,
        };
        let kept = toml::from_str(&text).with_context(|| file.display().to_string())?;
        Ok(Some(kept))
    }

    /// Writes it.
    ///
    /// # Errors
    /// A sentence with the file.
    pub fn write(&self, machine: &Path, index: usize) -> anyhow::Result<()> {
        let file = path(machine, index);
        let cannot = || format!("cannot write {}", file.display());
        std::fs::create_dir_all(folder(machine)).with_context(cannot)?;
        let text = toml::to_string(self).with_context(cannot)?;
        config::kept::replace(&file, &text).with_context(cannot)
    }
}

fn folder(machine: &Path) -> PathBuf {
    machine.with_extension("commissioning")
}

fn path(machine: &Path, index: usize) -> PathBuf {
    folder(machine).join(MOTOR_NAMES[index]).with_extension("toml")
}
