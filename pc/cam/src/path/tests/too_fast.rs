//! Feeds that the axes do not allow, and where they are refused.

use super::*;

/// A line, an arc that bends more than the feed allows, a line; `before` and `after` the arc.
fn arc(before: &str, after: &str) -> String {
    format!("M67 E0 Q100\nF15000\nG1 X1100\n{before}\nG3 X1110 Y1010 J10\n{after}\nG1 Y1200")
}

#[test]
fn a_beam_on_needs_a_constant_speed_where_a_part_is_judged_or_a_seam_followed() {
    let check = |body: &str, judged: bool| check_constant_speed(&plan(body).unwrap(), judged);
    let refused = |body: &str, judged: bool| check(body, judged).unwrap_err().to_string();
    // No beam, or none on the arc.
    for body in [arc("", ""), arc("M63 P0", "M62 P0"), arc("M62 P2", "M63 P2")] {
        assert_eq!(check(&body, true), Ok(()), "{body}");
    }
    let burns = arc("M62 P0", "M63 P0");
    assert_eq!(check(&burns, false), Ok(()));
    let error = refused(&burns, true);
    assert!(
        error.starts_with("line 7, column 4: the feed of 15000 mm/min is too high, the acceleration of ")
            && error.ends_with("lower F to that, for the speed must be constant with the beam on"),
        "{error}"
    );
    let follows = arc("M62 P0 P2", "M63 P0 P2").replace(" P2", "\nM62 P2");
    assert_eq!(refused(&follows, false), refused(&follows, true));
    // The feed that is named can be kept.
    let largest = error.split("allows ").nth(1).unwrap().split(' ').next().unwrap();
    let lower = burns.replace("F15000", &format!("F{largest}"));
    assert_eq!(check(&lower, true), Ok(()), "F{largest}");
}

/// The spindle of a friction-stir welder counts as a beam; it is on from before the path.
#[test]
fn a_spindle_needs_a_constant_speed_too() {
    let text =
        |on: &str| format!("G43.4\nG0 X500 Y500 Z100 B0 C0\n{on}\nG61\nF6000\nG1 X600\nG3 X610 Y510 J10\nM2");
    let paths = plan_on("stir-gantry", &text("M3 S600")).unwrap();
    assert!(matches!(
        check_constant_speed(&paths, true),
        Err(PathError::NotConstant(_))
    ));
    let paths = plan_on("stir-gantry", &text("")).unwrap();
    assert_eq!(check_constant_speed(&paths, true), Ok(()));
}

/// The planner of the motion board has no slides in its plan.
#[test]
fn a_slide_that_is_too_slow_is_refused() {
    let error = plan("F6000\nG1 X1010 V1=9").unwrap_err().to_string();
    assert!(
        error.contains("is too high, the ") && error.contains(" of V1 allows "),
        "{error}"
    );
}

#[test]
fn what_the_axes_never_come_to_is_not_asked_of_the_board() {
    let feed = |paths: Vec<PlannedPath>| {
        let legs: Vec<_> = paths[1].legs().map(|leg| leg.unwrap().element.feed).collect();
        (legs[0], legs.iter().all(|feed| *feed == legs[0]))
    };
    // 20 m/min of X and of Y, along a line of 3:4, on a machine with knots and on one without.
    let (fastest, even) = feed(plan("F999999999\nG1 X1030 Y1040\nX1060 Y1080").unwrap());
    assert!(even && (fastest - 333.333 / 0.8).abs() < 1e-2, "{fastest}");
    let text = "G43.4\nG61\nG0 X500 Y500 Z100 A0 C0\nF999999999\nG1 X530 Y540\nX560 Y580\nM2";
    let (fastest, even) = feed(plan_on("ac-head", text).unwrap());
    assert!(even && (fastest - 666.667 / 0.8).abs() < 1e-2, "{fastest}");
}
