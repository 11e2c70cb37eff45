//! Why there is no prediction.

use crate::path::PathError;
use shared::parameter::ParameterError;
use shared::trajectory::{PushError, Unreachable};
use thiserror::Error;

/// Why a program cannot be run off-line.
#[derive(Debug, Error)]
pub enum DryRunError {
    /// The machine or its limits do not allow the path.
    #[error(transparent)]
    Path(#[from] PathError),
    /// A machine parameter is out of range.
    #[error("a machine parameter is out of range: {0}")]
    Parameter(#[from] ParameterError),
    /// An element is not one that the planner takes.
    #[error(transparent)]
    Element(#[from] PushError),
    /// There is no reference for the axes.
    #[error(transparent)]
    Reference(#[from] Unreachable),
    /// The planner does not continue.
    #[error(
        "line {line}: the planner does not move on, {s_mm:.3} mm along path {path}; please report the program"
    )]
    Stuck {
        /// Line of the program.
        line: u32,
        /// Number of the path.
        path: usize,
        /// Where on it \[mm\].
        s_mm: f64,
    },
}
