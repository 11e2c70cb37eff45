//! What machine and drawing say of a lesson.

use super::{Cameras, Stance};
use crate::plan::DualBeamPlan;
use config::machine::TrackingUnit;
use nalgebra::Vector3;
use shared::geometry::Pose;
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

impl Drawing {
    /// Of a weld planned from it.
    pub fn of(plan: &DualBeamPlan) -> Self {
        let weld = &plan.points[plan.seam.0..=plan.seam.1];
        let place = |i: usize| (weld[i].pose.position, weld[i].pose.tangent);
        let chords = weld
            .windows(2)
            .map(|pair| (pair[1].pose.position - pair[0].pose.position).norm());
        Self {
            begin: place(0),
            end: place(weld.len() - 1),
            length_mm: chords.sum(),
        }
    }
}

impl Stance {
    /// The stance in which the cameras look at the beginning of a planned weld.
    pub fn before(plan: &DualBeamPlan, cameras: &Cameras) -> Self {
        let first = plan.points[plan.seam.0];
        let pose = first.pose;
        Self {
            pose: Pose {
                position: pose.position - pose.tangent * cameras.heads.camera_lead(),
                ..pose
            },
            slides_mm: [0.0, first.extension[0], 0.0, first.extension[1]],
        }
    }
}

impl Cameras {
    /// Those of a machine.
    ///
    /// # Errors
    /// Names the parameter of the heads that makes no sense.
    pub fn of(unit: &TrackingUnit) -> Result<Self, ParameterError> {
        Ok(Self {
            heads: unit.board.head.build()?,
            mount: unit.cameras.mount_deg.map(f64::to_radians),
            travel_mm: std::array::from_fn(|i| {
                let slide = &unit.board.slides[i];
                (slide.travel_min_mm, slide.travel_max_mm)
            }),
        })
    }
}
