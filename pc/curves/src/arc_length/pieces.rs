//! Cutting a NURBS into pieces over arc length.

use super::tabulate;
use crate::nurbs::{Nurbs, Piece, Pieces, RationalBezier};
use shared::trajectory::ArcLengthCurve;
use thiserror::Error;

/// A curve that needs pieces shorter than this \[mm\] turns on the spot, for all that a machine can follow.
const SHORTEST: f64 = 1e-5;

/// A span that is shorter \[mm\] stands still in one point, for the digits of its coordinates.
const STANDING: f64 = 1e-9;

/// Part of a span that is not halved any more, whatever its length: that is all that rounding leaves of it.
const SMALLEST: f64 = 1e-12;

/// The curve has no tangent at a place inside it or at its end, or next to none.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "cusp: the curve comes to rest at parameter {u}, so it has no tangent there; move control points that \
     coincide apart, or end the curve there and begin another"
)]
pub struct Cusp {
    /// Parameter of the NURBS.
    pub u: f64,
}

/// A piece of a NURBS over its arc length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcLengthPiece {
    /// The piece.
    pub curve: ArcLengthCurve,
    /// Parameter of the NURBS where it begins.
    pub from: f64,
    /// Parameter of the NURBS where it ends.
    pub to: f64,
}

/// The pieces of a NURBS over their arc length, in order. After an error there are no more.
///
/// A span is halved where it must be, and no piece goes across a knot. Tangent and curvature are continuous from
/// piece to piece, but where those of the NURBS are not, at knots. A span that stands still in one point, as where
/// a vertex of a polygon is repeated, has no piece.
#[derive(Clone, Debug)]
pub struct ArcLengthPieces<'a> {
    /// Nothing after an error.
    spans: Option<Pieces<'a>>,
    rest: Option<SpanRemainder>,
}

/// The part of a span that is not yet cut into pieces.
#[derive(Clone, Debug)]
struct SpanRemainder {
    curve: RationalBezier,
    span: Piece,
    /// Part of the span that is left, and that `curve` is; it and `step` are sums of few powers of two, so there is no rounding.
    left: f64,
    /// Part of the span to try next.
    step: f64,
}

impl<'a> ArcLengthPieces<'a> {
    /// The pieces of `nurbs`.
    pub fn new(nurbs: &Nurbs<'a>) -> Self {
        Self {
            spans: Some(nurbs.pieces()),
            rest: None,
        }
    }
}

impl Iterator for ArcLengthPieces<'_> {
    type Item = Result<ArcLengthPiece, Cusp>;

    fn next(&mut self) -> Option<Self::Item> {
        let spans = self.spans.as_mut()?;
        let rest = match self.rest.take() {
            Some(rest) => rest,
            None => SpanRemainder::of(spans.find(|span| polygon(&span.curve) > STANDING)?),
        };
        Some(match rest.cut() {
            Ok((piece, rest)) => {
                self.rest = rest;
                Ok(piece)
            }
            Err(cusp) => {
                self.spans = None;
                Err(cusp)
            }
        })
    }
}

impl SpanRemainder {
    fn of(span: Piece) -> Self {
        Self {
            curve: span.curve,
            span,
            left: 1.0,
            step: 1.0,
        }
    }

    /// Parameter of the NURBS where this part of the span is left.
    fn parameter(&self, left: f64) -> f64 {
        self.span.to - left * (self.span.to - self.span.from)
    }

    /// The next piece, as large as halving leaves it, and what is left then.
    fn cut(mut self) -> Result<(ArcLengthPiece, Option<Self>), Cusp> {
        loop {
            self.step = libm::fmin(self.step, self.left);
            let beyond = self.left - self.step;
            let [piece, rest] = if beyond > 0.0 {
                self.curve.split(self.step / self.left)
            } else {
                [self.curve; 2]
            };
            if let Ok(curve) = tabulate(&piece) {
                let piece = ArcLengthPiece {
                    curve,
                    from: self.parameter(self.left),
                    to: self.parameter(beyond),
                };
                let rest = Self {
                    curve: rest,
                    span: self.span,
                    left: beyond,
                    step: 2.0 * self.step,
                };
                return Ok((piece, (beyond > 0.0).then_some(rest)));
            }
            if polygon(&piece) < SHORTEST || self.step < SMALLEST {
                return Err(Cusp {
                    u: self.parameter(self.left - self.step / 2.0),
                });
            }
            self.step /= 2.0;
        }
    }
}

/// Length of the control polygon \[mm\]; no curve with positive weights is longer.
fn polygon(curve: &RationalBezier) -> f64 {
    curve
        .points()
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum()
}
