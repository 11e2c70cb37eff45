//! Whether this program was there all the time.

use crate::boards::Absence;
use std::time::{Duration, SystemTime};

/// Shorter ones are nobody's concern.
const SHORTEST: Duration = Duration::from_millis(100);

/// A longer one counts for so long.
const RECENT: Duration = Duration::from_secs(1);

/// Finds the times in which this program did nothing: it was stopped, its computer slept, or had no processor for it.
#[derive(Debug)]
pub(super) struct Attention {
    /// When the boards were thought of last, by the session's clock and by that of the wall, which goes on while a computer
    /// sleeps.
    last: Duration,
    last_wall: SystemTime,
    absence: Option<Absence>,
}

impl Attention {
    pub(super) fn new() -> Self {
        Self {
            last: Duration::ZERO,
            last_wall: SystemTime::now(),
            absence: None,
        }
    }

    /// The boards are thought of `now`, by the session's clock, after a wait that was to take `waited` at most.
    pub(super) fn paid(&mut self, now: Duration, waited: Duration) {
        self.paid_at(now, SystemTime::now(), waited);
    }

    fn paid_at(&mut self, now: Duration, wall: SystemTime, waited: Duration) {
        // A clock on the wall that is set back tells nothing.
        let by_wall = wall.duration_since(self.last_wall).unwrap_or_default();
        let lasted = (now - self.last).max(by_wall).saturating_sub(waited);
        (self.last, self.last_wall) = (now, wall);
        // What was missed shows a moment after a long one, and short ones in between do not matter.
        let counts = |before: Absence| lasted >= before.lasted || now > before.ended + RECENT;
        if lasted >= SHORTEST && self.absence.is_none_or(counts) {
            self.absence = Some(Absence { ended: now, lasted });
        }
    }

    /// The last time in which it did nothing.
    pub(super) fn absence(&self) -> Option<Absence> {
        self.absence
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
        let mut attention = Attention::new();
        let wall = attention.last_wall;
        let mut paid = |now: u64, wall_now: u64, waited: u64| {
            attention.paid_at(ms(now), wall + ms(wall_now), ms(waited));
            attention.absence().map(|absence| (absence.ended, absence.lasted))
        };
        // A wait that was meant, and a little more.
        assert_eq!(paid(3000, 3000, 3000), None);
        assert_eq!(paid(3060, 3060, 10), None);
        // Stopped for 3 s.
        let stopped = Some((ms(6070), ms(3000)));
        assert_eq!(paid(6070, 6070, 10), stopped);
        // A short one right after it.
        assert_eq!(paid(6270, 6270, 0), stopped);
        assert_eq!(paid(7000, 7000, 800), stopped);
        // The wall's clock is set back: nothing new.
        assert_eq!(paid(7010, 1000, 10), stopped);
        assert_eq!(paid(7270, 1260, 100), Some((ms(7270), ms(160))));
        // Asleep for an hour, in which the session's clock stood.
        assert_eq!(paid(7280, 3_601_270, 10), Some((ms(7280), ms(3_600_000))));
    }
}
