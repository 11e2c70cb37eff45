//! Outputs and spindle: what waits for a motion, and what ends the path.

use super::*;

#[test]
fn a_weld_is_not_begun_while_the_spindle_turns_by_m4() {
    let error = run("S600 M4\nWELDON=lap\nG1 X10 F100\nWELDOFF\nM2")
        .unwrap_err()
        .to_string();
    assert!(error.contains("WELDON: the spindle turns by M4"), "{error}");
    assert!(run("S600 M4\nM5\nWELDON=lap\nG1 X10 F100\nWELDOFF\nM2").is_ok());
}
use shared::protocol::{Channel, PathAction};

/// Motion, targets and events of the paths after the header.
type PathSummary = (Motion, usize, Vec<(usize, ProgramAction, &'static str)>);

fn seen(body: &str) -> Vec<PathSummary> {
    let program = run(body).unwrap();
    let paths = program.paths[2..].iter();
    paths
        .map(|path| {
            let events = path.events.iter();
            let events = events.map(|event| (event.with_target, event.action, event.code));
            (path.motion, path.targets.len(), events.collect())
        })
        .collect()
}

fn beam(side: u8, on: bool) -> ProgramAction {
    ProgramAction::Output(PathAction::Beam { side, on })
}

fn power(side: u8, watt: f64) -> ProgramAction {
    ProgramAction::Output(PathAction::Power { side, watt })
}

#[test]
fn outputs_take_effect_with_the_next_motion() {
    let body = "F600\nM67 E1 Q1500\nG1 X10\nM62 P0\nM62 P2\nX20\nM63 P0\nG0 Z50\nM30";
    let tracking = ProgramAction::Output(PathAction::Tracking { on: true });
    let feed = vec![
        (0, power(1, 1500.0), "M67"),
        (1, beam(0, true), "M62"),
        (1, tracking, "M62"),
    ];
    let expected = [
        (Motion::Feed, 2, feed),
        (Motion::Rapid, 1, vec![(0, beam(0, false), "M63")]),
    ];
    assert_eq!(seen(body), expected);
    assert_eq!(problem("M62 P0\nM2"), (Problem::NoMotionAfter("M62"), 1));
}

/// M64, M65 and M68 end the path, and do not wait for the end of a dwell.
#[test]
fn immediate_outputs_end_the_path() {
    let body = "F600\nG1 X10\nM64 P0\nX20\nM68 E0 Q900\nG4 P1\nX30\nM65 P0\nM2";
    let expected = [
        (Motion::Feed, 1, vec![]),
        (Motion::Feed, 1, vec![(0, beam(0, true), "M64")]),
        (Motion::Stand, 0, vec![(0, power(0, 900.0), "M68")]),
        (Motion::Feed, 1, vec![]),
        (Motion::Stand, 0, vec![(0, beam(0, false), "M65")]),
    ];
    assert_eq!(seen(body), expected);
    let program = run(body).unwrap();
    let dwells: Vec<f64> = program.paths[2..].iter().map(|p| p.dwell_before_s).collect();
    assert_eq!(dwells, [0.0, 0.0, 0.0, 1.0, 0.0]);
    // What is synchronised with motion continues waiting.
    let body = "F600\nM62 P1\nM64 P0\nG4 P1\nG1 X10\nM2";
    let expected = [
        (Motion::Stand, 0, vec![(0, beam(0, true), "M64")]),
        (Motion::Feed, 1, vec![(0, beam(1, true), "M62")]),
    ];
    assert_eq!(seen(body), expected);
    assert_eq!(problem("M64 P0\nG53 G0 Z5\nM2"), (Problem::OnInAxes("M64"), 1));
}

/// What M3 or M4 with a speed gives, and M5.
fn on(code: &'static str, turn: Turn, rpm: f64) -> Vec<(usize, ProgramAction, &'static str)> {
    vec![
        (0, ProgramAction::SpindleSpeed(rpm), code),
        (0, ProgramAction::SpindleOn(turn), code),
    ]
}

fn off(code: &'static str) -> Vec<(usize, ProgramAction, &'static str)> {
    vec![(0, ProgramAction::SpindleOff, code)]
}

#[test]
fn a_spindle_turns_at_s_and_stops_with_the_program() {
    let body = "F600\nS500\nM3\nG4 P2\nG1 X10\nS600\nX20\nM5\nM4\nX30\nM2";
    let expected = [
        (Motion::Stand, 0, on("M3", Turn::Clockwise, 500.0)),
        (Motion::Feed, 1, vec![]),
        (
            Motion::Feed,
            1,
            vec![(0, ProgramAction::SpindleSpeed(600.0), "S")],
        ),
        (
            Motion::Feed,
            1,
            [off("M5"), on("M4", Turn::CounterClockwise, 600.0)].concat(),
        ),
        (Motion::Stand, 0, off("M2")),
    ];
    assert_eq!(seen(body), expected);
    assert!(matches!(
        problem("S-1 M3\nM2"),
        (Problem::Value { value: -1.0, .. }, 1)
    ));
    let (first, second) = ("M3", "M5");
    assert_eq!(
        problem("M3 M5 S1\nM2"),
        (Problem::ModalGroup { first, second }, 1)
    );
    // A dwell with the spindle on needs no motion after it.
    let body = "M3 S100\nG4 P5\nM2";
    let expected = [
        (Motion::Stand, 0, on("M3", Turn::Clockwise, 100.0)),
        (Motion::Stand, 0, off("M2")),
    ];
    assert_eq!(seen(body), expected);
}

fn read(text: &str) -> Program {
    interpret(text, Options::default()).unwrap()
}

fn error_of(text: &str) -> String {
    interpret(text, Options::default()).unwrap_err().to_string()
}

#[test]
fn outputs_of_the_process_follow_beams_and_tracking_by_number() {
    let program = read("G1 X1 F60\nM62 P3\nM67 E2 Q4.5\nX2\nM63 P10\nX3\nM2");
    let actions: Vec<_> = program.paths[0].events.iter().map(|event| event.action).collect();
    let output = |output, on| ProgramAction::Output(PathAction::Output { output, on });
    let level = PathAction::Level {
        channel: Channel::Analog(0),
        value: 4.5,
        over_mm: 0.0,
    };
    assert_eq!(
        actions,
        [output(0, true), ProgramAction::Output(level), output(7, false)]
    );
    for (text, told) in [
        ("M62 P11\nG1 X1 F1", "P3 to P10 are outputs 1 to 8"),
        ("M67 E4 Q1\nG1 X1 F1", "E2 and E3 analog outputs 1 and 2"),
    ] {
        let error = error_of(text);
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn a_weld_is_called_by_its_name_and_both_its_ends_are_at_rest() {
    let program = read(
        "G1 X1 F60\nWELDON = root-1\nX2\nN7 weldoff\nX3\nWELDON=cap\nX4\nWELDOFF\nWELDON=root-1\nX5\nWELDOFF\nM2",
    );
    assert_eq!(program.welds, ["root-1", "cap"]);
    let stands = program.paths.iter().filter(|path| path.motion == Motion::Stand);
    let actions: Vec<_> = stands
        .flat_map(|path| &path.events)
        .map(|event| event.action)
        .collect();
    use ProgramAction::{WeldOff, WeldOn};
    assert_eq!(
        actions,
        [WeldOn(0), WeldOff, WeldOn(1), WeldOff, WeldOn(0), WeldOff]
    );
    assert_eq!(
        program
            .paths
            .iter()
            .filter(|path| path.motion == Motion::Feed)
            .count(),
        5
    );
    for (text, told) in [
        (
            "WELDON X1",
            "line 1, column 1: WELDON needs the name of a set of the weld data: WELDON=root",
        ),
        ("WELDON=", "line 1, column 1: WELDON needs the name"),
        (
            "WELDON=a WELDOFF",
            "line 1, column 10: WELDOFF occurs twice in this block",
        ),
    ] {
        let error = error_of(text);
        assert!(error.starts_with(told), "{error}");
    }
}

#[test]
fn m3_without_s_turns_at_0_and_nothing_is_fed_so() {
    let body = "M3\nG4 P2\nS500\nG1 X10 F600\nM2";
    let expected = [
        (Motion::Stand, 0, on("M3", Turn::Clockwise, 0.0)),
        (
            Motion::Feed,
            1,
            vec![(0, ProgramAction::SpindleSpeed(500.0), "S")],
        ),
        (Motion::Stand, 0, off("M2")),
    ];
    assert_eq!(seen(body), expected);
    // S may stand in the block that feeds; rapids need none.
    for body in [
        "M4\nG0 X5\nG1 X10 F600 S1",
        "M3\nM5\nG1 X10 F600",
        "M3 S0\nG1 X10 F600",
    ] {
        assert!(run(&format!("{body}\nM2")).is_ok(), "{body}");
    }
    for feed in ["G1 X5", "G2 X5 R9", "G81 X5 Z-5 R2", "G5 X9 Y0 I1 J1 P1 Q1"] {
        let text = format!("F600\nM4\nG0 X1\n{feed}\nM2");
        let (problem, line) = problem(&text);
        assert!(
            matches!(problem, Problem::Missing { code: "M4", .. }),
            "{feed}: {problem}"
        );
        assert_eq!(line, 2, "{feed}");
    }
}

#[test]
fn the_machine_file_may_say_s_for_programs_that_do_not() {
    let read = |body: &str| {
        let options = Options {
            setup: std::sync::Arc::new(Setup {
                spindle_rpm: Some(900.0),
                ..Setup::default()
            }),
            ..Options::default()
        };
        interpret(&format!("{HEADER}{body}"), options).unwrap()
    };
    let program = read("M3\nG1 X10 F600\nS500\nX20\nM5\nM3\nX30\nM2");
    let speeds: Vec<_> = program
        .paths
        .iter()
        .flat_map(|path| &path.events)
        .filter_map(|event| match event.action {
            ProgramAction::SpindleSpeed(speed) => Some(speed),
            _ => None,
        })
        .collect();
    assert_eq!(speeds, [900.0, 500.0, 500.0]);
    let text = "M3 without S: the spindle turns at 900 r/min, as the machine file says";
    let told = program.notices.iter().filter(|notice| notice.text == text);
    assert_eq!(told.count(), 1);
    assert_eq!(read("M3 S5\nG1 X10 F600\nM2").notices, []);
}

#[test]
fn s_beside_m5_comes_before_it() {
    let off = (0, ProgramAction::SpindleOff, "M5");
    let slow = (0, ProgramAction::SpindleSpeed(50.0), "S");
    let last = |body: &str| seen(body).pop().unwrap().2;
    assert_eq!(last("S600 M3\nG1 X10 F600\nM5 S50\nM2"), [slow, off]);
    // It does not turn.
    assert_eq!(last("M5 S50\nM2"), [off]);
}

#[test]
fn the_machine_file_may_say_f_for_programs_that_do_not() {
    let read = |body: &str| {
        let options = Options {
            setup: std::sync::Arc::new(Setup {
                feed_mm_min: Some(254.0),
                ..Setup::default()
            }),
            ..Options::default()
        };
        interpret(&format!("{HEADER}{body}"), options)
    };
    let feeds = |body: &str| -> Vec<_> {
        let program = read(body).unwrap();
        let targets = program.paths.iter().flat_map(|path| &path.targets);
        targets.filter_map(|target| target.feed).collect()
    };
    let [own, said] = [254.0, 600.0].map(FeedRate::PerMinute);
    assert_eq!(feeds("G1 X10\nF600 X20\nG2 X30 I5\nM2"), [own, said, said]);
    assert_eq!(feeds("G20 G2 X1 I0.5\nG81 Z-1 R1\nM2")[0], own);
    let program = read("G1 X10\nX20\nM2").unwrap();
    let text = "G1 without F: the feed is 254 mm/min, as the machine file says";
    let told = program.notices.iter().filter(|notice| notice.text == text);
    assert_eq!(told.count(), 1);
    assert_eq!(read("F600\nG1 X10\nM2").unwrap().notices, []);
    for refused in [
        // It has said one, which means nothing any more.
        "F600 G1 X10\nG93 G1 X5 F2\nG94 G1 X10\nM2",
        "F600 G1 X10\nF0\nX20\nM2",
        // Degrees a minute are another thing.
        "G1 B5\nM2",
        "G93 G1 X10\nM2",
    ] {
        assert!(read(refused).is_err(), "{refused}");
    }
}

#[test]
fn s_beside_a_function_that_is_passed_over_is_not_taken_for_the_speed() {
    let read = |body: &str| {
        let options = Options {
            setup: std::sync::Arc::new(Setup {
                passed_over: [851].into(),
                spindle_rpm: Some(900.0),
                ..Setup::default()
            }),
            ..Options::default()
        };
        interpret(&format!("{HEADER}{body}"), options).map_err(|error| error.problem)
    };
    assert!(read("M851 S100\nS15000 M3\nG1 X10 F600\nM2").is_ok());
    assert!(read("M851 S100 M3\nG1 X10 F600\nM2").is_ok());
    assert!(matches!(
        read("S500\nM851 S100\nM3\nG1 X10 F600\nM2"),
        Err(Problem::Missing { code: "M3", .. })
    ));
    assert!(matches!(
        read("S500 M3\nM851 S100\nG1 X10 F600\nM2"),
        Err(Problem::Value { .. })
    ));
}
