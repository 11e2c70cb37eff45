//! Files that describe a machine, and what all files have in common: problems are named by file, line and key.

mod by_side;
pub mod calibration;
pub mod gige;
pub mod kept;
pub mod machine;
pub mod parameters;
pub mod probe;
mod range;
mod sentence;
pub mod sets;
pub mod table;
pub mod toml_file;
pub mod weld_data;
pub mod work_offsets;

pub use range::{RangeError, in_range};
pub use sentence::sentence;
