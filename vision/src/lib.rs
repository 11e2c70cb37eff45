//! The seam in pictures of a micro depth of field: measured, and rendered with a known truth.
//!
//! The camera looks at the work at an angle; its picture is sharp only in a thin band, where the focal plane cuts the
//! surface. The band's place gives the height, its slope the roll, the gap in it the seam (mathematics 0.12).

mod band;
pub mod calibrate;
mod cells;
mod coarse;
mod detector;
mod gap;
mod geometry;
mod height_field;
mod image;
mod layer;
mod level;
mod measure_corner;
mod measure_gap;
mod noise;
mod observer;
mod optics;
mod precision;
mod prior;
mod profile;
#[cfg(feature = "render")]
pub mod render;
mod report;

pub use detector::{Detector, DetectorError};
pub use gap::{EDGE_ROWS_MM, EndKind, GapEnd};
pub use geometry::{Corner, CornerFeatures, GeometryError, PlateFeatures, PlateSeam};
pub use image::{Image, ImageError};
pub use noise::PhotonTransfer;
pub use observer::{Doubt, MeanPoint, Moved, Observation, Observer, ObserverConfig, Seam, State};
pub use optics::{MOST_PIXELS, Optics, OpticsError};
pub use precision::{Precision, Readings};
pub use prior::{Joint, Prior, Track, Walls};
pub use profile::Profile;
pub use report::{Criterion, Form, Measured, Report, Second, Sigma, Status};
