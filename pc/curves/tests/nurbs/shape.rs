//! Points, derivatives, curvature, pieces.

use crate::definitions::{any_curve, at_part, circle};
use curves::nurbs::{Curve, NoTangent, Nurbs, RationalBezier, curvature};
use nalgebra::Vector3;
use proptest::prelude::*;

#[test]
fn a_circle_is_round_to_the_last_digit() {
    let circle = circle(50.0);
    let curve = circle.curve();
    for k in 0..=1000 {
        let at = curve.at(f64::from(k) * 0.004);
        assert!((at.value.norm() - 50.0).abs() < 1e-13, "radius at {k}");
        assert!(at.value.dot(&at.first).abs() < 1e-11, "tangent at {k}");
        assert!((curvature(&at).unwrap() - 0.02).abs() < 1e-15, "curvature at {k}");
    }
}

#[test]
fn at_a_kink_the_derivatives_are_those_on_its_right_and_at_the_end_those_on_its_left() {
    let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)].map(|(x, y)| Vector3::new(x, y, 0.0));
    let curve = Nurbs::new(1, &points, &[1.0; 3], &[0.0, 0.0, 1.0, 2.0, 2.0]).unwrap();
    assert_eq!(curve.at(1.0).first, Vector3::new(0.0, 3.0, 0.0));
    assert_eq!(curve.at(1.0 - 1e-9).first, Vector3::new(1.0, 0.0, 0.0));
    assert_eq!(curve.at(2.0).first, Vector3::new(0.0, 3.0, 0.0));
    assert_eq!((curve.next_break(0.0), curve.next_break(1.0)), (1.0, 2.0));
    assert_eq!(curve.at(0.3).second, Vector3::zeros());
    assert_eq!(curvature(&curve.at(0.3)), Ok(0.0));
}

#[test]
fn where_control_points_coincide_at_the_start_there_is_no_curvature() {
    let points = [(0.0, 0.0), (0.0, 0.0), (5.0, 0.0), (5.0, 5.0)].map(|(x, y)| Vector3::new(x, y, 0.0));
    let curve = RationalBezier::new(&points, &[1.0; 4]).unwrap();
    assert_eq!(curvature(&curve.at(0.0)), Err(NoTangent));
    assert!(curvature(&curve.at(0.01)).is_ok());
}

proptest! {
    #[test]
    fn pieces_are_the_curve(definition in any_curve(), part in 0.0..1.0f64) {
        let curve = definition.curve();
        let [mut reached, end] = curve.domain();
        for piece in curve.pieces() {
            prop_assert_eq!(piece.from, reached);
            reached = piece.to;
            prop_assert!(piece.curve.weights().iter().all(|&w| w > 0.0));
            // Half-way through a digit of `from` the curve belongs to the span before.
            for t in [0.0, part, 1.0] {
                let width = piece.to - piece.from;
                let u = piece.from + width * t;
                let (whole, own) = (curve.at(u), piece.curve.at(t));
                prop_assert!((whole.value - own.value).norm() <= 1e-12 * definition.size());
                if t < 1.0 || reached == end {
                    // Derivatives of the weights, each as large as their ratio, cancel in those of the curve.
                    let turns = curve.degree() as f64 * definition.weight_ratio();
                    for (seen, wanted, order) in [
                        (own.first, whole.first * width, 1),
                        (own.second, whole.second * (width * width), 2),
                    ] {
                        let rounding = 1e-14 * definition.size() * turns.powi(order);
                        prop_assert!((seen - wanted).norm() <= 1e-11 * wanted.norm() + rounding);
                    }
                }
            }
        }
        prop_assert_eq!(reached, end);
    }

    #[test]
    fn derivatives_agree_with_differences(definition in any_curve(), part in 0.0..1.0f64) {
        let curve = definition.curve();
        let u = at_part(&curve, part);
        let span = curve.span(u);
        let (from, to) = (definition.knots[span], definition.knots[span + 1]);
        let h = (to - from) * 1e-4;
        prop_assume!(u - h > from && u + h < to);
        let (before, now, after) = (curve.at(u - h), curve.at(u), curve.at(u + h));
        // The error of a central difference is h²/6 of the third derivative of what is differentiated.
        let wide = [curve.at(u - h / 2.0), curve.at(u + h / 2.0)];
        for (name, value, fine, exact) in [
            ("first", after.value - before.value, wide[1].value - wide[0].value, now.first),
            ("second", after.first - before.first, wide[1].first - wide[0].first, now.second),
        ] {
            let (coarse, fine) = (value / (2.0 * h), fine / h);
            let allowed = (coarse - fine).norm() + 1e-9 * (exact.norm() + now.first.norm() / h * 1e-2);
            prop_assert!((fine - exact).norm() <= allowed + 1e-11 * definition.size() / h, "{}", name);
        }
    }

    #[test]
    fn the_curve_stays_between_its_control_points(definition in any_curve(), part in 0.0..=1.0f64) {
        let curve = definition.curve();
        let point = curve.point(at_part(&curve, part));
        for axis in 0..3 {
            let [least, most] = definition.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, m], p| {
                [l.min(p[axis]), m.max(p[axis])]
            });
            prop_assert!(point[axis] >= least - 1e-12 && point[axis] <= most + 1e-12);
        }
    }
}
