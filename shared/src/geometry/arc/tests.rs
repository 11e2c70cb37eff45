extern crate std;

use super::*;
use proptest::prelude::*;
use std::string::ToString;

/// A point within ±`reach` mm.
fn point(reach: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-reach..reach, -reach..reach, -reach..reach].prop_map(Vector3::from)
}

/// Arcs and helices as a program gives them: with start, end, centre, axis and turn.
fn programmed() -> impl Strategy<Value = (Arc, [Vector3<f64>; 4], Turn)> {
    (
        [point(500.0), point(1.0), point(100.0)],
        (0.01..1.0f64, -20.0..20.0f64, -0.004..0.004f64, any::<bool>()),
    )
        .prop_filter_map(
            "a direction",
            |([centre, axis, to_start], (part, rise, off, ccw))| {
                let n = unit(axis)?;
                let arm = to_start - n * to_start.dot(&n);
                if axis.norm() < 0.1 || arm.norm() < 1.0 {
                    return None;
                }
                let start = centre + arm;
                let (turn, sign) = if ccw {
                    (Turn::CounterClockwise, 1.0)
                } else {
                    (Turn::Clockwise, -1.0)
                };
                let to_end = rotate(&n, sign * part * TAU, &arm);
                let end = centre + to_end + n * rise + to_end.normalize() * off;
                let arc = Arc::about_centre(start, end, centre, axis, turn).ok()?;
                Some((arc, [start, end, centre, n], turn))
            },
        )
}

proptest! {
    #[test]
    fn an_arc_hits_its_ends_and_goes_the_right_way((arc, [start, end, centre, n], turn) in programmed()) {
        prop_assert!((arc.at(0.0).value - start).norm() < 1e-12);
        prop_assert!((arc.at(arc.length()).value - end).norm() < 1e-12);
        prop_assert!((arc.end() - end).norm() < 1e-12);
        let sign = if turn == Turn::CounterClockwise { 1.0 } else { -1.0 };
        prop_assert!(arc.signed_sweep(&n) * sign > 0.0);
        prop_assert!((arc.rise() * sign - (end - start).dot(&n)).abs() < 1e-12);
        // All of it is at the radius, to what the ends differ by.
        for i in 0..=16 {
            let p = arc.at(arc.length() * f64::from(i) / 16.0).value - centre;
            let distance = (p - n * p.dot(&n)).norm();
            prop_assert!((distance - arc.radius()).abs() <= Arc::RADIUS_TOLERANCE);
        }
    }

    #[test]
    fn derivatives_agree_with_differences((arc, ..) in programmed(), part in 0.01..0.99f64) {
        let s = part * arc.length();
        let h = 1e-4 * arc.length();
        let (before, now, after) = (arc.at(s - h), arc.at(s), arc.at(s + h));
        // Errors of the differences: h²/6 times the third derivative, and rounding of 600 mm over h.
        let tolerance = 2.0 * h * h * arc.curvature() * arc.curvature() + 1e-12 / h;
        let first = (after.value - before.value) / (2.0 * h);
        let second = (after.first - before.first) / (2.0 * h);
        prop_assert!((first - now.first).norm() < tolerance);
        prop_assert!((second - now.second).norm() < tolerance);
        prop_assert!((now.second.norm() - arc.curvature()).abs() < 1e-12);
        prop_assert!((now.first.norm() - 1.0).abs() < 2.0 * Arc::RADIUS_TOLERANCE / arc.length() + 1e-12);
    }

    #[test]
    fn more_turns_keep_the_ends_and_the_length_of_each((arc, [start, end, ..], _) in programmed(), more in 0..9u32) {
        let turns = arc.with_turns(more);
        prop_assert!((turns.at(0.0).value - start).norm() < 1e-12);
        prop_assert!((turns.at(turns.length()).value - end).norm() < 1e-10);
        prop_assert!((turns.sweep() - arc.sweep() - TAU * f64::from(more)).abs() < 1e-12);
        let walked: f64 = (0..1000)
            .map(|i| turns.at(turns.length() * (f64::from(i) + 0.5) / 1000.0).first.norm())
            .sum::<f64>() / 1000.0;
        // But for the difference of the radii, which is spread along it.
        let tolerance = 2.0 * Arc::RADIUS_TOLERANCE / turns.length() + 1e-9;
        prop_assert!((walked - 1.0).abs() < tolerance, "{walked}");
    }
}

#[test]
fn ends_at_one_place_make_a_full_circle() {
    let (start, centre) = (Vector3::new(30.0, 40.0, 5.0), Vector3::new(0.0, 0.0, 77.0));
    for turn in [Turn::CounterClockwise, Turn::Clockwise] {
        let arc = Arc::about_centre(start, start, centre, Vector3::z() * 2.0, turn).unwrap();
        assert_eq!(arc.sweep(), TAU);
        assert_eq!(arc.centre(), Vector3::new(0.0, 0.0, 5.0));
        assert!((arc.length() - TAU * 50.0).abs() < 1e-12);
        assert!((arc.end() - start).norm() < 1e-13);
    }
}

#[test]
fn what_is_no_arc_is_refused_with_the_reason() {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let ccw = Turn::CounterClockwise;
    let refused = |arc: Result<Arc, ArcError>| arc.unwrap_err().to_string();
    let mismatch = refused(Arc::about_centre(x * 10.0, y * 10.2, Vector3::zeros(), z, ccw));
    assert!(
        mismatch.starts_with("radius mismatch: the start is 10 mm from the centre, the end 10.2 mm"),
        "{mismatch}"
    );
    assert!(refused(Arc::about_centre(x, y, x, z, ccw)).starts_with("zero radius"));
    assert!(refused(Arc::about_centre(x, y, x * 2.0, z * 0.0, ccw)).starts_with("zero axis"));
    assert!(refused(Arc::about_centre(x * f64::NAN, y, x, z, ccw)).starts_with("not finite"));
}
