//! What the boards told, after the end of a job.

use super::{between, towards};
use crate::boards::role_name;
use crate::spool::{Iter, Spool, SpoolError, Spooling};
use shared::io::SLIDES;
use shared::protocol::{MotionSample, Role, TrackerSample};
use thiserror::Error;

/// Samples came that are not in the record.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the record of what the {} board told is not complete: {source}", role_name(*.board))]
pub struct RecordError {
    /// Whose samples.
    pub board: Role,
    /// How many, and why.
    pub source: SpoolError,
}

/// All samples of a job.
#[derive(Debug)]
pub struct Recorded {
    motion: Spool<MotionSample>,
    tracker: Spool<TrackerSample>,
    missing: (u32, u32),
    spooling: Spooling,
}

impl Recorded {
    pub(super) fn new(
        (motion, motion_missing): (Spool<MotionSample>, u32),
        (tracker, tracker_missing): (Spool<TrackerSample>, u32),
        spooling: Spooling,
    ) -> Self {
        Self {
            motion,
            tracker,
            missing: (motion_missing, tracker_missing),
            spooling,
        }
    }

    /// Samples of the motion board, by tick.
    pub fn motion(&self) -> &Spool<MotionSample> {
        &self.motion
    }

    /// Samples of the tracker board, by tick.
    pub fn tracker(&self) -> &Spool<TrackerSample> {
        &self.tracker
    }

    /// Ticks between the first and the last sample that are missing, motion and tracker.
    pub fn missing(&self) -> (u32, u32) {
        self.missing
    }

    /// How it is kept, as what is computed of it should be.
    pub fn spooling(&self) -> &Spooling {
        &self.spooling
    }

    /// Whether all samples are there that came in time.
    ///
    /// # Errors
    /// What this PC could not keep of either board.
    pub fn check(&self) -> Result<(), RecordError> {
        let of = |board| move |source| RecordError { board, source };
        let motion = self.motion.check().map_err(of(Role::Motion));
        motion.and(self.tracker.check().map_err(of(Role::Tracker)))
    }

    /// The slides, to be asked for in order of time.
    pub fn slides(&self) -> SlidePositions<'_> {
        let mut samples = self.tracker.iter();
        SlidePositions {
            before: None,
            after: samples.next(),
            samples,
        }
    }
}

/// Where the slides stood, from time to time.
pub struct SlidePositions<'a> {
    before: Option<TrackerSample>,
    after: Option<TrackerSample>,
    samples: Iter<'a, TrackerSample>,
}

impl SlidePositions<'_> {
    /// At a time of the tracker clock, not before the one asked for last: the truth, or what the encoders said if there
    /// is none \[mm\]; `None` before and after the record, and in a gap.
    pub fn at(&mut self, time_us: u64) -> Option<[f64; SLIDES]> {
        while self.after.as_ref().is_some_and(|after| after.time_us <= time_us) {
            self.before = std::mem::replace(&mut self.after, self.samples.next());
        }
        let before = self.before.as_ref()?;
        let (after, ratio) = towards(before, self.after.as_ref(), time_us)?;
        let slides = |s: &TrackerSample| s.truth_mm.unwrap_or(s.slides_mm);
        Some(between(&slides(before), &slides(after), ratio))
    }
}
