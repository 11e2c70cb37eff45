//! Elements: what a path is made of between two junctions.

use super::{ArcLengthCurve, CHANNELS, PathPoint};
use crate::geometry::{Arc, Line, Moving};

/// Channels that a [`Shape`] gives; the rest are [`Cubic`]s.
pub const SHAPED: usize = 3;

/// A piece of path that is smooth in itself: where, how fast at most, and how it goes on.
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

    fn is_constant(&self) -> bool {
        self.0[1..] == [0.0; 3]
    }

    /// Value, first and second derivative at `s`.
    pub fn at(&self, s: f64) -> [f64; 3] {
        let [c0, c1, c2, c3] = self.0;
        [
            c0 + s * (c1 + s * (c2 + s * c3)),
            c1 + s * (2.0 * c2 + s * 3.0 * c3),
            2.0 * c2 + 6.0 * c3 * s,
        ]
    }
}

impl Element {
    /// All channels `s` \[mm\] after the start of the element.
    pub fn at(&self, s: f64) -> PathPoint {
        let mut point = PathPoint::ZERO;
        match &self.shape {
            Shape::Point(position) => point.value[..SHAPED].copy_from_slice(position),
            Shape::Line(line) => point.set_moving(&line.at(s)),
            Shape::Arc(arc) => point.set_moving(&arc.at(s)),
            Shape::Curve(curve) => point.set_moving(&curve.at(s)),
            Shape::Span(cubics) => point.set_cubics(0, cubics, s),
        }
        point.set_cubics(SHAPED, &self.rest, s);
        point
    }
}

impl PathPoint {
    fn set_moving(&mut self, moving: &Moving) {
        for i in 0..SHAPED {
            self.value[i] = moving.value[i];
            self.first[i] = moving.first[i];
            self.second[i] = moving.second[i];
        }
    }

    fn set_cubics(&mut self, channel: usize, cubics: &[Cubic], s: f64) {
        for (i, cubic) in (channel..).zip(cubics) {
            if cubic.is_constant() {
                // As most of these are; `self` was zero.
                self.value[i] = cubic.0[0];
            } else {
                [self.value[i], self.first[i], self.second[i]] = cubic.at(s);
            }
        }
    }
}
