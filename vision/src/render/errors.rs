//! How far what was measured lies off the truth of a scene.

use super::scene::{Joint, Scene};
use crate::observer::{MeanPoint, Observation};
use crate::optics::Optics;

/// Errors of a seam that an observer accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Of the lateral position in this picture \[mm\].
    pub lateral_mm: f64,
    /// Of the height in this picture \[mm\].
    pub height_mm: f64,
    /// Of the width in this picture \[mm\].
    pub width_mm: f64,
    /// Of the roll slope in this picture; 0 of a corner.
    pub roll: f64,
    /// Of the mean point, across the seam and in height \[mm\].
    pub mean_mm: Option<[f64; 2]>,
}

impl Scene {
    /// Errors of what an observer made of this scene's picture. None if it accepts nothing, or if there is no
    /// surface to be seen. A mean point is held against the seam as it is in this scene: straight.
    pub fn errors(&self, seen: &Observation, optics: &Optics) -> Option<Errors> {
        let truth = self.truth(optics)?;
        let (seam, measured) = (seen.seam?, seen.report.measured?);
        let row_mm = (truth.seam[0] - optics.centre()[0]) * optics.object_pixel_mm();
        Some(Errors {
            lateral_mm: seam.lateral_mm - truth.centre_mm,
            height_mm: measured.height_mm - row_mm * optics.tilt_rad.sin(),
            width_mm: measured.width_mm - truth.width_mm,
            roll: match self.joint {
                Joint::Gap(_) => measured.roll - truth.roll,
                Joint::Corner(_) => 0.0,
            },
            mean_mm: seam.mean.map(|mean| self.off_the_seam(&mean)),
        })
    }

    /// How far a point lies beside and above the seam \[mm\].
    fn off_the_seam(&self, point: &MeanPoint) -> [f64; 2] {
        let [lateral, height] = match &self.joint {
            Joint::Gap(gap) => {
                let plate = &gap.plate;
                let lateral = plate.lateral_mm + plate.yaw_rad.tan() * point.travel_mm;
                let height = plate.height_mm + plate.pitch * point.travel_mm + plate.roll * lateral;
                [lateral, height]
            }
            Joint::Corner(root) => [root.corner.lateral_mm, root.corner.height_mm],
        };
        [point.lateral_mm - lateral, point.height_mm - height]
    }
}
