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
        (0.01..1.0f64, -20.0..20.0f64, -0.999..0.999f64, any::<bool>()),
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
                // As far off as is allowed, with the larger radius or the smaller one.
                let off = off * Arc::radius_tolerance(0.999 * arm.norm());
                let end = centre + to_end + n * rise + to_end.normalize() * off;
                let arc = Arc::about_centre(start, end, centre, axis, turn).ok()?;
                Some((arc, [start, end, centre, n], turn))
            },
        )
}

/// As a board makes it, of what it is sent.
fn is_the_same_made_again(arc: &Arc) -> bool {
    let [start, end, centre] = [arc.start(), arc.end(), arc.centre()];
    let again = Arc::with_turns(
        start,
        end,
        centre,
        arc.axis(),
        Turn::CounterClockwise,
        arc.more_turns(),
    );
    let again = again.unwrap();
    let middle = [&again, arc].map(|arc| arc.at(0.4 * arc.length()).value);
    (again.length() - arc.length()).abs() < 1e-9 * arc.length().max(1.0)
        && (middle[0] - middle[1]).norm() < 1e-9
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
        prop_assert!(is_the_same_made_again(&arc));
        // All of it is off the programmed circle by what the radii differ by at most.
        let radius = |p: Vector3<f64>| (p - centre - n * (p - centre).dot(&n)).norm();
        let (radius_of_start, off) = (radius(start), (radius(start) - radius(end)).abs());
        for i in 0..=64 {
            let p = arc.at(arc.length() * f64::from(i) / 64.0).value;
            prop_assert!((radius(p) - radius_of_start).abs() <= off + 1e-11);
        }
    }

    #[test]
    fn derivatives_agree_with_differences((arc, ..) in programmed(), part in 0.01..0.99f64) {
        let s = part * arc.length();
        let h = 1e-4 * arc.length();
        let (before, now, after) = (arc.at(s - h), arc.at(s), arc.at(s + h));
        // Errors of the differences: h²/6 times the third derivative, and rounding of 600 mm over h.
        let tolerance = 2.0 * h * h * arc.curvature() * arc.curvature() + 1e-12 / h;
        let spread = (arc.drift - arc.axis * arc.rise()).norm() / arc.length();
        let first = (after.value - before.value) / (2.0 * h);
        let second = (after.first - before.first) / (2.0 * h);
        prop_assert!((first - now.first).norm() < tolerance);
        prop_assert!((second - now.second).norm() < tolerance);
        prop_assert!((now.second.norm() - arc.curvature()).abs() < 1e-12);
        prop_assert!((now.first.norm() - 1.0).abs() <= spread + 1e-12);
    }

    #[test]
    fn more_turns_keep_the_ends_and_the_length_of_each((_, [start, end, centre, n], turn) in programmed(), more in 0..9u32) {
        let turns = Arc::with_turns(start, end, centre, n, turn, more).unwrap();
        prop_assert!((turns.at(0.0).value - start).norm() < 1e-12);
        prop_assert!((turns.at(turns.length()).value - end).norm() < 1e-10);
        prop_assert_eq!(turns.more_turns(), more);
        prop_assert!(is_the_same_made_again(&turns));
        let walked: f64 = (0..1000)
            .map(|i| turns.at(turns.length() * (f64::from(i) + 0.5) / 1000.0).first.norm())
            .sum::<f64>() / 1000.0;
        // But for the difference of the radii, which is spread along it.
        let tolerance = (turns.drift - turns.axis * turns.rise()).norm() / turns.length() + 1e-9;
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
    assert_eq!(
        mismatch,
        "radius mismatch: the start is 10.0000 mm from the centre, the end 10.2000 mm, a difference of 0.2000 mm; \
         0.0283 mm is allowed here (0.1 % of the radius, but 0.028 mm in any case and never more than 0.5 mm); correct \
         the centre or the end"
    );
    assert!(refused(Arc::about_centre(x, y, x, z, ccw)).starts_with("zero radius"));
    assert!(refused(Arc::about_centre(x, y, x * 2.0, z * 0.0, ccw)).starts_with("zero axis"));
    assert!(refused(Arc::about_centre(x * f64::NAN, y, x, z, ccw)).starts_with("not finite"));
    assert!(refused(Arc::about_centre(x * 1e200, y * 1e200, x * 0.0, z, ccw)).starts_with("not finite"));
}

/// Radius, difference of the radii, and whether that is taken: on both sides of each limit.
#[test]
fn radii_may_differ_as_much_as_linuxcnc_lets_them() {
    let table = [
        (0.1, 0.0282, true),
        (0.1, 0.0284, false),
        (28.0, 0.0282, true),
        (28.0, 0.0284, false),
        (50.0, 0.0499, true),
        (50.0, 0.0501, false),
        (499.0, 0.498, true),
        (499.0, 0.4996, false),
        (5000.0, 0.4999, true),
        (5000.0, 0.5001, false),
    ];
    for (radius, difference, taken) in table {
        for larger_end in [true, false] {
            for part in [0.1, 0.25, 0.5, 0.75, 0.99] {
                for turn in [Turn::CounterClockwise, Turn::Clockwise] {
                    let smaller = radius - difference;
                    let [from, to] = if larger_end {
                        [smaller, radius]
                    } else {
                        [radius, smaller]
                    };
                    let (sin, cos) = libm::sincos(part * TAU);
                    let (start, end) = (Vector3::x() * from, Vector3::new(cos, sin, 0.0) * to);
                    let arc = Arc::about_centre(start, end, Vector3::zeros(), Vector3::z(), turn);
                    let case = std::format!("R {radius}, {difference} off, {part} of a turn");
                    assert_eq!(arc.is_ok(), taken, "{case}");
                    let Ok(arc) = arc else { continue };
                    assert!(is_the_same_made_again(&arc), "{case}");
                    assert!((arc.start() - start).norm() < 1e-11 && (arc.end() - end).norm() < 1e-11);
                    for i in 0..=1000 {
                        let at = arc.at(arc.length() * f64::from(i) / 1000.0).value.norm();
                        assert!((at - from).abs() <= difference + 1e-11, "{case}: {}", at - from);
                    }
                    let swept = if turn == Turn::CounterClockwise {
                        part
                    } else {
                        1.0 - part
                    };
                    if swept <= 0.5 {
                        // A circle, at the speed that is asked for.
                        let centre = arc.centre();
                        assert!(
                            ((start - centre).norm() - (end - centre).norm()).abs() < 1e-11,
                            "{case}"
                        );
                        assert!(
                            (arc.at(0.3 * arc.length()).first.norm() - 1.0).abs() < 1e-9,
                            "{case}"
                        );
                    }
                }
            }
        }
    }
}
