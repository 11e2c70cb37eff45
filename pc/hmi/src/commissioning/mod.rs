//! Motors of a machine while they are commissioned: what was measured of them, what is found of that, and what is written.
//!
//! What was measured is kept in a folder beside the machine file, a file a motor. All else comes of that and of the machine
//! file, so that another start goes on where the last one ended.

mod kept;

pub use kept::keep;

use crate::parameters::Parameters;
use anyhow::Context;
use commission::{CapturedMotion, Found, Line, Margins, NotFound, Requirements, measured, rewrite_all};
use config::machine::MachineFile;
use kept::Kept;
use shared::config::MotionConfig;
use shared::control::MotorConfig;
use shared::io::{MOTOR_NAMES, MOTORS};
use std::path::{Path, PathBuf};

/// See the module.
#[derive(Debug)]
pub struct Commissioning {
    /// The machine file.
    file: PathBuf,
    /// The motors that the machine has.
    pub motors: Vec<Motor>,
}

/// A motor.
#[derive(Debug)]
pub struct Motor {
    /// Its index among all that a machine may have.
    pub index: usize,
    /// What is known of it.
    pub known: Known,
}

/// What is known of a motor.
#[derive(Debug)]
pub enum Known {
    /// It was not measured.
    Nothing,
    /// What was measured cannot be read, and why.
    Unreadable(String),
    /// It was measured.
    Measured(Box<Measured>),
}

/// A motor that was measured.
#[derive(Debug)]
pub struct Measured {
    /// When, by RFC 3339.
    pub at: String,
    /// How that is related to what the machine file has.
    pub standing: Standing,
    /// Its parameters before what was found.
    pub before: MotorConfig,
    /// Its response, believed or not.
    pub lines: Vec<Line>,
    /// What was found, or why it is left as it is.
    pub found: Result<Found, NotFound>,
}

/// How what was measured is related to what the machine file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The file has what it had then.
    Current,
    /// It was changed since otherwise than by what was found.
    Changed,
    /// It has what was found.
    Written,
}

/// How a loop was before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It swings by itself.
    Swings,
    /// It has less than the margins that are kept.
    TooLittle,
    /// It has them.
    Enough,
}

impl Verdict {
    /// Of these margins.
    pub fn of(margins: &Margins) -> Self {
        if margins.gain_db < 0.0 || margins.phase_deg < 0.0 {
            Self::Swings
        } else if Requirements::default().are_kept(margins) {
            Self::Enough
        } else {
            Self::TooLittle
        }
    }
}

impl Motor {
    /// Its name.
    pub fn name(&self) -> &'static str {
        MOTOR_NAMES[self.index]
    }

    /// What was measured.
    pub fn measured(&self) -> Option<&Measured> {
        match &self.known {
            Known::Measured(measured) => Some(measured),
            Known::Nothing | Known::Unreadable(_) => None,
        }
    }

    /// What was found and is not in the machine file.
    pub fn unwritten(&self) -> Option<&Found> {
        let measured = self
            .measured()
            .filter(|measured| measured.standing != Standing::Written);
        measured?.found.as_ref().ok()
    }
}

impl Commissioning {
    /// Of the machine in `file`. Takes some tenths of a second for each motor that was measured.
    ///
    /// # Errors
    /// A sentence: the machine file cannot be read.
    pub fn open(file: &Path) -> anyhow::Result<Self> {
        let machine = MachineFile::read(file)?;
        let motor = |index: usize| {
            let now = machine.motion.motors[index].as_ref()?;
            let known = match Kept::read(file, index) {
                Ok(None) => Known::Nothing,
                Ok(Some(kept)) => Known::Measured(Box::new(evaluated(&machine.motion, kept, index, now))),
                Err(error) => Known::Unreadable(config::sentence(error.as_ref())),
            };
            Some(Motor { index, known })
        };
        Ok(Self {
            file: file.to_owned(),
            motors: (0..MOTORS).filter_map(motor).collect(),
        })
    }

    /// The motor with this index.
    pub fn motor(&self, index: usize) -> Option<&Motor> {
        self.motors.iter().find(|motor| motor.index == index)
    }

    /// The machine file with what was found of these motors, as changes that are not written yet.
    ///
    /// # Errors
    /// A sentence: it cannot be read, or has not these motors.
    pub fn proposal(&self, indices: &[usize]) -> anyhow::Result<Parameters> {
        let mut parameters = Parameters::open(&self.file)?;
        let file = || format!("machine file {}", self.file.display());
        let machine = MachineFile::read(&self.file)?;
        let text = std::fs::read_to_string(&self.file).with_context(file)?;
        let chosen = self.motors.iter().filter(|motor| indices.contains(&motor.index));
        let loops: Vec<_> = chosen
            .filter_map(|motor| Some((motor.index, &motor.unwritten()?.of_loop)))
            .collect();
        parameters.propose(rewrite_all(&text, &machine.motion, indices, &loops).with_context(file)?);
        Ok(parameters)
    }

    /// Notes that the machine file has what was found of these motors now.
    ///
    /// # Errors
    /// A sentence: a file cannot be read or written.
    pub fn note_written(&self, indices: &[usize]) -> anyhow::Result<()> {
        let machine = MachineFile::read(&self.file)?;
        for index in indices {
            if let Some(mut kept) = Kept::read(&self.file, *index)? {
                kept.written.clone_from(&machine.motion.motors[*index]);
                kept.write(&self.file, *index)?;
            }
        }
        Ok(())
    }
}

/// What was kept of the motor with this index of `machine`, whose parameters are `now` in the machine file.
fn evaluated(machine: &MotionConfig, kept: Kept, index: usize, now: &MotorConfig) -> Measured {
    let standing = match () {
        () if kept.written.as_ref() == Some(now) => Standing::Written,
        () if kept.motor == *now => Standing::Current,
        () => Standing::Changed,
    };
    // What was captured is in counts and codes: with changed parameters it tells of these.
    let before = match standing {
        Standing::Changed => now.clone(),
        Standing::Current | Standing::Written => kept.motor,
    };
    let captured: Vec<CapturedMotion> = kept.captured.into_iter().map(Into::into).collect();
    Measured {
        at: kept.measured_at,
        standing,
        // Without a whole capture there is none, and nothing is found.
        lines: measured(&before, index, &captured).unwrap_or_default(),
        found: Found::of(machine, Some(&before), index, &captured),
        before,
    }
}

#[cfg(test)]
mod tests;
