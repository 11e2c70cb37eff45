//! NURBS, their rational Bézier pieces, and what is done along them (mathematics 3).
//!
//! [`Nurbs`] borrows its control points, [`RationalBezier`] owns the few of one piece; both are a [`Curve`], and
//! [length](length_between) and [discretisation](discretise) work on any of those.

mod bezier;
mod curve;
mod de_boor;
mod discretise;
mod length;
mod pieces;
mod power_basis;
mod spline;
mod validation;

pub use bezier::RationalBezier;
pub use curve::{Curve, NoTangent, curvature};
pub use discretise::{Discretisation, DiscretiseError, discretise};
pub use length::{length, length_between, parameter_at_length};
pub use pieces::{Piece, Pieces};
pub use power_basis::power_basis;
pub use shared::geometry::nurbs::MAX_DEGREE;
pub use spline::Nurbs;
pub use validation::NurbsError;

/// Control points of a piece of the highest degree.
const ORDER: usize = MAX_DEGREE + 1;
