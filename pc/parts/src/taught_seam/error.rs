//! Why no program can be planned for a taught seam.

use cam::path::Tip;
use config::RangeError;
use config::table::TableError;
use shared::parameter::ParameterError;
use thiserror::Error;

/// Why no program can be planned for a taught seam. Reads as one sentence.
#[derive(Debug, Error)]
pub(super) enum TaughtSeamError {
    #[error("{file} is not there: seamwright teach writes it, or give the key taught another file")]
    Untaught { file: String },
    #[error(transparent)]
    Points(#[from] TableError),
    #[error(transparent)]
    Value(#[from] RangeError),
    #[error("passes is empty: give one pass at least, such as {{ weld = \"root\", mm_min = 480.0 }}")]
    NoPass,
    #[error("passes.weld is \"{name}\", but the name of a set has letters, digits, - and _ only")]
    Name { name: String },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(
        "the machine does not reach X{:.2} Y{:.2} Z{:.2}, approach_mm before the seam: correct approach_mm, or turn the tool", tip.position_mm[0], tip.position_mm[1], tip.position_mm[2]
    )]
    Approach { tip: Tip },
}
