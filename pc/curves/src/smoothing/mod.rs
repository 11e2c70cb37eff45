//! Runs of short lines as smooth curves inside their tolerance, as CAM programs need them: planners get fewer and longer
//! elements, and noise and corners that are no more than the chords of a curve do not slow the machine down.
//!
//! At knots along a run its lines are averaged along their length; between two knots the path is a cubic, or two
//! parabolas. Each span is as long, and averages as wide, as the tolerance allows. The path stays what it was in path
//! length: it is compared with the lines at the same path length, so both are nowhere farther from one another than the
//! tolerance, and what happens at a path length happens where it did. A corner that a planner may round with all of its
//! tolerance, because the lines that meet there are long enough, is left to it, as is all that is not a line.

mod knot;
mod lines;
mod search;
#[cfg(test)]
mod tests;

use knot::{Channels, Knot, Piece, pieces};
use lines::{Run, chord, norms, used};
use nalgebra::Vector3;
use search::{AHEAD, Search};
use shared::geometry::Line;
use shared::trajectory::{CHANNELS, Cubic, Element, Join, SHAPED, Shape, Tolerance};
use std::collections::VecDeque;

/// Share of the tolerance for the smooth path. The planner's output filter has the rest, 0.4 of it.
const SHARE: f64 = 0.6;
/// Share of that by which the attitude on a line may be off an even change of it: 0.6° of a turn a line at 10⁻⁴ rad. With half,
/// lines with a head that turns by 0.45° are left as they are; with double, smoothing has half of the tolerance of attitude.
const UNEVEN: f64 = 0.25;
/// Smaller tolerances are none \[mm\]: ways back to the lines would be shorter than an element may be.
const LEAST_TOLERANCE: f64 = 1e-4;
/// Steeper attitudes are not smoothed \[tolerances/mm\]: the tip all but stands, and the same holds.
const STEEPEST: f64 = 1e5;
/// A corner is passed in 2√(tolerance/acceleration) where it is rounded with all of the tolerance; averages are no longer
/// than is gone in half as much again to both sides. Half of that makes a sixth more elements, double a tenth
/// fewer of a longer look-ahead; times stay.
const LONGEST: f64 = 3.0;
/// Feeds that differ by less than this part are one: with half or double of it only G93, whose feeds are rounded, takes more
/// elements or somewhat lower feeds.
const SAME_FEED: f64 = 0.01;
/// No element is cut shorter than this \[mm\].
const SHORTEST: f64 = 1e-6;

/// Smooths runs of lines among elements that come one after the other. It holds some hundred lines.
#[derive(Debug)]
pub struct Smoother {
    acceleration: f64,
    run: Run,
    /// How far the smooth path of the run may be off.
    allowed: Tolerance,
    /// What its elements are joined with.
    join: Join,
    /// Where its smooth part begins \[mm\].
    begin: f64,
    /// Its newest knot, and the length of the span to that \[mm\].
    knot: Option<(Knot, f64)>,
    /// Slopes where the element before ends; none after a stop.
    slope: Option<Channels>,
    ready: VecDeque<Element>,
}

/// All of `elements` smoothed, each as far off as it says at most \[mm\].
pub fn smooth(elements: impl IntoIterator<Item = (Element, f64)>, acceleration: f64) -> Vec<Element> {
    let mut smoother = Smoother::new(acceleration);
    for (element, most) in elements {
        smoother.push(element, most, false);
    }
    smoother.finish();
    std::iter::from_fn(|| smoother.pop()).collect()
}

impl Smoother {
    /// For a machine that goes round corners with an `acceleration` \[mm/s²\].
    pub fn new(acceleration: f64) -> Self {
        Self {
            acceleration,
            run: Run::default(),
            allowed: Tolerance {
                position: 0.0,
                attitude: 0.0,
            },
            join: Join::Stop,
            begin: 0.0,
            knot: None,
            slope: None,
            ready: VecDeque::new(),
        }
    }

    /// Takes the next element. If it is a line, the smooth path may be off it by what its join allows, but `most` \[mm\] at
    /// most. An element of the smooth path begins where this one does if it has a `mark`.
    pub fn push(&mut self, element: Element, most: f64, mark: bool) {
        let before = self.run.last().map(|line| line.element.join);
        let Some((join, allowed)) = smoothing(&element, before, most) else {
            self.end_run(self.corner(&element.at(0.0).first));
            self.slope = (element.join != Join::Stop).then(|| element.at(element.length).first);
            self.ready.push_back(element);
            return;
        };
        let (_, slope) = chord(&element);
        let corner = self.corner(&slope);
        let half = self.rounded(corner, element.feed, &allowed);
        let shortest = self
            .run
            .last()
            .map_or(f64::INFINITY, |line| line.element.length)
            .min(element.length);
        if (join, allowed) != (self.join, self.allowed) || 2.0 * half <= shortest {
            self.end_run(corner);
        }
        if self.run.len() == 0 {
            self.begin = (2.0 * half).min(0.5 * element.length);
            (self.allowed, self.join) = (allowed, join);
        }
        let stop = element.join == Join::Stop;
        self.slope = (!stop).then_some(slope);
        self.run.push(element, mark);
        if stop {
            self.end_run(None);
        }
        while self.run.len() >= AHEAD {
            self.go_on(None);
        }
    }

    /// No more elements come.
    pub fn finish(&mut self) {
        self.end_run(None);
        self.slope = None;
    }

    /// The next element of the smooth path, if it is known.
    pub fn pop(&mut self) -> Option<Element> {
        self.ready.pop_front()
    }

    /// By how much slopes change where an element begins with a `slope`; nothing after a stop.
    fn corner(&self, slope: &Channels) -> Option<[f64; 2]> {
        let before = self.slope?;
        Some(norms(&std::array::from_fn(|i| slope[i] - before[i])))
    }

    /// Half of the length \[mm\] over which a planner rounds a corner if the lines there are long enough.
    fn rounded(&self, corner: Option<[f64; 2]>, feed: f64, allowed: &Tolerance) -> f64 {
        let Some([turn, spin]) = corner else { return 0.0 };
        let by_position = 4.0 * allowed.position / turn;
        let by_attitude = 4.0 * allowed.attitude / spin;
        by_position.min(by_attitude).min(self.time(allowed) * feed)
    }

    /// Half of the time over which lines are averaged at most \[s\].
    fn time(&self, allowed: &Tolerance) -> f64 {
        LONGEST * libm::sqrt(allowed.position / self.acceleration)
    }

    /// Ends the run; behind it is a `corner` that stays one.
    fn end_run(&mut self, corner: Option<[f64; 2]>) {
        let Some(last) = self.run.last() else { return };
        let (length, feed, join) = (last.element.length, last.element.feed, last.element.join);
        if self.knot.is_none() && self.run.is_block() {
            let lines = (0..).map_while(|index| self.run.get(index));
            self.ready.extend(lines.map(|line| line.element.clone()));
            self.run = Run::default();
            return;
        }
        let tail = (2.0 * self.rounded(corner, feed, &self.allowed)).min(0.5 * length);
        let end = self.run.end() - tail;
        while self.knot.is_none_or(|(knot, _)| knot.s < end) {
            self.go_on(Some(end));
        }
        if tail > 0.0 {
            self.put_line(&self.run.on_last(end), self.run.end());
        }
        if let Some(element) = self.ready.back_mut() {
            element.join = join;
        }
        (self.run, self.knot) = (Run::default(), None);
    }

    /// Finds the next knot of the run, whose smooth part ends at `end`, if that is known.
    fn go_on(&mut self, end: Option<f64>) {
        let Some((knot, before)) = self.knot else {
            if self.begin > 0.0 {
                self.put_line(&self.run.on_line(0.0), self.begin);
            }
            self.knot = Some((self.run.on_line(self.begin), 0.0));
            return;
        };
        let search = Search {
            run: &self.run,
            begin: self.begin,
            end,
            allowed: &self.allowed,
            time: self.time(&self.allowed),
        };
        let next = search.next(&knot, before);
        self.put_span(&knot, &next);
        self.knot = Some((next, next.s - knot.s));
        self.run.drop_before(next.s - next.half);
    }

    /// Puts out the path from a knot to the next.
    fn put_span(&mut self, from: &Knot, to: &Knot) {
        let begin = (from.s - from.half).min(to.s - to.half);
        let end = (from.s + from.half).max(to.s + to.half);
        if self.run.is_line(begin, end) {
            self.put_line(from, to.s);
            return;
        }
        let (first, second) = pieces(from, to);
        self.put_piece(&first);
        if let Some(second) = second {
            self.put_piece(&second);
        }
    }

    /// Puts out a piece, in parts where a line has a mark or another feed.
    fn put_piece(&mut self, piece: &Piece) {
        let mut parts: Vec<Part> = Vec::new();
        for line in self.run.between(piece.from, piece.to) {
            let (number, feed) = (line.element.line, line.element.feed);
            if let Some(part) = parts.last_mut() {
                let same = !line.mark && libm::fabs(feed - part.feed) <= SAME_FEED * part.feed;
                if same || piece.to - line.start <= SHORTEST {
                    part.lowest = part.lowest.min(feed);
                    continue;
                }
            }
            let begin = if line.start - piece.from > SHORTEST {
                line.start
            } else {
                // What is shorter than that goes with this one.
                parts.clear();
                piece.from
            };
            parts.push(Part {
                begin,
                line: number,
                feed,
                lowest: feed,
            });
        }
        let ends: Vec<f64> = parts
            .iter()
            .skip(1)
            .map(|part| part.begin)
            .chain([piece.to])
            .collect();
        for (part, end) in parts.into_iter().zip(ends) {
            let cubic = |i: usize| piece.cubics[i].from(part.begin - piece.from);
            let element = Element {
                line: part.line,
                shape: Shape::Span(std::array::from_fn(cubic)),
                rest: std::array::from_fn(|i| cubic(SHAPED + i)),
                length: end - part.begin,
                // Of the tip.
                feed: part.lowest / piece.quickest().max(1.0),
                join: self.join,
            };
            self.ready.push_back(element);
        }
    }

    /// Puts out a line as it is, from a knot on it to `to` \[mm\].
    fn put_line(&mut self, from: &Knot, to: f64) {
        let Some(line) = self.run.get(self.run.index(from.s)) else {
            return;
        };
        let length = to - from.s;
        let end = line.at(to);
        let position = |value: &Channels| Vector3::new(value[0], value[1], value[2]);
        let ends = (position(&from.value), position(&end));
        let shape = match Line::new(ends.0, ends.1) {
            Ok(line) => Shape::Line(line),
            // Too short for one.
            Err(_) => Shape::Span(std::array::from_fn(|i| {
                Cubic([from.value[i], from.slope[i], 0.0, 0.0])
            })),
        };
        let element = Element {
            line: line.element.line,
            shape,
            rest: std::array::from_fn(|i| Cubic::linear(from.value[SHAPED + i], end[SHAPED + i], length)),
            length,
            feed: line.element.feed,
            join: self.join,
        };
        self.ready.push_back(element);
    }
}

/// A part of a piece that is an element.
struct Part {
    begin: f64,
    line: u32,
    /// Of its first line, and the lowest of all \[mm/s\].
    feed: f64,
    lowest: f64,
}

/// What an element is joined with, and how far a smooth path may be off it, if it is a line and may be smoothed; one that
/// ends in a stop is as the one `before` it.
fn smoothing(element: &Element, before: Option<Join>, most: f64) -> Option<(Join, Tolerance)> {
    let join = match element.join {
        Join::Stop => before?,
        join @ Join::Blend(_) => join,
    };
    let (Join::Blend(tolerance), Shape::Line(_)) = (join, &element.shape) else {
        return None;
    };
    let share = |share: f64| Tolerance {
        position: (SHARE * tolerance.position).min(most),
        attitude: share * SHARE * tolerance.attitude,
    };
    let allowed = share(1.0 - UNEVEN);
    let (value, slope) = chord(element);
    let steep = slope[SHAPED..CHANNELS - 2]
        .iter()
        .any(|slope| libm::fabs(*slope) > STEEPEST * allowed.attitude);
    let uneven = [0.25, 0.5, 0.75].into_iter().any(|part| {
        let s = part * element.length;
        let at = element.at(s).value;
        let off = std::array::from_fn(|i| at[i] - value[i] - slope[i] * s);
        used(&off, &share(UNEVEN)) > 1.0
    });
    let numbers = value.iter().chain(&slope).chain([&element.feed, &element.length]);
    let sound = numbers.copied().all(f64::is_finite) && element.feed > 0.0 && element.length > 0.0;
    let good = sound && allowed.position >= LEAST_TOLERANCE && allowed.attitude > 0.0 && !steep && !uneven;
    good.then_some((join, allowed))
}
