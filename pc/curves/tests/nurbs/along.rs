//! Lengths, cuts.

use crate::definitions::{any_curve, at_part, circle};
use curves::nurbs::{
    Curve, Discretisation, DiscretiseError, Nurbs, RationalBezier, discretise, length, length_between,
    parameter_at_length,
};
use nalgebra::Vector3;
use proptest::prelude::*;
use shared::geometry::angle;
use std::f64::consts::PI;

#[test]
fn the_length_of_a_circle_is_that_of_the_textbook() {
    let circle = circle(20.0);
    let curve = circle.curve();
    assert!((length(&curve) / (40.0 * PI) - 1.0).abs() < 1e-13);
    // A quarter in each span.
    assert!((parameter_at_length(&curve, 0.0, 10.0 * PI) - 1.0).abs() < 1e-9);
    assert!((parameter_at_length(&curve, 1.0, 15.0 * PI) - 2.5).abs() < 1e-9);
}

#[test]
fn a_length_before_the_start_or_beyond_the_end_stops_there() {
    let circle = circle(20.0);
    let curve = circle.curve();
    assert_eq!(parameter_at_length(&curve, 1.5, -1.0), 1.5);
    assert_eq!(parameter_at_length(&curve, 1.5, 0.0), 1.5);
    assert_eq!(parameter_at_length(&curve, 1.5, 1e9), 4.0);
    assert_eq!(parameter_at_length(&curve, 7.0, 1.0), 4.0);
    assert_eq!(parameter_at_length(&curve, 7.0, -1.0), 4.0);
    assert_eq!(length_between(&curve, 2.0, 1.0), 0.0);
    assert_eq!(length_between(&curve, -3.0, 9.0), length(&curve));
}

/// A cubic that comes to rest inside and goes back the way it came: |C′| has a zero there, C(t) = (t²−t, …).
#[test]
fn a_point_of_rest_does_not_spoil_the_length() {
    let points = [0.0, -1.5, 3.0].map(|x| Vector3::new(x, 0.0, 0.0));
    let curve = Nurbs::new(2, &points, &[1.0; 3], &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
    // x = −3t + 6t²: back to −3/8 at t = 1/4, then on to 3.
    let exact = 0.375 + 3.375;
    assert!((length(&curve) / exact - 1.0).abs() < 1e-9);
    assert!((curve.point(parameter_at_length(&curve, 0.0, 0.75)).x).abs() < 1e-8);
}

/// The first span of a rational cubic, cut where the two rules of a quadrature agree by chance on
/// a value that is off by 1.7e-8.
#[test]
fn rules_that_agree_by_chance_are_not_believed() {
    let points = [
        (
            -58.415_600_932_945_64,
            -15.206_959_243_708_502,
            -75.201_483_537_112_01,
        ),
        (
            -25.895_527_992_877_575,
            40.590_107_980_740_71,
            89.939_653_018_450_44,
        ),
        (
            28.705_346_428_660_004,
            -5.290_481_667_167_265,
            -9.301_640_085_621_703,
        ),
        (
            -52.028_593_183_591_28,
            10.296_365_655_659_79,
            -49.845_734_820_405_596,
        ),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
    ]
    .map(|(x, y, z)| Vector3::new(x, y, z));
    let weights = [
        0.558_052_836_932_926_5,
        0.132_085_733_347_879_9,
        2.808_880_677_359_227_6,
        8.811_092_441_969_368,
        1.0,
        1.0,
    ];
    let [a, b, c, d] = [
        0.936_854_011_648_349,
        1.483_721_827_628_791_3,
        2.007_451_530_166_908_2,
        2.074_440_013_796_276,
    ];
    let knots = [a, a, a, a, b, c, d, d, d, d];
    let curve = Nurbs::new(3, &points, &weights, &knots).unwrap();
    let cut = 1.189_343_607_789_493_4;
    let parts = length_between(&curve, a, cut) + length_between(&curve, cut, b);
    assert!((parts / length_between(&curve, a, b) - 1.0).abs() < 1e-12);
}

#[test]
fn a_curve_that_crosses_the_middle_of_its_chord_is_cut() {
    let points = [(0.0, 0.0), (1.0, 3.0), (2.0, -3.0), (3.0, 0.0)].map(|(x, y)| Vector3::new(x, y, 0.0));
    let curve = RationalBezier::new(&points, &[1.0; 4]).unwrap();
    let coarse = Discretisation {
        tolerance: 0.5,
        max_turn: 3.0,
        max_chord: 10.0,
    };
    let mut cuts = Vec::new();
    discretise(&curve, &coarse, |u| cuts.push(u)).unwrap();
    assert_eq!(cuts, [0.0, 0.25, 0.5, 0.75, 1.0]);
}

#[test]
fn limits_of_a_cut_must_be_above_zero_and_knots_not_absurd() {
    let circle = circle(10.0);
    let good = Discretisation {
        tolerance: 0.01,
        max_turn: 0.1,
        max_chord: 1.0,
    };
    let bad = Discretisation {
        tolerance: 0.0,
        ..good
    };
    let cut = |definition: &crate::definitions::Definition, fineness| {
        discretise(&definition.curve(), fineness, |_| {})
    };
    assert_eq!(cut(&circle, &bad), Err(DiscretiseError::Limits));
    let nan = Discretisation {
        max_turn: f64::NAN,
        ..good
    };
    assert_eq!(cut(&circle, &nan), Err(DiscretiseError::Limits));
    assert_eq!(cut(&circle, &good), Ok(()));
    // A corner in so large a polygon is not found to a thousandth of a micrometre.
    let points = [(0.0, 0.0), (1e20, 0.0), (1e20, 1e20)].map(|(x, y)| Vector3::new(x, y, 0.0));
    let knots = [0.0, 0.0, 1e20, 2e20, 2e20];
    let absurd = Nurbs::new(1, &points, &[1.0; 3], &knots).unwrap();
    let long = Discretisation {
        max_chord: 1e30,
        ..good
    };
    assert_eq!(discretise(&absurd, &long, |_| {}), Err(DiscretiseError::Depth));
}

proptest! {
    #[test]
    fn lengths_of_parts_add_up(definition in any_curve(), a in 0.0..1.0f64, b in 0.0..1.0f64) {
        let curve = definition.curve();
        let whole = length(&curve);
        let [first, last] = curve.domain();
        let (a, b) = (at_part(&curve, a.min(b)), at_part(&curve, a.max(b)));
        let parts = [[first, a], [a, b], [b, last]].map(|[from, to]| length_between(&curve, from, to));
        let rounding = 1e-11 * definition.size();
        prop_assert!((parts.iter().sum::<f64>() - whole).abs() <= 1e-9 * whole + rounding);
        let pieces: f64 = curve.pieces().map(|piece| length(&piece.curve)).sum();
        prop_assert!((pieces - whole).abs() <= 1e-9 * whole + rounding);
        // Chords are never longer, and the finer the nearer.
        let mut chords = 0.0;
        for piece in curve.pieces() {
            let points: Vec<_> = (0..=1000).map(|i| piece.curve.point(f64::from(i) / 1000.0)).collect();
            chords += points.windows(2).map(|p| (p[1] - p[0]).norm()).sum::<f64>();
        }
        prop_assert!(chords <= whole * (1.0 + 1e-9) + rounding && chords >= whole * 0.99);
    }

    #[test]
    fn the_parameter_at_a_length_is_at_that_length_and_grows_with_it(
        definition in any_curve(), start in 0.0..1.0f64, parts in [0.0..1.0f64, 0.0..1.0f64],
    ) {
        let curve = definition.curve();
        let from = at_part(&curve, start);
        let whole = length_between(&curve, from, f64::INFINITY);
        prop_assume!(whole > 1e-6);
        let [near, far] = [parts[0].min(parts[1]), parts[0].max(parts[1])].map(|part| part * whole);
        let [u, v] = [near, far].map(|s| parameter_at_length(&curve, from, s));
        let size = length(&curve);
        for (u, s) in [(u, near), (v, far)] {
            prop_assert!((length_between(&curve, from, u) - s).abs() <= 2e-9 * size, "{} at {}", s, u);
        }
        prop_assert!(u >= from && (v > u || far - near <= 1e-8 * size));
    }

    #[test]
    fn a_curve_is_cut_as_finely_as_asked(definition in any_curve(), tolerance in 0.001..1.0f64, max_turn in 0.02..0.5f64) {
        let curve = definition.curve();
        let fineness = Discretisation { tolerance, max_turn, max_chord: 5.0 };
        let mut us = Vec::new();
        discretise(&curve, &fineness, |u| us.push(u)).unwrap();
        prop_assert_eq!([us[0], us[us.len() - 1]], curve.domain());
        for piece in curve.pieces() {
            prop_assert!(us.contains(&piece.to));
        }
        for pair in us.windows(2) {
            prop_assert!(pair[1] > pair[0]);
            let (from, to) = (curve.at(pair[0]), curve.at(pair[1]));
            let chord = to.value - from.value;
            // Kinks and points of rest.
            if pair[1] - pair[0] <= 1e-9 || chord.norm() <= 1e-9 {
                continue;
            }
            prop_assert!(angle(&from.first, &to.first) <= max_turn);
            prop_assert!(chord.norm() <= 5.0);
            for part in [0.25, 0.5, 0.75] {
                let offset = curve.point(pair[0] + (pair[1] - pair[0]) * part) - from.value;
                let along = (offset.dot(&chord) / chord.norm_squared().max(1e-300)).clamp(0.0, 1.0);
                prop_assert!((offset - chord * along).norm() <= tolerance);
            }
        }
    }
}
