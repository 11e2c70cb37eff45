//! What is wrong with a calibration file.

use crate::toml_file::TomlError;
use thiserror::Error;

/// Why a calibration cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum CalibrationError {
    /// The file cannot be read.
    #[error("cannot read calibration {path}: {source}; `seamwright calibrate` writes one")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not TOML, or a key is missing, unknown or of the wrong type.
    #[error(transparent)]
    File(#[from] TomlError),
    /// A value makes no sense.
    #[error("calibration {path}, line {line}: {reason}")]
    Value {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// What is wrong, and what to do.
        reason: String,
    },
}
