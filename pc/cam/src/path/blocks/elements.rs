//! The elements of one block: line, arc or curve as they are, attitude as cubics.

use crate::path::block::{Block, BlockWay, Jet, MAX_ERROR};
use crate::path::exact::Join as Turning;
use crate::path::{PathError, Planner, TOLERANCE};
use shared::geometry::{Arc, ArcError, Line, Turn};
use shared::trajectory::{Cubic, Element, Join, SHAPED, Shape};
use std::f64::consts::TAU;

/// Places on a block are the same if they are this near, as a part of its length.
const SAME: f64 = 1e-9;

impl Block {
    /// The motion at `speed` \[mm/s\], continuing by `join`; its attitude comes and continues by `turns`.
    /// Where that turns there are so many elements that their cubics are off by [`MAX_ERROR`] at most in
    /// every component of T and N.
    pub(super) fn elements(
        &self,
        planner: &Planner,
        speed: f64,
        join: Join,
        turns: &[Option<Turning>; 2],
    ) -> Result<Vec<Element>, PathError> {
        let places = self.cuts(turns);
        let mut shapes = Vec::with_capacity(places.len());
        for pair in places.windows(2) {
            self.shapes(pair[0], pair[1], &mut shapes)?;
        }
        let inside = match join {
            Join::Stop => Join::Blend(TOLERANCE),
            Join::Blend(_) => join,
        };
        let turns = turns.iter().flatten();
        let moves = self.turns() || turns.clone().any(|turning| turning.half > 0.0);
        let jet = |u: f64| {
            let mut jet = self.jet(planner, u);
            turns.clone().for_each(|turning| turning.add(u, &mut jet));
            jet
        };
        let last = shapes.len() - 1;
        let mut start = 0.0;
        let mut from = jet(start);
        let mut elements = Vec::with_capacity(shapes.len());
        for (i, (shape, length)) in shapes.into_iter().enumerate() {
            let end = if i == last { self.length } else { start + length };
            let to = if moves { jet(end) } else { from.clone() };
            elements.push(Element {
                line: self.place.line,
                shape,
                rest: rest(&from, &to, length, moves),
                length,
                feed: speed,
                join: if i == last { join } else { inside },
            });
            (start, from) = (end, to);
        }
        Ok(elements)
    }

    /// Where its elements begin and end \[mm\].
    fn cuts(&self, turns: &[Option<Turning>; 2]) -> Vec<f64> {
        let [before, after] = turns.map(|turning| turning.map_or(0.0, |turning| turning.half));
        let mut fixed = vec![0.0, before, self.length - after, self.length];
        fixed.dedup_by(|a, b| *a - *b < SAME * self.length);
        if let Some(last) = fixed.last_mut() {
            *last = self.length;
        }
        // A cubic over h is off by h⁴/384 of the fourth derivative.
        let longest = libm::sqrt(libm::sqrt(384.0 * MAX_ERROR[1])) / self.turning;
        let mut cuts = vec![0.0];
        for pair in fixed.windows(2) {
            let parts = ((pair[1] - pair[0]) / longest).ceil().max(1.0) as u32;
            let part = |i: u32| f64::from(i) / f64::from(parts);
            cuts.extend((1..=parts).map(|i| pair[0] * (1.0 - part(i)) + pair[1] * part(i)));
        }
        cuts
    }

    /// Its shapes from one place to another \[mm\], with their lengths \[mm\].
    fn shapes(&self, from: f64, to: f64, shapes: &mut Vec<(Shape, f64)>) -> Result<(), PathError> {
        let place = self.place;
        match &self.way {
            BlockWay::Straight(start, end) if self.stands && start == end && self.turning == 0.0 => {
                shapes.push((Shape::Point((*start).into()), to - from));
            }
            BlockWay::Straight(start, end) if self.stands => {
                let at = |i: usize, u: f64| start[i] + (end[i] - start[i]) * (u / self.length);
                let channel = |i: usize| Cubic::linear(at(i, from), at(i, to), to - from);
                shapes.push((Shape::Span(std::array::from_fn(channel)), to - from));
            }
            BlockWay::Straight(start, end) => {
                let at = |u: f64| start * (1.0 - u / self.length) + end * (u / self.length);
                let line = Line::new(at(from), at(to)).map_err(|_| PathError::NoTravel { place })?;
                shapes.push((Shape::Line(line), line.length()));
            }
            BlockWay::Round(whole) => {
                let arc = part_of_arc(whole, from, to, self.length);
                let arc = arc.map_err(|source| PathError::Arc { place, source })?;
                shapes.push((Shape::Arc(arc), arc.length()));
            }
            BlockWay::Free(curve) => {
                let pieces = curve.pieces(from, to);
                let pieces = pieces.map_err(|s| PathError::NurbsStands { place, s })?;
                shapes.extend(pieces.into_iter().map(|piece| {
                    let length = piece.length();
                    (Shape::Curve(piece), length)
                }));
            }
        }
        Ok(())
    }
}

/// An arc of this `length` from one place to another \[mm\].
pub fn part_of_arc(whole: &Arc, from: f64, to: f64, length: f64) -> Result<Arc, ArcError> {
    if from <= 0.0 && to >= length {
        return Ok(*whole);
    }
    let at = |u: f64| whole.at_angle(whole.sweep() * u / length);
    let sweep = whole.sweep() * (to - from) / length;
    let turns = libm::fmax(libm::ceil(sweep / TAU - SAME) - 1.0, 0.0) as u32;
    let (centre, axis) = (whole.centre(), whole.axis());
    Arc::with_turns(at(from), at(to), centre, axis, Turn::CounterClockwise, turns)
}

/// The channels after the tip's between two places `length` \[mm\] apart.
fn rest<const N: usize>(from: &Jet, to: &Jet, length: f64, moves: bool) -> [Cubic; N] {
    std::array::from_fn(|i| {
        let channel = SHAPED + i;
        if moves {
            let [from, to] = [from, to].map(|jet| [jet.value[channel], jet.slope[channel]]);
            Cubic::hermite(from, to, length)
        } else {
            Cubic::constant(from.value[channel])
        }
    })
}
