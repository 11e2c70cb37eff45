//! What is a curve and what is not.

use crate::definitions::{any_curve, circle};
use curves::nurbs::{Curve, Nurbs, NurbsError, RationalBezier, length};
use nalgebra::Vector3;
use proptest::prelude::*;

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let good = circle(1.0);
    let error = |change: &dyn Fn(&mut crate::definitions::Definition)| {
        let mut bad = good.clone();
        change(&mut bad);
        bad.try_curve().unwrap_err()
    };
    assert_eq!(
        error(&|c| c.degree = 9),
        NurbsError::TooFewPoints { points: 9, degree: 9 }
    );
    assert_eq!(
        error(&|c| c.degree = 0),
        NurbsError::TooFewPoints { points: 9, degree: 0 }
    );
    assert_eq!(error(&|c| c.degree = 6), NurbsError::DegreeTooHigh { degree: 6 });
    assert_eq!(
        error(&|c| c.knots.truncate(11)),
        NurbsError::KnotCount {
            knots: 11,
            wanted: 12
        }
    );
    assert_eq!(
        error(&|c| c.knots[4] = f64::NAN),
        NurbsError::KnotNotFinite { index: 4 }
    );
    assert_eq!(
        error(&|c| c.knots[6] = 0.5),
        NurbsError::KnotsDecrease { index: 6, value: 0.5 }
    );
    assert_eq!(
        error(&|c| c.weights.truncate(8)),
        NurbsError::WeightCount {
            weights: 8,
            points: 9
        }
    );
    assert_eq!(
        error(&|c| c.weights[3] = 0.0),
        NurbsError::Weight { index: 3, value: 0.0 }
    );
    assert_eq!(
        error(&|c| c.points[8].z = f64::INFINITY),
        NurbsError::PointNotFinite { index: 8 }
    );
    assert_eq!(
        error(&|c| c.knots[5] = 1.0),
        NurbsError::KnotMultiplicity {
            index: 3,
            value: 1.0,
            count: 3,
            most: 2
        }
    );
    assert_eq!(
        error(&|c| c.knots[3] = 0.0),
        NurbsError::KnotMultiplicity {
            index: 0,
            value: 0.0,
            count: 4,
            most: 3
        }
    );
    let points = [Vector3::zeros(); 3];
    let empty = Nurbs::new(2, &points, &[1.0; 3], &[0.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
    assert_eq!(empty.unwrap_err(), NurbsError::EmptyDomain { at: 1.0 });
}

#[test]
fn errors_come_in_the_order_of_the_specification() {
    let mut bad = circle(1.0);
    bad.knots = vec![1.0; 12];
    bad.knots[1] = 0.0;
    bad.weights[0] = -1.0;
    assert!(matches!(
        bad.try_curve(),
        Err(NurbsError::KnotsDecrease { index: 1, .. })
    ));
    bad.knots[1] = 1.0;
    assert!(matches!(
        bad.try_curve(),
        Err(NurbsError::Weight { index: 0, .. })
    ));
    bad.weights[0] = 1.0;
    assert!(matches!(
        bad.try_curve(),
        Err(NurbsError::KnotMultiplicity { count: 12, .. })
    ));
}

#[test]
fn a_piece_is_checked_like_a_curve() {
    let points = [Vector3::zeros(), Vector3::x(), Vector3::y()];
    assert!(RationalBezier::new(&points, &[1.0; 3]).is_ok());
    assert_eq!(
        RationalBezier::new(&points, &[1.0, f64::NAN, 1.0]).map_err(|e| e.to_string()),
        Err("weights: weight 1 is NaN, but every weight must be finite and above zero".to_owned())
    );
    assert_eq!(
        RationalBezier::new(&points[..1], &[1.0]),
        Err(NurbsError::TooFewPoints { points: 1, degree: 0 })
    );
    assert_eq!(
        RationalBezier::new(&[], &[]),
        Err(NurbsError::TooFewPoints { points: 0, degree: 0 })
    );
    assert_eq!(
        RationalBezier::new(&[Vector3::zeros(); 7], &[1.0; 7]),
        Err(NurbsError::DegreeTooHigh { degree: 6 })
    );
}

proptest! {
    #[test]
    fn a_valid_curve_is_finite_everywhere(definition in any_curve(), u in any::<f64>()) {
        let curve = definition.curve();
        let [first, last] = curve.domain();
        for u in [u, first, last, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let at = curve.at(u);
            for vector in [at.value, at.first, at.second] {
                prop_assert!(vector.iter().all(|x| x.is_finite()), "at {}", u);
            }
        }
        prop_assert!(length(&curve).is_finite());
    }

    #[test]
    fn whatever_numbers_come_there_is_a_curve_or_an_error(
        degree in 0..8usize,
        coordinates in prop::collection::vec(prop::array::uniform3(any::<f64>()), 0..10),
        weights in prop::collection::vec(any::<f64>(), 0..10),
        knots in prop::collection::vec(prop_oneof![any::<f64>(), Just(0.0), Just(1.0)], 0..16),
        repaired in any::<bool>(),
    ) {
        let points: Vec<_> = coordinates.into_iter().map(Vector3::from).collect();
        let (mut weights, mut knots) = (weights, knots);
        if repaired {
            weights = points.iter().enumerate().map(|(i, _)| 1.0 + i as f64).collect();
            knots.resize(points.len() + degree + 1, 2.0);
            knots.sort_by(f64::total_cmp);
        }
        if let Ok(curve) = Nurbs::new(degree, &points, &weights, &knots) {
            let [first, last] = curve.domain();
            prop_assert!(first < last);
            curve.at(first / 2.0 + last / 2.0);
            length(&curve);
            prop_assert!(curve.pieces().count() >= 1);
        }
    }
}
