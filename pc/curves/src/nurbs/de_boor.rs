//! De Boor's triangle in homogeneous coordinates (w·P, w): points, derivatives and blossoms of one span.

use super::ORDER;
use nalgebra::{Vector3, Vector4};
use shared::geometry::Moving;
use shared::geometry::nurbs::project;

/// Homogeneous control points of one span; those above the degree are not used.
pub(super) type Net = [Vector4<f64>; ORDER];

/// Control points and weights as homogeneous points.
pub(super) fn homogeneous(points: &[Vector3<f64>], weights: &[f64]) -> Net {
    let mut net = Net::default();
    for (slot, (p, &w)) in net.iter_mut().zip(points.iter().zip(weights)) {
        *slot = Vector4::new(p.x * w, p.y * w, p.z * w, w);
    }
    net
}

/// One level of the triangle at parameter `u`: afterwards the first `knots.len()/2 + 1 − level` points of the
/// net are the ones of this level (from 1).
///
/// `knots` are the 2k ones around the span [`knots[k−1]`, `knots[k]`] of degree k. For a `u` in the span each
/// new point lies between two old ones, so nothing is lost to cancellation and weights stay positive.
fn raise(net: &mut Net, knots: &[f64], level: usize, u: f64) {
    let degree = knots.len() / 2;
    for j in 0..=degree - level {
        let (from, to) = (knots[j + level - 1], knots[j + degree]);
        let part = (u - from) / (to - from);
        net[j] = net[j] * (1.0 - part) + net[j + 1] * part;
    }
}

/// The blossom of the span: each level of the triangle at an argument of its own, as many as the degree.
pub(super) fn blossom(mut net: Net, knots: &[f64], arguments: impl Iterator<Item = f64>) -> Vector4<f64> {
    for (level, u) in (1..).zip(arguments) {
        raise(&mut net, knots, level, u);
    }
    net[0]
}

/// Point and two derivatives of the rational curve at `u` in the span.
///
/// The homogeneous derivatives are differences of the last levels of the triangle, where the polygon is that
/// of the tangent and of the osculating parabola: the values of algorithm A2.3 without a table of bases.
pub(super) fn evaluate(mut net: Net, knots: &[f64], u: f64) -> Moving {
    let degree = knots.len() / 2;
    let k = degree as f64;
    let width = knots[degree] - knots[degree - 1];
    for level in 1..degree.max(2) - 1 {
        raise(&mut net, knots, level, u);
    }
    let mut second = Vector4::zeros();
    if degree >= 2 {
        let before = (net[1] - net[0]) / (knots[degree] - knots[degree - 2]);
        let after = (net[2] - net[1]) / (knots[degree + 1] - knots[degree - 1]);
        second = (after - before) * (k * (k - 1.0) / width);
        raise(&mut net, knots, degree - 1, u);
    }
    let first = (net[1] - net[0]) * (k / width);
    raise(&mut net, knots, degree, u);
    project(&net[0], &first, &second)
}
