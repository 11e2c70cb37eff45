//! Programs as they were written: the moves, and what of them is geometry.

use super::spiral::Spiral;
use nalgebra::Vector3;
use shared::geometry::Line;
use shared::geometry::nurbs::Curve;

/// Rotary axes A B C.
pub const ROTARY: usize = 3;

/// What the axes X Y Z do during a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// They stand here \[mm\]; rotary axes turn.
    Stand(Vector3<f64>),
    /// Straight.
    Line(Line),
    /// Arc, helix or spiral.
    Spiral(Spiral),
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
    /// Where it begins \[mm\].
    pub fn start(&self) -> Vector3<f64> {
        match self {
            Self::Stand(point) => *point,
            Self::Line(line) => line.start(),
            Self::Spiral(spiral) => spiral.point(0.0),
        }
    }

    /// Where it ends \[mm\].
    pub fn end(&self) -> Vector3<f64> {
        match self {
            Self::Stand(point) => *point,
            Self::Line(line) => line.end(),
            Self::Spiral(spiral) => spiral.point(spiral.sweep()),
        }
    }
}
