//! Whether the beams may burn.

use super::TrackerController;
use crate::protocol::{BeamPermit, Permit};
use crate::state::TrackerState;

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// The permit of this tick; `None` until something was received from the motion board. No beam burns on a
    /// tracked path unless the slides follow the seam and nothing is wrong; none goes on unless its slides
    /// are on the seam, and none without slides.
    pub(super) fn permit(&self) -> Option<Permit> {
        let (tick, path_id) = self.history.newest_tick()?;
        let follows = self.state == TrackerState::Tracking && self.faults.is_empty();
        let fitted = self.parameters.as_ref().map_or(0..0, |of| of.heads.sides());
        let sides = core::array::from_fn(|side: usize| {
            if !fitted.contains(&side) {
                return BeamPermit::No;
            }
            let slides = &self.slides[2 * side..2 * side + 2];
            match (follows, slides.iter().all(|slide| slide.on_seam)) {
                (false, _) => BeamPermit::No,
                (true, false) => BeamPermit::Keep,
                (true, true) => BeamPermit::Open,
            }
        });
        Some(Permit { tick, path_id, sides })
    }
}
