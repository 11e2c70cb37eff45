//! Slides that the PC moves, for good or by hold-to-run.

use super::TrackerController;
use crate::io::SLIDES;
use crate::protocol::{HOLD_TO_RUN_MS, Refusal};
use crate::state::TrackerState;
use crate::tracking::law::{SlideLaw, SlideTarget};

/// Where the PC wants the slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jog {
    target_mm: [f64; SLIDES],
    /// Highest speed \[mm/s\]; that of the slides if it is higher.
    speed_mm_s: f64,
    /// Control ticks until it ends if it is not asked for again, or [`FOR_GOOD`]. A type with spare values would have `None` be
    /// other than zeros, and with it the controller.
    left: u32,
}

/// A move that does not end by itself.
const FOR_GOOD: u32 = u32::MAX;

impl Jog {
    /// So many control ticks later.
    pub fn pass(&mut self, periods: u32) {
        if self.left != FOR_GOOD {
            self.left = self.left.saturating_sub(periods);
        }
    }

    /// The law with the speed of this move.
    pub fn slowed(&self, law: &SlideLaw) -> SlideLaw {
        SlideLaw {
            max_velocity: law.max_velocity.min(self.speed_mm_s),
            ..*law
        }
    }
}

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// Begins or renews a move to `target_mm`; by hold-to-run at a speed of `hold_to_run` \[mm/s\] at most.
    pub(super) fn move_slides(
        &mut self,
        target_mm: &[f64; SLIDES],
        hold_to_run: Option<f64>,
    ) -> Result<(), Refusal> {
        self.allow(&[TrackerState::Ready])?;
        let parameters = self.parameters.as_ref().ok_or(Refusal::NotConfigured)?;
        for (slide, (target, of)) in (0..).zip(target_mm.iter().zip(&parameters.slides)) {
            let (min, max) = of.law.travel;
            if !(min..=max).contains(target) {
                return Err(Refusal::BeyondTravel {
                    slide,
                    target_mm: *target as f32,
                    min_mm: min as f32,
                    max_mm: max as f32,
                });
            }
        }
        if hold_to_run.is_some_and(|speed| !(speed > 0.0 && speed.is_finite())) {
            return Err(Refusal::BadSpeed);
        }
        self.jog = Some(Jog {
            target_mm: *target_mm,
            speed_mm_s: hold_to_run.unwrap_or(f64::INFINITY),
            left: hold_to_run.map_or(FOR_GOOD, |_| HOLD_TO_RUN_MS),
        });
        Ok(())
    }

    /// Slides that the PC moves come to rest, and stay.
    pub(super) fn let_go(&mut self) {
        if let Some(jog) = &mut self.jog {
            jog.left = 0;
        }
    }

    /// Where the slides go if the PC moves them: down to rest, to stay there, once it holds them no longer.
    pub(super) fn jog_targets(&self) -> Option<[Option<SlideTarget>; SLIDES]> {
        let jog = self.jog?;
        let let_go = jog.left == 0;
        Some(core::array::from_fn(|i| {
            let slide = &self.slides[i];
            match let_go {
                false => Some(SlideTarget::rest(jog.target_mm[i])),
                true if slide.law.stands() => Some(SlideTarget::rest(slide.target)),
                true => None,
            }
        }))
    }
}
