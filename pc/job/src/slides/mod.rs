//! Moves of the slides by the PC while the machine is at rest.

use crate::JobError;
use crate::session::Session;
use shared::io::{SLIDE_NAMES, SLIDES};
use shared::protocol::{Request, Role};
use std::time::Duration;

/// Nearer to their targets than this and their dead band, slides are there \[mm\].
const THERE_MM: f64 = 0.005;
/// Longest time for the longest way.
const LIMIT: Duration = Duration::from_secs(10);

impl Session<'_> {
    /// Moves the slides to `target_mm` (U1, V1, U2, V2) and waits until they are there, to 0.005 mm and the dead band of
    /// their law; the tracker board is ready, and tracks no path.
    ///
    /// # Errors
    /// [`JobError::SlideAway`]; [`JobError::Link`] of a target beyond the travel, which names the slide.
    pub fn move_slides(&mut self, target_mm: [f64; SLIDES]) -> Result<(), JobError> {
        self.command(
            Role::Tracker,
            &Request::MoveSlides {
                target_mm,
                hold_to_run: None,
            },
        )?;
        let moved = self.wait_until("a move of the slides", LIMIT, |session| {
            session.refresh()?;
            Ok(session.away(&target_mm).is_none())
        });
        match (moved, self.away(&target_mm)) {
            (Err(JobError::TooLong { .. }), Some((slide, away_mm))) => {
                let slide = SLIDE_NAMES[slide];
                Err(JobError::SlideAway { slide, away_mm })
            }
            (moved, _) => moved,
        }
    }

    /// Where the slides are \[mm\].
    pub fn slides_mm(&self) -> [f64; SLIDES] {
        let tracking = self.tracking.as_ref();
        tracking.map_or([0.0; SLIDES], |tracking| tracking.status.slides_mm)
    }

    /// The first slide that is not at its target, and how far it is off \[mm\].
    pub(crate) fn away(&self, target_mm: &[f64; SLIDES]) -> Option<(usize, f64)> {
        let at = self.slides_mm();
        let tracking = self.tracking.as_ref()?;
        let away = |slide: usize| (slide, (at[slide] - target_mm[slide]).abs());
        (0..2 * tracking.heads.sides().len())
            .map(away)
            .find(|(_, away_mm)| *away_mm > tracking.dead_band_mm + THERE_MM)
    }
}

#[cfg(test)]
mod tests;
