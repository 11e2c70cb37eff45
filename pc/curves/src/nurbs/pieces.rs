//! A NURBS as the Bézier curves that it falls into.

use super::bezier::RationalBezier;
use super::curve::Curve;
use super::de_boor::blossom;
use super::spline::Nurbs;

/// One span of a NURBS as a Bézier curve: C(u) is the curve at t = (u − from) / (to − from), and a derivative
/// over u is the one over t divided by (to − from), once for each order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The same points as the span.
    pub curve: RationalBezier,
    /// Parameter of the NURBS at t = 0.
    pub from: f64,
    /// Parameter of the NURBS at t = 1.
    pub to: f64,
}

/// The pieces of a NURBS, in order; see [`Nurbs::pieces`].
#[derive(Clone, Debug)]
pub struct Pieces<'a> {
    nurbs: Nurbs<'a>,
    /// Where the next piece begins.
    from: f64,
}

impl<'a> Nurbs<'a> {
    /// Exact rational Bézier pieces, one for each span that is not empty, in order.
    pub fn pieces(&self) -> Pieces<'a> {
        let [from, _] = self.domain();
        Pieces { nurbs: *self, from }
    }
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    /// Inserting both ends of the span as knots until they are full leaves the control points f(from, …, to, …)
    /// of the blossom f, with one more `to` from point to point. Weights stay positive (see `de_boor`).
    fn next(&mut self) -> Option<Piece> {
        let [_, end] = self.nurbs.domain();
        if self.from >= end {
            return None;
        }
        let span = self.nurbs.span(self.from);
        let [from, to] = self.nurbs.bounds(span);
        let (net, knots) = self.nurbs.net(span);
        let degree = self.nurbs.degree();
        let mut curve = RationalBezier::of_degree(degree);
        for j in 0..=degree {
            let arguments = (0..degree).map(|level| if level < degree - j { from } else { to });
            curve.set(j, &blossom(net, knots, arguments));
        }
        self.from = to;
        Some(Piece { curve, from, to })
    }
}
