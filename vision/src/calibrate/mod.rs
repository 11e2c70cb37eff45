//! What a camera is, found from its pictures: values in, values out.
//!
//! Each estimate says how good it is, and none is given that would mislead: the error says what the pictures showed
//! instead, and what to change.

mod corner;
mod depth;
mod fading;
mod least_squares;
mod slides;
mod spot;
mod transfer;

pub use corner::{CornerError, CornerFit, CornerPair, corner_offset};
pub use depth::{DepthError, DepthFit, DepthStep, depth_profile};
pub use slides::{SlideError, SlideFit, SlideReading, slide_matrix};
pub use spot::{BurntMark, Found, MarkSighting, SpotError, SpotFit, spot_offset};
pub use transfer::{TransferError, TransferFit, TransferLevel, photon_transfer};
