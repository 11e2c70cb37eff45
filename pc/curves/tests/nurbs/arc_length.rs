//! Curves over their arc length.

use crate::definitions::{Definition, any_curve, circle};
use curves::nurbs::{Curve, Nurbs, RationalBezier, length, length_between, parameter_at_length, power_basis};
use curves::{ArcLengthPiece, ArcLengthPieces, Cusp, FLUCTUATION, tabulate};
use nalgebra::Vector3;
use proptest::prelude::*;
use shared::trajectory::{ArcLengthCurve, CHANNELS, Cubic, Element, Join, SHAPED, Shape};
use std::f64::consts::FRAC_PI_2;

fn pieces(nurbs: &Nurbs) -> Result<Vec<ArcLengthPiece>, Cusp> {
    ArcLengthPieces::new(nurbs).collect()
}

fn whole_length(pieces: &[ArcLengthPiece]) -> f64 {
    pieces.iter().map(|piece| piece.curve.length()).sum()
}

/// Parameter of the point of `nurbs` next to `point`, from one that is close: the way to the point is square to
/// the curve.
fn parameter(nurbs: &Nurbs, point: &Vector3<f64>, mut u: f64) -> f64 {
    for _ in 0..10 {
        let at = nurbs.at(u);
        u -= (at.value - point).dot(&at.first) / at.first.norm_squared();
    }
    u
}

/// Checks a piece at the length `s` and a step `ds` later: on the curve, with its tangent and curvature, and as
/// far along it as the step says.
fn check(nurbs: &Nurbs, piece: &ArcLengthPiece, s: f64, ds: f64, rounding: f64) {
    let place = |s: f64| {
        let at = piece.curve.at(s);
        (
            at,
            parameter(nurbs, &at.value, parameter_at_length(nurbs, piece.from, s)),
        )
    };
    let ((at, u), (_, later)) = (place(s), place(s + ds));
    let wanted = nurbs.at(u);
    // The last digit of the parameter may be some way along the curve.
    let fastest = f64::max(wanted.first.norm(), nurbs.at(later).first.norm());
    let rounding = rounding + 4.0 * f64::EPSILON * u.abs() * fastest;
    let length = piece.curve.length();
    let where_ = format!("{s} after {} to {} of length {length}", piece.from, piece.to);
    let off = (wanted.value - at.value).norm();
    assert!(off <= rounding, "{off} off the curve at {where_}");
    assert!(
        (at.first.norm() - 1.0).abs() < 1e-12,
        "no unit tangent at {where_}"
    );
    let tangent = wanted.first.normalize();
    assert!(
        (at.first - tangent).norm() < 1e-8 + rounding / length,
        "another tangent at {where_}"
    );
    let rate = wanted.first.norm();
    let bend = (wanted.second - tangent * tangent.dot(&wanted.second)) / (rate * rate);
    let off = (at.second - bend).norm();
    assert!(
        off <= 1e-8 * wanted.second.norm() / (rate * rate) + rounding / length.powi(2),
        "curvature off by {off} of {} at {where_}",
        bend.norm()
    );
    let gone = length_between(nurbs, u, later);
    assert!(
        (gone - ds).abs() <= 1e-6 * ds + rounding,
        "{:e} too far at {where_}",
        gone / ds - 1.0
    );
}

/// Wings with weights, a body where the curve all but stops twice, and a tail.
fn moth() -> Definition {
    let half = [
        (0.0, 50.0),
        (2.0, 50.0),
        (3.0, 45.0),
        (30.0, 62.0),
        (50.0, 60.0),
        (47.0, 40.0),
        (36.0, 31.0),
        (24.0, 32.0),
        (37.0, 26.0),
        (33.0, 12.0),
        (28.0, 3.0),
        (21.0, 12.0),
        (9.0, 20.0),
        (1.0, 33.0),
        (2.0, 20.0),
        (5.0, 14.0),
    ];
    let mut points: Vec<_> = half.iter().map(|&(x, y)| Vector3::new(x, y, 0.0)).collect();
    points.push(Vector3::new(0.0, 9.0, 0.0));
    points.extend(half.iter().rev().map(|&(x, y)| Vector3::new(-x, y, 0.0)));
    let n = points.len();
    let mut weights = vec![1.0; n];
    for (i, weight) in [(3, 1.2), (7, 2.0), (9, 5.0), (10, 3.0)] {
        weights[i] = weight;
        weights[n - 1 - i] = weight;
    }
    let inner = n - 3;
    let knots = [0; 3].into_iter().chain(0..inner + 1).chain([inner; 3]);
    Definition {
        degree: 3,
        points,
        weights,
        knots: knots.map(|knot| knot as f64 / inner as f64).collect(),
    }
}

#[test]
fn a_circle_over_its_length_is_that_of_the_textbook() {
    let definition = circle(20.0);
    let quarters = pieces(&definition.curve()).unwrap();
    assert_eq!(quarters.len(), 4);
    let mut angle = 0.0;
    for quarter in quarters {
        let length = quarter.curve.length();
        assert!((length / (FRAC_PI_2 * 20.0) - 1.0).abs() < 1e-9);
        for k in 0..=100 {
            let s = f64::from(k) * 0.01 * length;
            let at = quarter.curve.at(s);
            let (sin, cos) = (angle + s / 20.0).sin_cos();
            let (radial, along) = (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0));
            assert!((at.value - radial * 20.0).norm() < 1e-7, "position at {s}");
            assert!((at.first - along).norm() < 1e-8, "tangent at {s}");
            assert!((at.second + radial / 20.0).norm() < 1e-9, "curvature at {s}");
        }
        angle += FRAC_PI_2;
    }
}

/// At 5, 50 and 200 mm/s, over a ms, all along the curve.
#[test]
fn an_even_step_is_an_even_way_along_the_curve() {
    let definition = moth();
    let nurbs = definition.curve();
    let pieces = pieces(&nurbs).unwrap();
    assert!((whole_length(&pieces) / length(&nurbs) - 1.0).abs() < 1e-9);
    for piece in &pieces {
        let length = piece.curve.length();
        for ds in [0.005, 0.05, 0.2].map(|ds: f64| ds.min(length / 8.0)) {
            for k in 0..20 {
                check(&nurbs, piece, (length - ds) * f64::from(k) / 19.0, ds, 1e-12);
            }
        }
    }
}

#[test]
fn pieces_meet_in_position_direction_and_curvature_and_end_where_the_curve_does() {
    let definition = moth();
    let nurbs = definition.curve();
    let pieces = pieces(&nurbs).unwrap();
    let ends = |piece: &ArcLengthPiece| [piece.curve.at(0.0), piece.curve.at(piece.curve.length())];
    let (first, last) = (pieces[0], pieces[pieces.len() - 1]);
    assert_eq!([first.from, last.to], nurbs.domain());
    assert!((ends(&first)[0].value - nurbs.point(first.from)).norm() < 1e-12);
    assert!((ends(&last)[1].value - nurbs.point(last.to)).norm() < 1e-12);
    for pair in pieces.windows(2) {
        assert_eq!(pair[0].to, pair[1].from);
        let ([_, end], [start, _]) = (ends(&pair[0]), ends(&pair[1]));
        assert!((end.value - start.value).norm() < 1e-12);
        assert!((end.first - start.first).norm() < 1e-9);
        assert!((end.second - start.second).norm() < 1e-6 * start.second.norm() + 1e-9);
    }
    // Some 10 for a span with a place where it all but stops, and few for others.
    assert!(pieces.len() < 5 * definition.points.len(), "{}", pieces.len());
}

#[test]
fn derivatives_are_those_of_the_position() {
    let definition = moth();
    for piece in pieces(&definition.curve()).unwrap() {
        let length = piece.curve.length();
        let step = 1e-4 * length;
        for k in 1..20 {
            let s = f64::from(k) * 0.05 * length;
            let [before, at, after] = [s - step, s, s + step].map(|s| piece.curve.at(s));
            let slope = (after.value - before.value) / (2.0 * step);
            let bend = (after.first - before.first) / (2.0 * step);
            assert!((slope - at.first).norm() < 1e-6);
            assert!((bend - at.second).norm() < 1e-5 * (at.second.norm() + 1.0 / length));
        }
    }
}

/// Over 2 to 5.
fn cubic(points: [(f64, f64); 4]) -> Definition {
    Definition {
        degree: 3,
        points: points.map(|(x, y)| Vector3::new(x, y, 0.0)).to_vec(),
        weights: vec![1.0; 4],
        knots: vec![2.0, 2.0, 2.0, 2.0, 5.0, 5.0, 5.0, 5.0],
    }
}

#[test]
fn a_cusp_is_an_error_with_its_place() {
    let inside = cubic([(0.0, 0.0), (10.0, 10.0), (0.0, 10.0), (10.0, 0.0)]);
    let back_and_forth = cubic([(0.0, 0.0), (9.0, 0.0), (-8.0, 0.0), (1.0, 0.0)]);
    let at_start = cubic([(0.0, 0.0), (0.0, 0.0), (5.0, 0.0), (5.0, 5.0)]);
    let at_end = cubic([(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (5.0, 5.0)]);
    // x′ = 0 where 52t² − 52t + 9 = 0.
    let first_turn = 2.0 + 3.0 * (0.5 - (0.25f64 - 9.0 / 52.0).sqrt());
    for (definition, u) in [
        (inside, 3.5),
        (back_and_forth, first_turn),
        (at_start, 2.0),
        (at_end, 5.0),
    ] {
        let nurbs = definition.curve();
        let mut pieces = ArcLengthPieces::new(&nurbs);
        let cusp = pieces.find_map(Result::err).expect("a cusp");
        assert!((cusp.u - u).abs() < 0.01, "{cusp}, not at {u}");
        assert!(pieces.next().is_none());
    }
}

#[test]
fn a_span_in_one_point_has_no_piece() {
    assert_eq!(pieces(&cubic([(1.0, 1.0); 4]).curve()), Ok(vec![]));
    let points = [0.0, 1.0, 1.0, 4.0].map(|x| Vector3::new(x, 0.1, 0.7));
    let polygon = Nurbs::new(1, &points, &[1.0, 0.3, 0.7, 2.0], &[0.0, 0.0, 1.0, 2.0, 3.0, 3.0]).unwrap();
    let pieces = pieces(&polygon).unwrap();
    assert!(pieces.iter().all(|piece| piece.to <= 1.0 || piece.from >= 2.0));
    assert!((whole_length(&pieces) - 4.0).abs() < 1e-8);
}

/// A cusp opened so little that the curve turns within some micrometres.
#[test]
fn a_curve_that_all_but_stops_is_cut_and_keeps_its_speed() {
    let definition = cubic([(0.0, 0.0), (10.03, 10.0), (0.0, 10.0), (10.0, 0.0)]);
    let nurbs = definition.curve();
    let pieces = pieces(&nurbs).unwrap();
    assert!((5..40).contains(&pieces.len()), "{}", pieces.len());
    for piece in &pieces {
        let length = piece.curve.length();
        for k in 0..20 {
            check(
                &nurbs,
                piece,
                length * f64::from(k) / 20.0,
                f64::min(length / 20.0, 0.005),
                1e-12,
            );
        }
    }
}

#[test]
fn what_is_too_uneven_says_so() {
    let points = [(0.0, 0.0), (10.0, 10.0), (3.0, 10.0), (10.0, 0.0)].map(|(x, y)| Vector3::new(x, y, 0.0));
    let curve = RationalBezier::new(&points, &[1.0; 4]).unwrap();
    let error = tabulate(&curve).unwrap_err();
    assert!(f64::from(error.fluctuation) > FLUCTUATION / 2.0);
    assert!(error.to_string().starts_with("too uneven"), "{error}");
    let overflowing = points.map(|point| point * 1e200);
    let curve = RationalBezier::new(&overflowing, &[1.0; 4]).unwrap();
    assert!(tabulate(&curve).is_err());
}

#[test]
fn a_curve_is_small_and_an_element_goes_along_it() {
    assert!(size_of::<ArcLengthCurve>() <= 320);
    let points = [(0.0, 0.0), (3.0, 0.0), (5.0, 2.0)].map(|(x, y)| Vector3::new(x, y, 1.0));
    let curve = tabulate(&RationalBezier::new(&points, &[1.0, 0.9, 1.0]).unwrap()).unwrap();
    let element = Element {
        line: 1,
        shape: Shape::Curve(curve),
        rest: [Cubic::constant(0.5); CHANNELS - SHAPED],
        length: curve.length(),
        feed: 50.0,
        join: Join::Stop,
    };
    let (point, at) = (element.at(1.25), curve.at(1.25));
    assert_eq!(point.value[..SHAPED], *at.value.as_slice());
    assert_eq!(point.first[..SHAPED], *at.first.as_slice());
    assert_eq!(point.second[..SHAPED], *at.second.as_slice());
    assert_eq!((point.value[SHAPED], point.first[SHAPED]), (0.5, 0.0));
}

proptest! {
    #[test]
    fn both_parts_of_a_split_and_the_power_basis_are_the_curve(
        definition in any_curve(),
        cut in 0.05..0.95f64,
        t in 0.0..1.0f64,
    ) {
        let rounding = 1e-12 * definition.size() * definition.weight_ratio();
        for piece in definition.curve().pieces() {
            let [before, after] = piece.curve.split(cut);
            prop_assert_eq!(before.at(1.0).value, after.at(0.0).value);
            prop_assert_eq!(before.points()[0], piece.curve.points()[0]);
            prop_assert_eq!(after.points().last(), piece.curve.points().last());
            for (part, of_whole) in [(before, cut * t), (after, cut + (1.0 - cut) * t)] {
                let (wanted, seen) = (piece.curve.at(of_whole), part.at(t));
                prop_assert!((seen.value - wanted.value).norm() <= rounding);
                let power = power_basis(&part).at(2.0 * t - 1.0);
                prop_assert!((power.value - seen.value).norm() <= rounding);
                let off = (power.first * 2.0 - seen.first).norm();
                prop_assert!(off <= 1e-9 * seen.first.norm() + 100.0 * rounding);
                let off = (power.second * 4.0 - seen.second).norm();
                prop_assert!(off <= 1e-9 * seen.second.norm() + 1e4 * rounding);
            }
        }
    }

    /// Of any curve: even speed, exact ends, and a cusp only where it all but stops.
    #[test]
    fn any_curve_is_gone_along_evenly(definition in any_curve(), part in 0.0..1.0f64) {
        let nurbs = definition.curve();
        let [from, to] = nurbs.domain();
        let rounding = 1e-12 * definition.size();
        let mut reached = nurbs.point(from);
        for piece in ArcLengthPieces::new(&nurbs) {
            let piece = match piece {
                Ok(piece) => piece,
                Err(Cusp { u }) => {
                    let places = (0..=100).map(|k| nurbs.at(from + (to - from) * f64::from(k) / 100.0));
                    let fastest = places.map(|at| at.first.norm()).fold(0.0, f64::max);
                    prop_assert!(nurbs.at(u).first.norm() <= 0.02 * fastest, "no cusp at {u}");
                    return Ok(());
                }
            };
            let length = piece.curve.length();
            let whole = length_between(&nurbs, piece.from, piece.to);
            prop_assert!((length - whole).abs() <= 1e-9 * whole + rounding, "{length}, not {whole}");
            prop_assert!((piece.curve.at(0.0).value - reached).norm() <= rounding);
            reached = piece.curve.at(length).value;
            for ds in [0.005f64, 0.05, 0.2].map(|ds| ds.min(0.5 * length)) {
                check(&nurbs, &piece, (length - ds) * (0.01 + 0.98 * part), ds, rounding);
            }
        }
        prop_assert!((reached - nurbs.point(to)).norm() <= rounding);
    }
}
