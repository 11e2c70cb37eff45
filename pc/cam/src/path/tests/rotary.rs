//! Feeds of rotary axes alone.

use super::*;
use nc::Motion;
use shared::trajectory::Join;

const HEAD: &str = "G43.4\nG0 X500 Y500 Z100 A10 C0\n";

fn head(body: &str) -> Vec<PlannedPath> {
    plan_on("ac-head", &format!("{HEAD}{body}\nM2")).unwrap()
}

/// F is in degrees a minute over the length that A B C have together; G93 is as ever.
#[test]
fn the_feed_of_rotary_axes_alone_is_in_degrees_a_minute() {
    for (body, length, feed) in [
        ("F600 G1 A40", 30.0, 10.0),
        ("F600 G1 A40 C-40", 50.0, 10.0),
        ("F1200 G1 C-300", 300.0, 20.0),
        ("G93 G1 A40 C40 F6", 50.0, 5.0),
    ] {
        let paths = head(body);
        let path = paths.last().unwrap();
        assert_eq!(path.motion, Motion::Feed);
        assert!(
            (path.length_mm() - length).abs() < 1e-9,
            "{body}: {}",
            path.length_mm()
        );
        for leg in path.legs().map(Result::unwrap) {
            assert!(
                (leg.element.feed - feed).abs() < 1e-12,
                "{body}: {}",
                leg.element.feed
            );
        }
        // Each axis evenly, and the tip stands.
        let wanted = |name: char, from: f64, part: f64| {
            let word = body.split(' ').find_map(|word| word.strip_prefix(name));
            word.map_or(from, |word| from + (word.parse::<f64>().unwrap() - from) * part)
        };
        let seen = followed("ac-head", &paths, 0.5);
        let last = paths.len() - 1;
        let planner = planner_of("ac-head");
        for (_, s, axes) in seen.iter().filter(|at| at.0 == last) {
            for (axis, name, from) in [(3, 'A', 10.0), (5, 'C', 0.0)] {
                assert!(
                    (axes[axis] - wanted(name, from, s / length)).abs() < 1e-4,
                    "{body}: {axes:?}"
                );
            }
            let tip = planner.tip(axes).position_mm;
            assert!((Vector3::from(tip) - Vector3::new(500.0, 500.0, 100.0)).norm() < 1e-6);
        }
    }
}

/// The path rests between a way and a turn; turns of the same axes one way go on.
#[test]
fn a_path_rests_before_and_after_a_turn_alone() {
    for mode in ["G61", "G64", "G64 P0.1"] {
        let paths = head(&format!("{mode}\nF600\nG1 X510\nA20\nA30\nA20\nX520 A30\nX530"));
        let path = paths.last().unwrap();
        let legs: Vec<_> = path.legs().map(Result::unwrap).collect();
        let stops = legs.iter().filter(|leg| leg.element.join == Join::Stop);
        let lines: Vec<u32> = stops.map(|leg| leg.element.line).collect();
        assert_eq!(lines, [5, 7, 8, 10], "{mode}");
    }
    // On a machine whose paths are knots, each is one of its own.
    let paths = plan("F600\nG1 X1010\nA10\nX1020").unwrap();
    let feeds: Vec<_> = paths.iter().filter(|path| path.motion == Motion::Feed).collect();
    let lengths: Vec<f64> = feeds.iter().map(|path| path.length_mm()).collect();
    assert!(
        lengths.iter().all(|length| (length - 10.0).abs() < 1e-9) && lengths.len() == 3,
        "{lengths:?}"
    );
    assert!(feeds[1].bound.is_none() && feeds[1].speed_error == 0.0);
}

#[test]
fn axes_are_held_to_their_limits_in_a_turn_alone() {
    let text = |body: &str| format!("{HEAD}{body}\nM2");
    let error = plan_on("ac-head", &text("F600 G1 A500")).unwrap_err();
    assert!(error.to_string().contains("A out of range"), "{error}");
    let found = too_fast(plan_on("ac-head", &text("F600000 G1 C90")));
    assert_eq!((found.axis, found.unit), ("C", "°/min"), "{found}");
    let error = plan("F600\nG1 V1=3").unwrap_err();
    assert!(matches!(error, PathError::NoTravel { .. }), "{error}");
}
