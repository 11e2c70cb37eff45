//! Feed modes, path control, planes and turns of arcs, and words that could mean two things.

use super::*;

/// The targets of the only path after the header.
fn targets(body: &str) -> Vec<Target> {
    let program = run(body).unwrap();
    let [path] = &program.paths[2..] else {
        panic!("one path: {:?}", program.paths)
    };
    path.targets.clone()
}

fn controls(body: &str) -> Vec<PathControl> {
    targets(body).iter().map(|target| target.control).collect()
}

#[test]
fn blocks_know_how_closely_they_are_followed() {
    let body = "F600\nG1 X10\nG61\nX20\nG61.1\nX30\nG64 P0.05\nX40\nG64 Q0\nX50\nG64 P0.1 Q0.02\nX60\nM2";
    let blend = |tolerance, smoothing| PathControl::Blend(Blend { tolerance, smoothing });
    let expected = [
        blend(None, None),
        PathControl::ExactPath,
        PathControl::ExactStop,
        blend(Some(0.05), None),
        blend(None, Some(0.0)),
        blend(Some(0.1), Some(0.02)),
    ];
    assert_eq!(controls(body), expected);
    assert_eq!(controls("F600\nG64 P0\nG1 X10\nM2"), [blend(None, None)]);
    for (body, value) in [("G64 P-1\nM2", -1.0), ("G64 P0.1 Q-0.02\nM2", -0.02)] {
        let (problem, line) = problem(body);
        assert!(
            matches!(problem, Problem::Value { value: seen, .. } if seen == value && line == 1),
            "{problem}"
        );
    }
    let (first, second) = ("G61", "G64");
    assert_eq!(problem("G61 G64\nM2"), (Problem::ModalGroup { first, second }, 1));
}

#[test]
fn feeds_per_revolution_go_with_the_speed_of_the_spindle() {
    let feeds = |body: &str| -> Vec<f64> {
        let program = run(body).unwrap();
        let targets = program.paths.iter().flat_map(|path| &path.targets);
        let feeds = targets.filter_map(|target| target.feed);
        feeds
            .map(|feed| match feed {
                FeedRate::PerMinute(feed) => feed,
                other @ FeedRate::InverseTime(_) => panic!("{other:?}"),
            })
            .collect()
    };
    let body = "S500 M3\nG95 F0.2\nG1 X10\nS1000\nX20\nG81 X30 Z-3 R0\nG94\nG1 F300 X40\nM2";
    assert_eq!(feeds(body), [100.0, 200.0, 200.0, 300.0]);
    assert_eq!(feeds("G20\nS100 M4\nG95 G1 X1 F0.01\nM2"), [25.4]);
    for (body, why) in [
        (
            "G95 F0.2\nG1 X10",
            "G95: F is the way of a revolution of the spindle, which does not turn",
        ),
        ("S500 M3\nG95 F0.2\nM5\nG1 X10", "which does not turn"),
        (
            "S500 M3\nG95 F0.2\nG1 B10",
            "rotary axes alone have no feed per revolution",
        ),
        ("S500 M3\nF600\nG95\nG1 X10", "needs a feed"),
    ] {
        let said = run(&format!("{body}\nM2")).unwrap_err().to_string();
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn feeds_are_per_minute_or_the_time_of_their_block() {
    let feeds = |body: &str| -> Vec<_> { targets(body).iter().map(|target| target.feed.unwrap()).collect() };
    let (mm_min, time) = (FeedRate::PerMinute, FeedRate::InverseTime);
    let body = "G1 X10 F600\nX20\nF700\nX30\nG93\nX40 F2\nG3 X60 R10 F4\nG94 F500 G1 X70\nM2";
    let expected = [
        mm_min(600.0),
        mm_min(600.0),
        mm_min(700.0),
        time(2.0),
        time(4.0),
        mm_min(500.0),
    ];
    assert_eq!(feeds(body), expected);
    assert_eq!(
        problem("G93 G1 X10 F2\nX20\nM2"),
        (Problem::NoInverseTime("G1"), 2)
    );
    assert_eq!(
        problem("F600 G1 X10\nG93 X20 F2\nG94\nX30\nM2"),
        (Problem::NoFeed("G1"), 4)
    );
    assert_eq!(problem("G93\nF2\nG1 X10 F2\nM2"), (Problem::InverseTimeAlone, 2));
    assert_eq!(problem("G93\nG0 X5 F2\nM2"), (Problem::InverseTimeAlone, 2));
    // It does not matter to rapids.
    assert!(run("G93\nG0 X10\nM2").is_ok());
}

#[test]
fn arcs_have_planes_and_turns() {
    let arcs = |body: &str| -> Vec<_> {
        let arc = |target: &Target| match target.way {
            Way::Arc(arc) => arc,
            _ => panic!("an arc"),
        };
        targets(body).iter().map(arc).collect()
    };
    let seen = arcs("F600\nG18 G2 X10 Z5 I5 K2.5 P3\nG19\nG3 Y8 Z1 R-20\nG17 X50 I20\nM2");
    let arc = |plane: Plane, turn, form, more_turns| ArcWay {
        about: plane.normal(),
        turn,
        form,
        more_turns,
    };
    let counter = Turn::CounterClockwise;
    let expected = [
        arc(Plane::Zx, Turn::Clockwise, ArcForm::Centre([5.0, 0.0, 2.5]), 2),
        arc(Plane::Yz, counter, ArcForm::Radius(-20.0), 0),
        arc(Plane::Xy, counter, ArcForm::Centre([20.0, 0.0, 0.0]), 0),
    ];
    assert_eq!(seen, expected);
    // Some CAM systems say all three; 0 is no centre elsewhere.
    assert!(run("F6\nG2 X9 I4.5 J0 K0\nM2").is_ok());
    for (body, word, plane, words) in [
        ("F6\nG2 X9 K1\nM2", "K", "G17", "I and J"),
        ("F6\nG18 G2 X9 J1\nM2", "J", "G18", "I and K"),
        ("F6\nG19 G2 Y9 I1\nM2", "I", "G19", "J and K"),
    ] {
        let word = word.to_owned();
        assert_eq!(problem(body), (Problem::OffPlane { word, plane, words }, 2));
    }
    for turns in ["0", "1.5", "-2", "10001"] {
        let (problem, line) = problem(&format!("F6\nG2 X9 I1 P{turns}\nM2"));
        assert!(
            matches!(problem, Problem::Value { .. }) && line == 2,
            "{turns}: {problem}"
        );
    }
    // P without an arc to make.
    let (code, word) = ("G2", "a centre (I J K) or R");
    assert_eq!(
        problem("F6\nG2 X9 I4.5\nP2\nM2"),
        (Problem::Missing { code, word }, 3)
    );
}

#[test]
fn a_word_belongs_to_the_code_that_needs_it() {
    // P is the output's, as M62 is nothing without it.
    let program = run("F600\nG2 X10 I5 M62 P0\nM2").unwrap();
    assert_eq!(program.paths[2].events.len(), 1);
    assert!(matches!(program.paths[2].targets[0].way, Way::Arc(arc) if arc.more_turns == 0));
    let (word, first, second) = ("P".to_owned(), "G64", "G2");
    assert_eq!(
        problem("F600\nG64 G2 X10 I5 P2\nM2"),
        (Problem::Ambiguous { word, first, second }, 2)
    );
    // An arc that holds on has no part in a block without a motion.
    let program = run("F600\nG2 X10 I5\nG64 P2\nG1 X20\nM2").unwrap();
    assert_eq!(program.paths[2].targets.len(), 2);
    assert_eq!(
        problem("F600\nG2 X10 I5\nG64 P2 X20 I5\nM2").0,
        problem("F600\nG64 G2 X10 I5 P2\nM2").0
    );
    assert_eq!(problem("F600\nG1 X10 L2\nM2"), (Problem::Orphan("L".into()), 2));
}

#[test]
fn axis_words_at_the_start_are_a_rapid_where_the_machine_file_says_so() {
    let read = |rapid_at_start, text: &str| {
        let setup = Setup {
            rapid_at_start,
            ..Setup::default()
        };
        let options = Options {
            setup: setup.into(),
            ..Options::default()
        };
        interpret(text, options)
    };
    let text = "G21 G80 G90\nG43 H1 Z50\nX5\nG1 Z2 F100\nG80\nG0 Z9\nM2";
    assert_eq!(read(false, text).unwrap_err().problem, Problem::NoMotion);
    let program = read(true, text).unwrap();
    let motions: Vec<_> = program.paths.iter().map(|path| path.motion).collect();
    let (rapid, feed) = (Motion::Rapid, Motion::Feed);
    assert_eq!(motions, [rapid, rapid, feed, rapid]);
    let told = "axis words before any motion code are those of a G0, as the machine file says";
    assert_eq!(
        program
            .notices
            .iter()
            .filter(|notice| notice.text == told)
            .count(),
        1
    );
    // As ever after a motion code.
    assert_eq!(
        read(true, "G0 X1\nG80\nX2\nM2").unwrap_err().problem,
        Problem::NoMotion
    );
}
