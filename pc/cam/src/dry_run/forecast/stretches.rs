//! The stretches of a path that have to be run: all but the insides of long ones on which the feed is kept for certain.
//!
//! A stretch begins at rest before a place that is not calm, and ends at rest behind one, where the path itself goes on at
//! its feed. It counts from where the feed is reached to where it is left.

use super::calm::Calm;
use super::part::{has_parts, part};
use crate::path::{Leg, PathError};
use shared::io::AXES;
use shared::trajectory::{Element, Join};
use std::collections::VecDeque;

/// A stretch has so many ways from rest to the feed before a place that is not calm, and as many behind it: one to reach the feed,
/// and one to leave it.
const BESIDE: f64 = 2.0;
/// Ways that are calm behind the end of a stretch where it is worth to leave out what comes before the next one.
const MORE: f64 = 4.0;

pub(super) type Legs<'a> = Box<dyn Iterator<Item = Result<Leg, PathError>> + 'a>;

/// Gives the legs of one stretch after the other.
pub(super) struct Stretches<'a> {
    legs: Legs<'a>,
    calm: Option<Calm<'a>>,
    /// What begins in this time at the feed is run in any case \[s\].
    whole_s: f64,
    /// Read, and not given yet.
    ahead: VecDeque<Seen>,
    /// Where the next one read begins \[mm\], and the time to there at the feed \[s\].
    end_s: f64,
    end_time: f64,
    /// From here on all that was given is calm \[mm\].
    calm_since: f64,
    end: Option<End>,
}

/// Where a stretch ends before the path does.
struct End {
    s: f64,
    time: f64,
    way: f64,
    feed: f64,
}

/// Where a stretch begins.
pub(super) struct Start {
    /// Path length \[mm\].
    pub s: f64,
    /// mm, rad.
    pub axes: [f64; AXES],
    /// It counts from here on \[mm\].
    pub counts_from: f64,
    /// Time from where the stretch before stopped to count \[s\].
    pub left_out_s: f64,
}

/// A leg that was looked at.
struct Seen {
    leg: Leg,
    s: f64,
    time: f64,
    /// Where it begins.
    axes: [f64; AXES],
    /// Nothing is felt where it begins, and the feed is kept on it.
    joins: bool,
    kept: bool,
}

impl Seen {
    fn element(&self) -> &Element {
        &self.leg.element
    }

    fn end(&self) -> f64 {
        self.s + self.element().length
    }

    /// It is known to be calm from there on, as far as it is itself \[mm\].
    fn calm_from(&self) -> Option<f64> {
        match (self.joins, self.kept) {
            (_, false) => Some(self.end()),
            (false, true) => Some(self.s),
            (true, true) => None,
        }
    }

    fn stops(&self) -> bool {
        self.element().join == Join::Stop
    }
}

impl<'a> Stretches<'a> {
    /// Of `legs` from `s` \[mm\] on; one stretch is all of them if it is not asked what is calm. What begins in the first
    /// `whole_s` \[s\] is run in any case.
    pub fn new(legs: Legs<'a>, calm: Option<Calm<'a>>, s: f64, whole_s: f64) -> Self {
        Self {
            legs,
            calm,
            whole_s,
            ahead: VecDeque::new(),
            end_s: s,
            end_time: 0.0,
            calm_since: s,
            end: None,
        }
    }

    /// Where the present stretch stops to count \[mm\], if it is known to end before the path.
    pub fn counts_to(&self) -> Option<f64> {
        self.end.as_ref().map(|end| end.s - end.way)
    }

    /// Goes on to the next stretch, if the present one does not end with the path.
    pub fn go_on(&mut self) -> Result<Option<Start>, PathError> {
        let (Some(before), Some(way)) = (self.end.take(), self.way()) else {
            return Ok(None);
        };
        let mut looked_at = 0;
        let event = loop {
            if looked_at == self.ahead.len() && !self.read()? {
                break self.end_s;
            }
            let seen = &self.ahead[looked_at];
            if !(seen.joins && seen.kept) {
                break seen.s;
            }
            if seen.stops() {
                break seen.end();
            }
            looked_at += 1;
            let needed = seen.end() - BESIDE * way(seen.element().feed);
            looked_at -= self.drop_before(needed);
        };
        let Some(front) = self.ahead.front() else {
            return Ok(None);
        };
        let (feed, start) = (front.element().feed, event - BESIDE * way(front.element().feed));
        self.drop_before(start);
        if self
            .ahead
            .front()
            .is_some_and(|front| start - front.s > way(feed))
        {
            self.cut_front(start);
        }
        let Some(front) = self.ahead.front() else {
            return Ok(None);
        };
        self.calm_since = front.s;
        let counts_from = front.s + way(feed);
        let time = front.time + way(feed) / feed;
        Ok(Some(Start {
            s: front.s,
            axes: front.axes,
            counts_from,
            left_out_s: time - (before.time - before.way / before.feed),
        }))
    }

    /// Way from rest to a feed \[mm\].
    fn way(&self) -> Option<impl Fn(f64) -> f64 + use<>> {
        let ramp = self.calm.as_ref()?.ramp();
        Some(move |feed: f64| ramp.way(feed))
    }

    /// Forgets what ends before `s`; how many legs.
    fn drop_before(&mut self, s: f64) -> usize {
        let many = self.ahead.iter().take_while(|seen| seen.end() <= s).count();
        self.ahead.drain(..many);
        many
    }

    /// Forgets what of the first leg is before `s`.
    fn cut_front(&mut self, s: f64) {
        let (Some(front), Some(calm)) = (self.ahead.front_mut(), &self.calm) else {
            return;
        };
        let (from, length) = (s - front.s, front.element().length);
        if from <= 0.0 {
            return;
        }
        let rest = part(front.element(), from, length, front.element().join);
        let axes = calm.follow(front.element(), from, &front.axes);
        if let (Some(rest), Some(axes)) = (rest, axes) {
            front.s += from;
            front.time += from / rest.feed;
            (front.leg.element, front.axes, front.joins) = (rest, axes, true);
        }
    }

    /// Reads another leg, if there is one.
    fn read(&mut self) -> Result<bool, PathError> {
        let Some(leg) = self.legs.next().transpose()? else {
            return Ok(false);
        };
        let (s, time) = (self.end_s, self.end_time);
        self.end_s += leg.element.length;
        self.end_time += leg.element.length / leg.element.feed;
        let (axes, (joins, kept)) = match &mut self.calm {
            Some(calm) => (calm.axes(), calm.look(&leg.element)),
            None => ([0.0; AXES], (false, false)),
        };
        self.ahead.push_back(Seen {
            leg,
            s,
            time,
            axes,
            joins,
            kept,
        });
        Ok(true)
    }

    /// Whether all is calm from `calm_since` to `s`; that is moved behind the first place that is not.
    fn calm_to(&mut self, s: f64) -> Result<bool, PathError> {
        let mut looked_at = 0;
        loop {
            if looked_at == self.ahead.len() && !self.read()? {
                self.calm_since = f64::INFINITY;
                return Ok(false);
            }
            let seen = &self.ahead[looked_at];
            if let Some(from) = seen.calm_from()
                && from > self.calm_since
            {
                self.calm_since = from;
                return Ok(false);
            }
            if seen.end() >= s {
                return Ok(true);
            }
            if seen.stops() {
                self.calm_since = seen.end();
                return Ok(false);
            }
            looked_at += 1;
        }
    }

    /// The next leg of the stretch.
    fn give(&mut self) -> Result<Option<Leg>, PathError> {
        if self.end.is_some() || self.ahead.is_empty() && !self.read()? {
            return Ok(None);
        }
        if let (Some(front), Some(way)) = (self.ahead.front(), self.way()) {
            self.calm_since = front.calm_from().unwrap_or(0.0).max(self.calm_since);
            let feed = front.element().feed;
            let (way, end) = (way(feed), front.end());
            let whole = front.s + (self.whole_s - front.time) * feed;
            let last = whole.max(self.calm_since + BESIDE * way);
            if end >= last && self.calm_to(last + MORE * way)? {
                return Ok(self.end_at(last, way));
            }
        }
        Ok(self.ahead.pop_front().map(|seen| seen.leg))
    }

    /// Gives the last leg of the stretch, which ends at `s` or behind it.
    fn end_at(&mut self, s: f64, way: f64) -> Option<Leg> {
        let front = self.ahead.front_mut()?;
        let (element, feed) = (&front.leg.element, front.leg.element.feed);
        let to = (s - front.s).max(0.5 * way);
        let head = has_parts(element, BESIDE * way)
            .then(|| part(element, 0.0, to, Join::Stop))
            .flatten();
        let (leg, length) = match head {
            Some(head) if to + way < element.length => {
                // The stretch after this one begins inside, too, or behind it.
                front.joins = true;
                let events = std::mem::take(&mut front.leg.events);
                (
                    Leg {
                        events,
                        element: head,
                    },
                    to,
                )
            }
            _ => {
                let mut leg = front.leg.clone();
                leg.element.join = Join::Stop;
                let length = leg.element.length;
                (leg, length)
            }
        };
        self.end = Some(End {
            s: front.s + length,
            time: front.time + length / feed,
            way,
            feed,
        });
        self.drop_before(self.end.as_ref()?.s);
        Some(leg)
    }
}

impl Iterator for Stretches<'_> {
    type Item = Result<Leg, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.give().transpose()
    }
}
