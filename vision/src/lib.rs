//! The seam in pictures of a micro depth of field: measured, and rendered with a known truth.
//!
//! The camera looks at the work at an angle; its picture is sharp only in a thin band, where the focal plane cuts the
//! surface. Where that band is tells the height, its slope the roll, and the dark gap in it the seam (SPEC 0.12).

mod geometry;
mod image;
mod noise;
mod optics;
mod precision;
pub mod render;

pub use geometry::{Corner, CornerFeatures, GeometryError, PlateFeatures, PlateSeam};
pub use image::{Image, ImageError};
pub use noise::PhotonTransfer;
pub use optics::{Optics, OpticsError};
pub use precision::{Precision, Readings};
