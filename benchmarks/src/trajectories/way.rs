//! Programs as they were written: the moves, and what of them is geometry.

use super::nurbs::FreeForm;
use super::spiral::Spiral;
use curves::nurbs::{Curve, Nurbs};
use nalgebra::Vector3;
use shared::geometry::{Line, Moving};

/// Rotary axes A B C.
pub const ROTARY: usize = 3;

/// Parts of a spiral span at most this \[rad\].
const TURN: f64 = 0.1;
/// Parts of each span of a NURBS.
const PARTS: u32 = 64;

/// What the axes X Y Z do during a move.
#[derive(Clone, Debug, PartialEq)]
pub enum Way {
    /// They stand here \[mm\]; rotary axes turn.
    Stand(Vector3<f64>),
    /// Straight.
    Line(Line),
    /// Arc, helix or spiral.
    Spiral(Spiral),
    /// NURBS.
    FreeForm(FreeForm),
}

/// A way that is curved.
#[derive(Clone, Copy, Debug)]
pub enum Course<'a> {
    /// Arc, helix or spiral.
    Spiral(&'a Spiral),
    /// NURBS.
    Nurbs(Nurbs<'a>),
}

/// One move of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Line of the program, from 1.
    pub line: u32,
    /// X Y Z.
    pub way: Way,
    /// A B C at start and end \[rad\].
    pub rotary: [[f64; ROTARY]; 2],
    /// Length of the way \[mm\]; where X Y Z stand, the way of the rotary axis that turns farthest \[rad\].
    pub length: f64,
    /// Speed \[mm/s\]; where X Y Z stand \[rad/s\].
    pub feed: f64,
}

impl Way {
    /// The curve that it is; nothing if it is straight.
    pub fn course(&self) -> Option<Course<'_>> {
        match self {
            Self::Stand(_) | Self::Line(_) => None,
            Self::Spiral(spiral) => Some(Course::Spiral(spiral)),
            Self::FreeForm(curve) => Some(Course::Nurbs(curve.curve())),
        }
    }

    /// Where it begins \[mm\].
    pub fn start(&self) -> Vector3<f64> {
        match self {
            Self::Stand(point) => *point,
            Self::Line(line) => line.start(),
            Self::Spiral(spiral) => spiral.point(0.0),
            Self::FreeForm(curve) => curve.curve().point(curve.curve().domain()[0]),
        }
    }

    /// Where it ends \[mm\].
    pub fn end(&self) -> Vector3<f64> {
        match self {
            Self::Stand(point) => *point,
            Self::Line(line) => line.end(),
            Self::Spiral(spiral) => spiral.point(spiral.sweep()),
            Self::FreeForm(curve) => curve.curve().point(curve.curve().domain()[1]),
        }
    }
}

impl Course<'_> {
    /// Ranges of the parameter, one after the other, so short that each is little more than its chord.
    pub fn parts(&self) -> Vec<[f64; 2]> {
        let [first, last] = self.domain();
        let mut parts = Vec::new();
        let mut from = first;
        while from < last {
            let to = self.next_break(from);
            let count = match self {
                Self::Spiral(_) => ((to - from) / TURN).ceil() as u32,
                Self::Nurbs(_) => PARTS,
            };
            let at = |i: u32| {
                if i == count {
                    to
                } else {
                    from + (to - from) * (f64::from(i) / f64::from(count))
                }
            };
            parts.extend((0..count).map(|i| [at(i), at(i + 1)]));
            from = to;
        }
        parts
    }
}

impl Curve for Course<'_> {
    fn domain(&self) -> [f64; 2] {
        match self {
            Self::Spiral(spiral) => spiral.domain(),
            Self::Nurbs(nurbs) => nurbs.domain(),
        }
    }

    fn at(&self, u: f64) -> Moving {
        match self {
            Self::Spiral(spiral) => spiral.at(u),
            Self::Nurbs(nurbs) => nurbs.at(u),
        }
    }

    fn next_break(&self, u: f64) -> f64 {
        match self {
            Self::Spiral(spiral) => spiral.next_break(u),
            Self::Nurbs(nurbs) => nurbs.next_break(u),
        }
    }
}
