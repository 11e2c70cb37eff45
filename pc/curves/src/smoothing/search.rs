//! Where the next knot of the smooth path is, and over how much the lines are averaged there.

use super::knot::{Knot, follows};
use super::lines::{Run, used};
use shared::trajectory::Tolerance;

/// Lines that a span, and an average on either side, are long at most. With half as many programs take 0.1 % longer, with
/// twice as many nothing is gained for double the memory.
const REACH: usize = 128;
/// Lines that are looked at from a knot on: a span, the one after it, and half an average.
pub(super) const AHEAD: usize = 3 * REACH + 2;
/// Length of a span in halves of the average at its end. With half of it there are 45 % more elements, and programs take
/// 1.5 % longer; with double, 1 %, and noise comes through, which costs single programs much more.
const SPAN: f64 = 1.4;
/// Most growth of half an average for each mm. With half or double of it programs take as long to 0.1 %.
const GROWTH: f64 = 0.6;
/// A span is tried first with so many times the length of the one before: with 1.2 programs take 0.3 % longer, with 2.5 as
/// long, for more tries;
const FIRST: f64 = 1.5;
/// and then with so much less. With 0.7 they take 0.5 % longer, with 0.9 the search does.
const NEXT: f64 = 0.85;
/// Lengths that are tried: down to a thousandth of the first.
const TRIES: u32 = 42;
/// Share of the tolerance that a knot may be off: less than all, so that a way back to the lines is always left. With 0.8 or
/// 0.97 programs take as long to 0.2 %.
const OFF: f64 = 0.9;
/// The span after this one is to be at least this part as long. With 0.2 ways lead nowhere more often, and programs take 2 %
/// longer; with 0.9 they take as long.
const GOES_ON: f64 = 0.6;
/// Where the feed is next to nothing, half of the longest average \[mm\]: far above [`SHORTEST`], and too short to matter.
const SLOW: f64 = 1e-4;
/// A way back to the lines is not tried shorter than this \[mm\].
const SHORTEST: f64 = 1e-6;

/// What the search goes by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search<'a> {
    pub run: &'a Run,
    /// Where the smooth path begins \[mm\].
    pub begin: f64,
    /// Where it ends, if that is known \[mm\].
    pub end: Option<f64>,
    pub allowed: &'a Tolerance,
    /// Half an average is at most what is gone in this time at the feed \[s\].
    pub time: f64,
}

impl Search<'_> {
    /// The knot after `knot`, which is after a span of `before` \[mm\], or the first one if that is 0.
    pub fn next(&self, knot: &Knot, before: f64) -> Knot {
        if let Some(next) = self.along_line(knot) {
            return next;
        }
        let goes_on = |next: &Knot| {
            let length = next.s - knot.s;
            self.is_end(next) || {
                let after = self.longest(next, length, |_| true);
                after.is_some_and(|after| self.is_end(&after) || after.s - next.s >= GOES_ON * length)
            }
        };
        self.longest(knot, before, goes_on)
            .unwrap_or_else(|| self.back(knot))
    }

    /// Where the knot lies on a long line: a knot before the end of that.
    fn along_line(&self, knot: &Knot) -> Option<Knot> {
        let line = self.run.get(self.run.index(knot.s))?;
        let longest = SPAN * self.longest_half(knot.s);
        let end = self.end.map_or(line.end(), |end| line.end().min(end));
        let on_it = self.run.is_line(knot.s - knot.half, knot.s + knot.half);
        (on_it && end - knot.s > 3.0 * longest).then(|| self.run.on_line(end - 2.0 * longest))
    }

    /// The longest span from `knot` that is good.
    fn longest(&self, knot: &Knot, before: f64, good: impl Fn(&Knot) -> bool) -> Option<Knot> {
        let most = SPAN * self.longest_half(knot.s);
        let mut length = if before > 0.0 {
            most.min(FIRST * before)
        } else {
            most
        };
        let limit = self.limit(knot.s);
        for _ in 0..TRIES {
            let next = self.knot_at(self.place(knot.s, length, limit), knot);
            let off: [f64; _] = std::array::from_fn(|i| next.value[i] - self.run.on_line(next.s).value[i]);
            if used(&off, self.allowed) <= OFF && follows(self.run, knot, &next, self.allowed) && good(&next)
            {
                return Some(next);
            }
            length *= NEXT;
        }
        None
    }

    /// Back to the lines.
    fn back(&self, knot: &Knot) -> Knot {
        let limit = self.limit(knot.s);
        let mut length = SPAN * self.longest_half(knot.s);
        loop {
            let s = self.place(knot.s, length, limit);
            let next = match self.end {
                Some(end) if s >= end => self.run.on_last(end),
                _ => self.run.on_line(s),
            };
            if length <= SHORTEST || follows(self.run, knot, &next, self.allowed) {
                return next;
            }
            length *= 0.5;
        }
    }

    /// Where a span of about `length` from `s` ends, without a sliver before the `limit` \[mm\].
    fn place(&self, s: f64, length: f64, limit: f64) -> f64 {
        let rest = limit - s;
        if length >= 0.95 * rest {
            limit
        } else if length > 0.75 * rest {
            s + 0.5 * rest
        } else {
            s + length
        }
    }

    /// Up to where a span from `s` may lead \[mm\].
    fn limit(&self, s: f64) -> f64 {
        let far = self
            .run
            .get(self.run.index(s) + REACH)
            .map_or(f64::INFINITY, |line| line.start);
        far.min(self.end.unwrap_or(f64::INFINITY)).min(self.run.end())
    }

    /// The knot at `s` after `before`.
    fn knot_at(&self, s: f64, before: &Knot) -> Knot {
        if let Some(end) = self.end.filter(|end| s >= *end) {
            return self.run.on_last(end);
        }
        let (run, length) = (self.run, s - before.s);
        let index = run.index(s);
        let ahead = run.get(index + REACH).map_or(run.end(), |line| line.start);
        let behind = index.checked_sub(REACH).and_then(|index| run.get(index));
        let room = (s - behind.map_or(self.begin, |line| line.start.max(self.begin)))
            .min(ahead.min(self.end.unwrap_or(ahead)) - s);
        let wanted = (length / SPAN)
            .min(before.half + GROWTH * length)
            .min(self.longest_half(s));
        run.averaged(s, wanted.min(room))
    }

    /// Half of the longest average at `s` \[mm\].
    fn longest_half(&self, s: f64) -> f64 {
        let line = self.run.get(self.run.index(s));
        libm::fmax(self.time * line.map_or(0.0, |line| line.element.feed), SLOW)
    }

    fn is_end(&self, knot: &Knot) -> bool {
        self.end.is_some_and(|end| knot.s >= end)
    }
}
