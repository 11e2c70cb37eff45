//! G84 and G74.

use super::*;

/// What happens with which motion: rapid or feed with its Z, or the spindle.
fn course(body: &str) -> Vec<String> {
    let program = run(body).unwrap();
    let mut course = Vec::new();
    for path in &program.paths[2..] {
        for event in &path.events {
            course.push(format!("{:?}", event.action));
        }
        if path.dwell_before_s > 0.0 {
            course.push(format!("dwell {}", path.dwell_before_s));
        }
        for target in &path.targets {
            let kind = match (path.motion, path.fixed_feed) {
                (Motion::Rapid, false) => "rapid",
                (Motion::Feed, true) => "tap",
                other => panic!("{other:?}"),
            };
            course.push(format!("{kind} {}", target.words.axes[2].unwrap_or(f64::NAN)));
        }
    }
    course
}

#[test]
fn a_tap_goes_in_and_out_with_its_feed_and_turns_round_at_the_bottom() {
    let right = [
        "rapid 10",
        "SpindleSpeed(500.0)",
        "SpindleOn(Clockwise)",
        "rapid 10",
        "rapid 2",
        "tap -5",
        "SpindleOff",
        "SpindleOn(CounterClockwise)",
        "dwell 0.5",
        "tap 2",
        "SpindleOff",
        "SpindleOn(Clockwise)",
        "rapid 2",
        "tap -5",
        "SpindleOff",
        "SpindleOn(CounterClockwise)",
        "dwell 0.5",
        "tap 2",
        "SpindleOff",
        "SpindleOn(Clockwise)",
        "rapid 20",
        "SpindleOff",
    ];
    assert_eq!(
        course("G0 Z10\nS500 M3\nF500\nG99 G84 X1 Z-5 R2 P0.5\nX5\nG0 Z20\nM2"),
        right
    );
    let left: Vec<String> = right
        .iter()
        .map(|text| match text.split_once("Counter") {
            Some((before, _)) => format!("{before}Clockwise)"),
            None => text.replace("(Clockwise)", "(CounterClockwise)"),
        })
        .collect();
    assert_eq!(
        course("G0 Z10\nS500 M4\nF500\nG99 G74 X1 Z-5 R2 P0.5\nX5\nG0 Z20\nM2"),
        left
    );
}

#[test]
fn a_spindle_that_is_off_turns_for_each_hole() {
    let expected = [
        "rapid 10",
        "rapid 10",
        "rapid 2",
        "SpindleSpeed(300.0)",
        "SpindleOn(Clockwise)",
        "tap -5",
        "SpindleOff",
        "SpindleOn(CounterClockwise)",
        "tap 10",
        "SpindleOff",
    ];
    let text = "G0 Z10\nS300 F300\nG98 G84 X1 Z-5 R2\nG80\nM2";
    assert_eq!(course(text), expected);
    let told: Vec<_> = run(text)
        .unwrap()
        .notices
        .into_iter()
        .map(|notice| notice.text)
        .collect();
    for start in [
        "the spindle is off: G84 has it turn as with M3",
        "G84 without P goes up as soon as",
    ] {
        assert!(told.iter().any(|text| text.starts_with(start)), "{told:?}");
    }
}

#[test]
fn what_would_break_a_tap_is_refused() {
    for (text, why) in [
        (
            "S500 M4\nF500\nG84 X1 Z-5 R2",
            "G84: the spindle turns to the left: write M3 before",
        ),
        (
            "S500 M3\nF500\nG74 X1 Z-5 R2",
            "G74: the spindle turns to the right: write M4 before",
        ),
        (
            "F500\nG84 X1 Z-5 R2",
            "G84 needs S before it, as it turns the spindle",
        ),
        (
            "S500 M3\nF500\nG84 X1 Z-5 R2 Q1",
            "G84: a tap goes down at once: leave Q out",
        ),
    ] {
        let said = run(&format!("{text}\nM2")).unwrap_err().to_string();
        assert!(said.contains(why), "{said}");
    }
}
