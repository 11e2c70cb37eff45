//! Where the cameras see their seams while the machine is operated by hand.

use super::Station;

/// A seam as a picture shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighted {
    /// Number of the capture.
    pub capture: u32,
    /// Where the seam is, in machine coordinates \[mm\].
    pub position: [f64; 3],
}

impl Station {
    /// The seam in the newest picture of camera `side`, by where pose and slides are now: right where both have been at rest
    /// since before that picture. `None` where none is measured.
    pub fn sighted(&self, side: usize) -> Option<Sighted> {
        let machine = self.by_hand()?;
        let heads = machine.is.tracking.as_ref()?.board.heads().ok()?;
        let (motion, tracker) = self.live.motion.as_ref().zip(self.live.tracker.as_ref())?;
        let picture = self.live.pictures.get(side)?.as_ref()?;
        let measurement = picture.measurement.as_ref()?;
        let pose = machine.planner.pose(&machine.planner.tip(&motion.axes));
        let [u, v] = [2 * side, 2 * side + 1].map(|slide| tracker.slides_mm[slide]);
        let spot = heads.spot(&pose, side);
        Some(Sighted {
            capture: picture.capture,
            position: heads.seam_point(&spot, u, v, measurement).into(),
        })
    }
}
