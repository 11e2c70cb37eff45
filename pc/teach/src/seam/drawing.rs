//! Data of machine and drawing for teaching.

use super::Cameras;
use config::machine::TrackingUnit;
use nalgebra::Vector3;
use shared::config::SlideConfig;
use shared::parameter::ParameterError;

/// What is drawn of the seam: the planes in which it begins and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawing {
    /// Where the seams begin, and the direction of travel.
    pub begin: (Vector3<f64>, Vector3<f64>),
    /// The same where they end.
    pub end: (Vector3<f64>, Vector3<f64>),
    /// Length of the weld \[mm\].
    pub length_mm: f64,
}

impl Cameras {
    /// Those of a machine.
    ///
    /// # Errors
    /// Names the parameter of the heads that makes no sense.
    pub fn of(unit: &TrackingUnit) -> Result<Self, ParameterError> {
        Ok(Self {
            heads: unit.board.heads()?,
            mount: unit.cameras.mount_deg.map(f64::to_radians),
            travel_mm: std::array::from_fn(|i| {
                let of = |slide: &SlideConfig| (slide.travel_min_mm, slide.travel_max_mm);
                unit.board.slides.get(i).map_or((0.0, 0.0), of)
            }),
        })
    }
}
