//! The calibration of a camera from pictures of which something is known.

mod pictures;
pub mod procedure;
pub mod spot;

pub use pictures::{PICTURES, ReferencePicture, parse_list, read_pictures};
pub use procedure::CalibrateError;
