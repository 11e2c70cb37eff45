//! Elements: what a path is made of between two junctions.

use super::{ArcLengthCurve, CHANNELS, PathPoint};
use crate::geometry::{Arc, Line, Moving};
use nalgebra::Vector3;

/// Channels that a [`Shape`] gives; the rest are [`Cubic`]s.
pub const SHAPED: usize = 3;

/// A piece of path that is smooth in itself: where, how fast at most, and how it continues.
///
/// Elements follow one another: each begins where the one before it ends. Path length s counts the way of the
/// tool (of axes X Y Z in axis space), or, where it stands, the way of the channel that goes farthest; channels
/// may take any time and rate over it.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Line of the program that it comes from, for messages.
    pub line: u32,
    /// Position of the tool, or axes X Y Z \[mm\].
    pub shape: Shape,
    /// Channels 3 and on: T, N and the V slide extensions, or axes A B C \[rad\] and nothing.
    pub rest: [Cubic; CHANNELS - SHAPED],
    /// Path length \[mm\], above zero.
    pub length: f64,
    /// Highest speed along it, ds/dt \[mm/s\].
    pub feed: f64,
    /// How it joins the next one.
    pub join: Join,
}

/// What happens where an element ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// Comes to rest exactly at the end.
    Stop,
    /// Goes on; a corner is rounded.
    Blend(Tolerance),
}

/// How far a rounded corner may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// In position \[mm\].
    pub position: f64,
    /// In the channels of attitude \[rad\].
    pub attitude: f64,
}

/// Geometry of the first channels over path length.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// The position stands; other channels move.
    Point([f64; SHAPED]),
    /// Straight.
    Line(Line),
    /// Arc or helix.
    Arc(Arc),
    /// A cubic over path length: a span of a spline.
    Span([Cubic; SHAPED]),
    /// Free-form: a piece of a NURBS.
    Curve(ArcLengthCurve),
}

/// c₀ + c₁s + c₂s² + c₃s³ over path length s from the start of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic(pub [f64; 4]);

impl Cubic {
    /// A constant.
    pub const fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0, 0.0])
    }

    /// Evenly from `from` to `to` over `length`.
    pub fn linear(from: f64, to: f64, length: f64) -> Self {
        Self([from, (to - from) / length, 0.0, 0.0])
    }

    /// The Hermite cubic over `length` from (value, slope) to (value, slope).
    pub fn hermite(from: [f64; 2], to: [f64; 2], length: f64) -> Self {
        let per_length = 1.0 / length;
        let ([p0, d0], [p1, d1]) = (from, to);
        let chord = (p1 - p0) * per_length;
        Self([
            p0,
            d0,
            (3.0 * chord - 2.0 * d0 - d1) * per_length,
            (d0 + d1 - 2.0 * chord) * per_length * per_length,
        ])
    }

    /// The same curve, counted from `s` on.
    pub fn from(&self, s: f64) -> Self {
        let [_, _, _, c3] = self.0;
        let [value, first, second] = self.at(s);
        Self([value, first, 0.5 * second, c3])
    }

    /// Value, first and second derivative at `s`.
    pub fn at(&self, s: f64) -> [f64; 3] {
        let [c0, c1, c2, c3] = self.0;
        // Horner's rule, of which the derivatives need the same parts.
        let outer = s * c3;
        let bend = c2 + outer;
        let growth = bend + outer;
        [
            c0 + s * (c1 + s * bend),
            c1 + s * (bend + growth),
            2.0 * (growth + outer),
        ]
    }
}

impl Element {
    /// All channels `s` \[mm\] after the start of the element.
    pub fn at(&self, s: f64) -> PathPoint {
        self.channels(s)
    }

    /// The same of the first `N` channels only.
    pub(super) fn channels<const N: usize>(&self, s: f64) -> PathPoint<N> {
        let position = match &self.shape {
            Shape::Point(position) => Moving {
                value: (*position).into(),
                first: Vector3::zeros(),
                second: Vector3::zeros(),
            },
            Shape::Line(line) => line.at(s),
            Shape::Arc(arc) => arc.at(s),
            Shape::Curve(curve) => curve.at(s),
            Shape::Span(cubics) => {
                let [x, y, z] = cubics.each_ref().map(|cubic| cubic.at(s));
                let part = |i: usize| Vector3::new(x[i], y[i], z[i]);
                Moving {
                    value: part(0),
                    first: part(1),
                    second: part(2),
                }
            }
        };
        let mut point = PathPoint::ZERO;
        for i in 0..SHAPED {
            (point.value[i], point.first[i]) = (position.value[i], position.first[i]);
            point.second[i] = position.second[i];
        }
        for i in SHAPED..N {
            [point.value[i], point.first[i], point.second[i]] = self.rest[i - SHAPED].at(s);
        }
        point
    }
}
