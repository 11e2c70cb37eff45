//! What the words for outputs and spindle do to the paths that the boards run.

use super::*;
use nc::Motion;
use shared::protocol::PathAction;
use shared::trajectory::PathSpace;

const STIR: &str = "G43.4\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\nF120\n";

fn stir(body: &str) -> Result<Vec<PlannedPath>, PathError> {
    plan_on("stir-gantry", &format!("{STIR}{body}\nM2"))
}

fn actions(path: &PlannedPath) -> Vec<(f64, PathAction)> {
    path.legs()
        .flat_map(|leg| leg.unwrap().events)
        .map(|event| (event.s_mm, event.action))
        .collect()
}

const SPINDLE: u8 = 0;

fn gate(on: bool) -> (f64, PathAction) {
    let side = SPINDLE;
    (0.0, PathAction::Beam { side, on })
}

fn power(watt: f64) -> (f64, PathAction) {
    let side = SPINDLE;
    (0.0, PathAction::Power { side, watt })
}

/// It runs up before the dwell, in a path that goes nowhere; stays on in the feed; and is off at the end of the program.
#[test]
fn m3_turns_the_spindle_before_a_dwell_and_the_end_stops_it() {
    let paths = stir("M3 S600\nG4 P2\nG1 X650\nS800\nX700").unwrap();
    let [_, _, up, first, second, down] = &paths[..] else {
        panic!("{} paths", paths.len())
    };
    // In tool space: in axis space the boards open no gates.
    assert_eq!((up.motion, up.space), (Motion::Stand, PathSpace::Tool));
    assert_eq!(actions(up), [power(600.0), gate(true)]);
    for (_, _, axes) in followed("stir-gantry", &paths[..3], 0.1)
        .iter()
        .filter(|at| at.0 == 2)
    {
        assert!((axes[4] + 2.5).abs() < 1e-9 && axes[5].abs() < 1e-9, "{axes:?}");
    }
    let [from, to] = [0.0, up.length_mm()].map(|s| up.path().at(s).unwrap().value);
    assert_eq!(from, to);
    assert!(up.length_mm() <= 1e-3 && up.weld().is_none());
    assert_eq!((up.dwell_before_s, first.dwell_before_s), (0.0, 2.0));
    assert_eq!(actions(first), [power(600.0), gate(true)]);
    assert_eq!(actions(second), [power(600.0), gate(true), power(800.0)]);
    assert_eq!(down.motion, Motion::Stand);
    assert_eq!(actions(down).last(), Some(&gate(false)));
}

/// Also where the pose leaves an axis free, and before a move in axis space.
#[test]
fn switching_at_rest_moves_no_axis_of_any_machine() {
    let paths = plan_on("ac-head", "M64 P0\nG4 P1\nG53 G0 Z400\nM2").unwrap();
    let start = planner_of("ac-head").planning.park_axes();
    for (_, _, axes) in followed("ac-head", &paths[..1], 0.1) {
        for (seen, wanted) in axes.iter().zip(start) {
            assert!((seen - wanted).abs() < 1e-9, "{axes:?}");
        }
    }
    let paths = stir("M3 S600\nG53 G0 Z300").unwrap();
    let motions: Vec<_> = paths[2..].iter().map(|path| (path.motion, path.space)).collect();
    // The last one only switches off.
    let expected = [
        (Motion::Stand, PathSpace::Tool),
        (Motion::Rapid, PathSpace::Axes),
        (Motion::Stand, PathSpace::Axes),
    ];
    assert_eq!(motions, expected);
}

/// There the pose of the tool is that of other axes.
#[test]
fn a_machine_stands_where_its_axes_have_led_it_beyond_a_pole() {
    let paths = plan_on(
        "pipe-welder",
        "G0 X120 Z200 B0\nG53 G0 X40\nM64 P3\nG4 P0.3\nM65 P3\nM2",
    )
    .unwrap();
    let stands = paths.iter().filter(|path| path.motion == Motion::Stand);
    assert_eq!(stands.count(), 2);
    let seen = followed("pipe-welder", &paths, 0.1);
    for (_, _, axes) in seen
        .iter()
        .filter(|(path, ..)| paths[*path].motion == Motion::Stand)
    {
        assert!((axes[0] - 40.0).abs() < 1e-9, "{axes:?}");
    }
}

#[test]
fn m5_stops_the_spindle_before_the_next_motion() {
    let paths = stir("M3 S600\nG1 X650\nM5\nG1 X700").unwrap();
    let seen: Vec<_> = paths[2..].iter().map(actions).collect();
    assert_eq!(
        seen,
        [
            vec![power(600.0), gate(true)],
            vec![power(600.0), gate(true), gate(false)]
        ]
    );
}

#[test]
fn machines_say_what_their_spindle_does_not_do() {
    let message = |body: &str| stir(body).unwrap_err().to_string();
    assert_eq!(
        message("G1 X610\n S600 M4"),
        "line 6, column 7: the spindle of stir-gantry turns clockwise only: write M3, or name the output that turns it the \
         other way by spindle_reverse in [program] of the machine file"
    );
    assert_eq!(
        message("M3 S3001"),
        "line 5, column 1: 3001 r/min is more than the maximum of the spindle, 3000 r/min"
    );
    for machine in ["dual-beam-gantry", "pipe-welder", "ac-head", "wire-arc"] {
        let error = plan_on(machine, "S500\nM3\nG0 X600\nM2").unwrap_err().to_string();
        assert_eq!(
            error,
            format!(
                "line 2, column 1: M3 needs a spindle, and {machine} has none: switch its beams with M62 P, M63 P \
                 and M67 E Q, or have M3, M4, M5 and S do it: laser in [program] of the machine file"
            )
        );
    }
}

#[test]
fn coolant_is_passed_over_and_told_once() {
    let text = "M8\nG0 X600\nM9\nM2";
    let paths = plan_on("ac-head", text).unwrap();
    assert!(paths.iter().all(|path| path.events.is_empty()));
    let program = interpret(text, Options::default()).unwrap();
    let notice = "line 1, column 1: coolant switches nothing: ac-head has none";
    assert_eq!(planner_of("ac-head").notices(&program), [notice]);
}

/// They end the path, and what was on before is on again after it.
#[test]
fn immediate_outputs_switch_at_rest() {
    let body = "F3000\nM67 E0 Q500\nM62 P0\nG1 X1100\nM64 P1\nX1200\nM68 E0 Q700\nX1300\nM65 P0\nX1400";
    let paths = plan(body).unwrap();
    let lengths: Vec<f64> = paths[1..].iter().map(PlannedPath::length_mm).collect();
    assert_eq!(lengths.len(), 4);
    assert!(lengths.iter().all(|length| (length - 100.0).abs() < 1e-9));
    let other = (0.0, PathAction::Beam { side: 1, on: true });
    let seen: Vec<_> = paths[1..].iter().map(actions).collect();
    assert_eq!(seen[0], [power(500.0), gate(true)]);
    assert_eq!(seen[1], [power(500.0), gate(true), other]);
    assert_eq!(seen[2], [power(500.0), gate(true), other, power(700.0)]);
    assert_eq!(seen[3], [power(700.0), gate(true), other, gate(false)]);
}

/// A dwell leaves everything as it is; a rapid switches gates and tracking off, but keeps powers.
#[test]
fn outputs_hold_through_stops_but_not_through_rapids() {
    let body = "F3000\nM67 E0 Q500\nM62 P0\nM62 P2\nG1 X1100\nG4 P1\nX1200\nG0 X1300\nG1 X1400";
    let paths = plan(body).unwrap();
    let tracking = (0.0, PathAction::Tracking { on: true });
    let seen: Vec<_> = paths[1..].iter().map(actions).collect();
    let all = vec![power(500.0), gate(true), tracking];
    assert_eq!(seen, [all.clone(), all, vec![], vec![power(500.0)]]);
}

#[test]
fn m4_turns_the_spindle_the_other_way_by_an_output_until_m3_or_m5() {
    let text = include_str!("../../../../../machines/stir-gantry.toml");
    let more = "[outputs.left]\nnumber = 3\n[program]\nspindle_reverse = \"left\"\n";
    let machine = MachineFile::parse("m.toml", &format!("{text}\n{more}")).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let body = "S600 M4\nG1 X610\nM3\nX620\nM4\nX630\nM5\nX640\nM2";
    let program = nc::interpret(&format!("{STIR}{body}"), nc::Options::default()).unwrap();
    let paths = planner.program(&program, &machine.homed_axes(), None).unwrap();
    let left = |on| (0.0, PathAction::Output { output: 2, on });
    let seen: Vec<_> = paths
        .iter()
        .map(actions)
        .filter(|actions| !actions.is_empty())
        .collect();
    let speed = power(600.0);
    assert_eq!(seen[0], [speed, left(true), gate(true)]);
    for (path, expected) in seen[1..].iter().zip([
        vec![left(false), gate(true)],
        vec![left(true), gate(true)],
        vec![gate(false), left(false)],
    ]) {
        assert!(path.ends_with(&expected), "{path:?} {expected:?}");
    }
}
