//! Feed of the motion to each target.

use super::PathError;
use nc::{FeedRate, ProgramPath, SourcePosition, Target};

/// Longest time that a block may take \[s\]: a day, as a dwell. A feed with which one takes longer is a slip.
const LONGEST_BLOCK_S: f64 = 86_400.0;

/// Feeds of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feeds {
    /// Takes the place of the programmed ones \[mm/s\].
    replaced: Option<f64>,
    /// Of the first block gone through, and where its path begins.
    first: Option<(FeedRate, SourcePosition)>,
}

impl Feeds {
    /// Those of `path`, or `replaced` \[mm/s\] in place of the only one.
    pub(super) fn of(path: &ProgramPath, replaced: Option<f64>) -> Result<Self, PathError> {
        let mut feeds = Self::replaced_by(replaced);
        for target in &path.targets {
            feeds.see(target)?;
        }
        Ok(feeds)
    }

    /// Those of a path that is not known yet, or `replaced` \[mm/s\].
    pub(super) fn replaced_by(replaced: Option<f64>) -> Self {
        let first = None;
        Self { replaced, first }
    }

    /// The speed of the next block, on a way of `length` \[mm\] to `target` \[mm/s\].
    pub(super) fn next(&mut self, target: &Target, length: f64) -> Result<f64, PathError> {
        self.see(target)?;
        self.speed(target, length)
    }

    /// One speed cannot take the place of several feeds.
    fn see(&mut self, target: &Target) -> Result<(), PathError> {
        let Some(feed) = target.feed else { return Ok(()) };
        let (first, place) = *self.first.get_or_insert((feed, target.place));
        if self.replaced.is_some() && feed != first {
            return Err(PathError::SeveralFeeds { place });
        }
        Ok(())
    }

    /// Speed on a way of `length` \[mm\] to `target` \[mm/s\], 0 for a rapid.
    pub(super) fn speed(&self, target: &Target, length: f64) -> Result<f64, PathError> {
        let Some(feed) = target.feed else {
            return Ok(0.0);
        };
        let programmed = match feed {
            FeedRate::PerMinute(mm_min) => mm_min / 60.0,
            FeedRate::InverseTime(per_minute) => length * per_minute / 60.0,
        };
        let speed = self.replaced.unwrap_or(programmed);
        let (place, mm_min) = (target.place, speed * 60.0);
        if !(speed.is_finite() && speed > 0.0) {
            return Err(PathError::NoFeed { place, mm_min });
        }
        if length > speed * LONGEST_BLOCK_S {
            return Err(PathError::TooSlow {
                place,
                mm_min,
                length,
            });
        }
        Ok(speed)
    }
}
