//! What machine and drawing say of a lesson.

use super::{Cameras, Stance};
use crate::machine::TrackingUnit;
use crate::plan::DualBeamPlan;
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
            extension_mm: first.extension,
        }
    }
}

impl Cameras {
    /// Those of a machine.
    ///
    /// # Errors
    /// Names the parameter of the heads that makes no sense.
    pub fn of(unit: &TrackingUnit) -> Result<Self, ParameterError> {
        let reach = unit
            .board
            .slides
            .iter()
            .map(|slide| slide.travel_max_mm.min(-slide.travel_min_mm));
        Ok(Self {
            heads: unit.board.head.build()?,
            mount: unit.cameras.mount_deg.map(f64::to_radians),
            reach_mm: reach.fold(f64::INFINITY, f64::min),
        })
    }
}
