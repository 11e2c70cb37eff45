//! Moves of a program as the elements that the planner takes.

use super::spiral::Spiral;
use super::way::{Move, ROTARY, Way};
use curves::nurbs::{Curve, length_between};
use curves::{ArcLengthPieces, Cusp};
use shared::geometry::{Arc, ArcError, Turn};
use shared::trajectory::{CHANNELS, Cubic, Element, Join, SHAPED, Shape, Tolerance};
use std::f64::consts::TAU;
use thiserror::Error;

/// Largest angle of a piece of a spiral \[rad\]: it is off by this⁴/384 of its radius, 50 nm in 200 mm.
const SPAN: f64 = 0.1;

/// Corners may be rounded so far.
pub const TOLERANCE: Tolerance = Tolerance {
    position: 0.05,
    attitude: 0.05 * TAU / 360.0,
};

/// Why a move has no elements.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoElements {
    /// It is no arc that geometry knows.
    #[error(transparent)]
    Arc(#[from] ArcError),
    /// It has no tangent somewhere.
    #[error(transparent)]
    Cusp(#[from] Cusp),
}

/// The elements of a program. The last one ends in a stop, the others continue within [`TOLERANCE`].
pub fn elements(moves: &[Move]) -> Result<Vec<Element>, NoElements> {
    let mut elements = Vec::new();
    for one in moves {
        let shapes = shapes(&one.way, one.length)?;
        let whole: f64 = shapes.iter().map(|(_, length)| length).sum();
        let mut s = 0.0;
        for (shape, length) in shapes {
            let rest = rotary(one, s / whole, (s + length) / whole, length);
            elements.push(Element {
                line: one.line,
                shape,
                rest,
                length,
                feed: one.feed,
                join: Join::Blend(TOLERANCE),
            });
            s += length;
        }
    }
    if let Some(last) = elements.last_mut() {
        last.join = Join::Stop;
    }
    Ok(elements)
}

/// Rotary axes go evenly over the length.
fn rotary(one: &Move, begin: f64, end: f64, length: f64) -> [Cubic; CHANNELS - SHAPED] {
    let mut rest = [Cubic::default(); CHANNELS - SHAPED];
    let [from, to] = one.rotary;
    for i in 0..ROTARY {
        let at = |part: f64| from[i] * (1.0 - part) + to[i] * part;
        rest[i] = Cubic::linear(at(begin), at(end), length);
    }
    rest
}

/// Pieces of a way, and their lengths.
fn shapes(way: &Way, length: f64) -> Result<Vec<(Shape, f64)>, NoElements> {
    Ok(match way {
        Way::Stand(point) => vec![(Shape::Point((*point).into()), length)],
        Way::Line(line) => vec![(Shape::Line(*line), length)],
        Way::Spiral(spiral) if spiral.widening().abs() <= Arc::radius_tolerance(0.0) => {
            let arc = arc(spiral)?;
            vec![(Shape::Arc(arc), arc.length())]
        }
        Way::Spiral(spiral) => spans(spiral),
        Way::FreeForm(curve) => ArcLengthPieces::new(&curve.curve())
            .map(|piece| piece.map(|piece| (Shape::Curve(piece.curve), piece.curve.length())))
            .collect::<Result<_, Cusp>>()?,
    })
}

/// Of a program's arc whose radii differ by no more than geometry allows.
fn arc(spiral: &Spiral) -> Result<Arc, ArcError> {
    let [from, to] = spiral.domain().map(|angle| spiral.point(angle));
    let (centre, axis) = (spiral.centre(), spiral.axis());
    let turns = (spiral.sweep() / TAU - 1e-9) as u32;
    Arc::with_turns(from, to, centre, axis, Turn::CounterClockwise, turns)
}

/// Hermite spans: geometry knows no arc that widens.
fn spans(spiral: &Spiral) -> Vec<(Shape, f64)> {
    let pieces = (spiral.sweep() / SPAN).ceil() as u32;
    let angle = |piece: u32| spiral.sweep() * f64::from(piece) / f64::from(pieces);
    let span = |piece: u32| {
        let ends = [angle(piece), angle(piece + 1)];
        let length = length_between(spiral, ends[0], ends[1]);
        let [from, to] = ends.map(|u| spiral.at(u));
        let tangents = [from.first.normalize(), to.first.normalize()];
        let cubic = |i: usize| {
            Cubic::hermite(
                [from.value[i], tangents[0][i]],
                [to.value[i], tangents[1][i]],
                length,
            )
        };
        (Shape::Span(std::array::from_fn(cubic)), length)
    };
    (0..pieces).map(span).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Contour, seg};
    use super::*;
    use nalgebra::Vector3;

    const PROGRAM: &str = "L 10 0 0 720 0 0 100\n\
        C 10 0 0 20 0 0 0 0 1 0 10\n\
        C 10 0 30 20 0 0 0 0 1 -4 10\n\
        C 30.002 0 30 20 0 0 0 0 1 2 10\n\
        C 50 0 30 20 0 7 0 0 1 1 10\n\
        L 50 0 30 0 0 90 10\n";

    fn at(element: &Element, s: f64) -> [f64; 6] {
        element.at(s).axes().position
    }

    #[test]
    fn elements_follow_one_another_along_the_program() {
        let moves = seg::read(PROGRAM, "x").expect("a program");
        let elements = elements(&moves).expect("elements");
        for pair in elements.windows(2) {
            let (end, start) = (at(&pair[0], pair[0].length), at(&pair[1], 0.0));
            for i in 0..6 {
                assert!((end[i] - start[i]).abs() < 1e-9, "{pair:?}");
            }
            assert_eq!(pair[0].join, Join::Blend(TOLERANCE));
        }
        let last = elements.last().expect("some");
        assert_eq!(last.join, Join::Stop);
        let expected = [50.0, 0.0, 30.0, 0.0, 0.0, TAU / 4.0];
        for (value, expected) in at(last, last.length).into_iter().zip(expected) {
            assert!((value - expected).abs() < 1e-9);
        }
        for one in &moves {
            let lengths = elements.iter().filter(|e| e.line == one.line).map(|e| e.length);
            // What radii differ by within their tolerance does not count in the length of an arc.
            let ratio = lengths.sum::<f64>() / one.length;
            assert!((ratio - 1.0).abs() < 2e-4, "line {}: {ratio}", one.line);
        }
    }

    #[test]
    fn elements_lie_on_the_program_and_keep_the_speed() {
        let moves = seg::read(PROGRAM, "x").expect("a program");
        let elements = elements(&moves).expect("elements");
        let contour = Contour::new(&moves);
        let mut s = 0.0;
        for element in &elements {
            for part in [0.0, 0.2, 0.5, 0.9] {
                let point = element.at(element.length * part);
                let [position, first] = [point.value, point.first].map(|c| Vector3::new(c[0], c[1], c[2]));
                let error = contour
                    .nearest(&position, s + element.length * part, 0.0)
                    .distance;
                // Arcs reach an end at another radius by drifting there as a whole: off by that at most.
                assert!(error < 2e-3, "line {}: {error}", element.line);
                let speed = if matches!(element.shape, Shape::Point(_)) {
                    0.0
                } else {
                    1.0
                };
                assert!((first.norm() - speed).abs() < 1e-4, "line {}", element.line);
            }
            s += element.length;
        }
    }
}
