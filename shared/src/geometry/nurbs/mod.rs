//! Free-form curves: NURBS, their rational Bézier pieces, and what is done along them (mathematics 3).
//!
//! [`Nurbs`] borrows its control points, [`RationalBezier`] owns the few of one piece; both are a [`Curve`], and
//! [length](length_between), [steps](Walk) and [discretisation](discretise) work on any of those.

mod bezier;
mod curve;
mod de_boor;
mod discretise;
mod length;
mod pieces;
mod power_basis;
mod spline;
mod stepping;
mod validation;

pub use bezier::RationalBezier;
pub use curve::{Curve, NoTangent, chord_height_radius, curvature};
pub use discretise::{Discretisation, DiscretiseError, discretise};
pub use length::{length, length_between, length_in_parts, parameter_at_length};
pub use pieces::{Piece, Pieces};
pub use power_basis::PowerBasis;
pub use spline::Nurbs;
pub use stepping::{
    EMBEDDED_ITERATIONS, NEWTON_ITERATIONS, StepError, StepRule, Walk, chord_step, newton_step, taylor_1,
    taylor_2,
};
pub use validation::NurbsError;

/// The highest degree of a curve. A piece then takes 200 bytes, and CAD systems rarely write more.
pub const MAX_DEGREE: usize = 5;

/// Control points of a piece of the highest degree.
const ORDER: usize = MAX_DEGREE + 1;
