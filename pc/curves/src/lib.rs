//! Free-form curves, as a PC plans with them: NURBS, their pieces over arc length, natural splines, and short lines as smooth
//! curves.
//!
//! Boards run curves as [`shared::trajectory::ArcLengthCurve`]; [`tabulate`] and [`ArcLengthPieces`] make those.
//! All mathematics goes through `libm`, so that a plan is the same on every PC, to the bit.

mod arc_length;
mod natural_spline;
pub mod nurbs;
pub mod smoothing;

pub use arc_length::{ArcLengthPiece, ArcLengthPieces, Cusp, FLUCTUATION, TooUneven, tabulate};
pub use natural_spline::{NaturalSpline, SplineError};
