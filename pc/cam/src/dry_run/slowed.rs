//! Where the machine does not keep the feed on the way, and what does not let it.

use serde::Serialize;

/// Part of the feed that the speed must be below it, and must rise again, to count: less is what filter and rounding do.
/// Twice as much hides what the process feels, half of it finds places at which nothing happens.
const DIP: f64 = 0.01;
/// Most places that are kept: what a person reads.
const MOST: usize = 20;

/// A stretch of a path on which the machine is slower than the feed. Going from rest and coming to rest do not count.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SlowedDown {
    /// Number of the path, from 1.
    pub path: usize,
    /// First and last line of the program.
    pub lines: (u32, u32),
    /// From where to where on the path \[mm\].
    pub from_mm: f64,
    /// From where to where on the path \[mm\].
    pub to_mm: f64,
    /// Feed at the lowest speed, with the override \[mm/s\].
    pub feed_mm_s: f64,
    /// The lowest speed \[mm/s\].
    pub lowest_mm_s: f64,
    /// Where that is \[mm\].
    pub lowest_at_mm: f64,
    /// Line of the program there.
    pub line: u32,
    /// What does not allow more there.
    pub limit: String,
}

impl SlowedDown {
    /// Part of the feed that is kept.
    pub(super) fn kept(&self) -> f64 {
        self.lowest_mm_s / self.feed_mm_s
    }
}

/// All of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Slowed {
    /// How many there are.
    pub count: u64,
    /// How long they are together \[mm\].
    pub length_mm: f64,
    /// Those of them that keep the smallest part of the feed, in the order of the program.
    pub slowest: Vec<SlowedDown>,
}

impl Slowed {
    fn take_stretch(&mut self, path: usize, below: &Below) {
        let Some((found, limit)) = &below.found else {
            return;
        };
        self.take(SlowedDown {
            path,
            lines: (below.from.1, below.high_at.1),
            from_mm: below.from.0,
            to_mm: below.high_at.0,
            feed_mm_s: found.feed,
            lowest_mm_s: found.v.max(0.0),
            lowest_at_mm: found.s,
            line: found.line,
            limit: limit.clone(),
        });
    }

    fn take(&mut self, found: SlowedDown) {
        self.count += 1;
        self.length_mm += found.to_mm - found.from_mm;
        self.slowest.push(found);
        if self.slowest.len() > MOST {
            let kept = |at: &usize| self.slowest[*at].kept();
            let most = (0..self.slowest.len()).max_by(|a, b| kept(a).total_cmp(&kept(b)));
            most.map(|most| self.slowest.remove(most));
        }
    }
}

/// A tick on a path that feeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tick {
    /// Path length \[mm\].
    pub s: f64,
    /// Speed along the path \[mm/s\].
    pub v: f64,
    /// Feed there, with the override \[mm/s\].
    pub feed: f64,
    /// Line of the program.
    pub line: u32,
}

impl Tick {
    /// Part of the feed that is kept.
    fn kept(&self) -> f64 {
        self.v / self.feed
    }
}

/// Looks for them from tick to tick of a path.
#[derive(Debug, Default)]
pub(super) struct Watch {
    below: Option<Below>,
}

/// A stretch below the feed, as far as it is known.
#[derive(Debug)]
struct Below {
    from: (f64, u32),
    /// Highest speed since the stretch began, or since the last low one, and where that was.
    high: f64,
    high_at: (f64, u32),
    /// It comes down from there: it does not only leave rest, or a lower feed.
    falls: bool,
    /// The lowest speed since it falls.
    low: Tick,
    /// The lowest one from which it rose again, and what does not allow more there.
    found: Option<(Tick, String)>,
}

impl Watch {
    /// The next tick of path number `path`, at which the machine `rests` as it should or not; `why` says what does not let it be faster
    /// at a place just passed.
    pub fn tick(
        &mut self,
        path: usize,
        tick: &Tick,
        rests: bool,
        slowed: &mut Slowed,
        why: impl FnOnce(&Tick) -> String,
    ) {
        if rests || tick.v >= (1.0 - DIP) * tick.feed {
            if let Some(mut below) = self.below.take() {
                if !rests {
                    // Else the way to rest does not count.
                    below.high_at = (tick.s, tick.line);
                }
                slowed.take_stretch(path, &below);
            }
            return;
        }
        let below = self.below.get_or_insert(Below {
            from: (tick.s, tick.line),
            high: tick.v,
            high_at: (tick.s, tick.line),
            falls: false,
            low: *tick,
            found: None,
        });
        let step = DIP * tick.feed;
        if !below.falls {
            if tick.v > below.high {
                (below.high, below.high_at) = (tick.v, (tick.s, tick.line));
                if below.found.is_none() {
                    below.from = (tick.s, tick.line);
                }
            } else if tick.v < below.high - step {
                (below.falls, below.low) = (true, *tick);
            }
            return;
        }
        if tick.v < below.low.v {
            below.low = *tick;
        }
        if tick.v > below.low.v + step {
            let low = below.low;
            if below
                .found
                .as_ref()
                .is_none_or(|(found, _)| low.kept() < found.kept())
            {
                below.found = Some((low, why(&low)));
            }
            (below.falls, below.high, below.high_at) = (false, tick.v, (tick.s, tick.line));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks over a path of 10 mm at a feed of 10 mm/s, 1 mm apart, at these speeds; it should rest at its ends only.
    fn watched(speeds: [f64; 11]) -> Slowed {
        let (mut watch, mut slowed) = (Watch::default(), Slowed::default());
        for (i, v) in (0..).zip(speeds) {
            let tick = Tick {
                s: f64::from(i),
                v,
                feed: 10.0,
                line: 3,
            };
            watch.tick(2, &tick, i == 0 || i == 10, &mut slowed, |low| {
                format!("{}", low.s)
            });
        }
        slowed
    }

    #[test]
    fn a_rest_that_nobody_asked_for_is_told() {
        let slowed = watched([0.0, 5.0, 10.0, 4.0, 0.0, 4.0, 10.0, 10.0, 10.0, 5.0, 0.0]);
        assert_eq!(slowed.count, 1);
        let place = &slowed.slowest[0];
        assert_eq!((place.from_mm, place.lowest_at_mm, place.to_mm), (3.0, 4.0, 6.0));
        assert_eq!((place.lowest_mm_s, &place.limit[..]), (0.0, "4"));
    }

    #[test]
    fn of_a_stretch_the_slowest_place_counts_and_not_the_ways_from_rest_and_to_rest() {
        let slowed = watched([0.0, 5.0, 9.0, 6.0, 8.0, 4.0, 7.0, 6.0, 9.0, 5.0, 0.0]);
        assert_eq!(slowed.count, 1);
        let place = &slowed.slowest[0];
        assert_eq!((place.from_mm, place.lowest_at_mm, place.to_mm), (2.0, 5.0, 8.0));
        assert_eq!(
            watched([0.0, 3.0, 6.0, 9.0, 9.0, 9.0, 9.0, 6.0, 4.0, 2.0, 0.0]),
            Slowed::default()
        );
    }
}
