//! Detects stalls of this program, so that they are not taken for faults of the boards.

use crate::boards::Stall;
use std::time::{Duration, SystemTime};

/// Shorter stalls do not count.
const SHORTEST: Duration = Duration::from_millis(100);

/// A stall is remembered for so long, and as long as it was.
const RECENT: Duration = Duration::from_secs(1);

/// Finds the times in which this program did not run: it was stopped, its computer slept, or had no processor
/// for it.
#[derive(Debug)]
pub(super) struct StallDetector {
    /// Time of the last check, by the session's clock and by the wall clock, which also runs while a computer
    /// sleeps.
    last: Duration,
    last_wall: SystemTime,
    last_stall: Option<Stall>,
}

impl StallDetector {
    pub(super) fn new() -> Self {
        Self {
            last: Duration::ZERO,
            last_wall: SystemTime::now(),
            last_stall: None,
        }
    }

    /// To be called whenever the session has waited: `now` by the session's clock, `waited` is the longest
    /// that the wait should have taken.
    pub(super) fn check(&mut self, now: Duration, waited: Duration) {
        self.check_at(now, SystemTime::now(), waited);
    }

    fn check_at(&mut self, now: Duration, wall: SystemTime, waited: Duration) {
        // A wall clock that was set back says nothing.
        let by_wall = wall.duration_since(self.last_wall).unwrap_or_default();
        let lasted = (now - self.last).max(by_wall).saturating_sub(waited);
        (self.last, self.last_wall) = (now, wall);
        // What was missed shows a moment after a long one, and short ones in between do not matter.
        let counts = |before: Stall| lasted >= before.lasted || now > before.ended + RECENT + before.lasted;
        if lasted >= SHORTEST && self.last_stall.is_none_or(counts) {
            self.last_stall = Some(Stall { ended: now, lasted });
        }
    }

    /// The last stall.
    pub(super) fn last_stall(&self) -> Option<Stall> {
        self.last_stall
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn ms(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    #[test]
    fn what_took_longer_than_it_was_to_is_an_absence() {
        let mut stall_detector = StallDetector::new();
        let wall = stall_detector.last_wall;
        let mut check = |now: u64, wall_now: u64, waited: u64| {
            stall_detector.check_at(ms(now), wall + ms(wall_now), ms(waited));
            stall_detector
                .last_stall()
                .map(|last_stall| (last_stall.ended, last_stall.lasted))
        };
        // A wait that was meant, and a little more.
        assert_eq!(check(3000, 3000, 3000), None);
        assert_eq!(check(3060, 3060, 10), None);
        // Stopped for 3 s.
        let stopped = Some((ms(6070), ms(3000)));
        assert_eq!(check(6070, 6070, 10), stopped);
        // A short one right after it.
        assert_eq!(check(6270, 6270, 0), stopped);
        assert_eq!(check(7000, 7000, 800), stopped);
        // The wall's clock is set back: nothing new.
        assert_eq!(check(7010, 1000, 10), stopped);
        // A second and as long as it was after its end, a short one counts.
        assert_eq!(check(10_300, 4290, 3130), Some((ms(10_300), ms(160))));
        // Asleep for an hour, in which the session's clock stood.
        assert_eq!(check(10_310, 3_604_300, 10), Some((ms(10_310), ms(3_600_000))));
    }
}
