//! How fast the way to each target is to be gone.

use super::PathError;
use crate::nc::{FeedRate, ProgramPath, Target};

/// Feeds of a path.
pub(super) struct Feeds {
    /// Takes the place of the programmed ones \[mm/s\].
    replaced: Option<f64>,
}

impl Feeds {
    /// Those of `path`, or `replaced` \[mm/s\] in place of the only one.
    pub(super) fn of(path: &ProgramPath, replaced: Option<f64>) -> Result<Self, PathError> {
        let mut feeds = path.targets.windows(2);
        if replaced.is_some() && feeds.any(|pair| pair[0].feed != pair[1].feed) {
            let place = path.targets[0].place;
            return Err(PathError::SeveralFeeds { place });
        }
        Ok(Self { replaced })
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
        if speed.is_finite() && speed > 0.0 {
            Ok(speed)
        } else {
            Err(PathError::NoFeed(speed * 60.0))
        }
    }
}
