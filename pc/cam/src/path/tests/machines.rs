//! What differs from machine to machine: words, turns, poles, and moves of the axes.

use super::*;
use shared::trajectory::PathSpace;

const PIPE: &str = "G43.4\nG0 X100 Y0 Z240 B0 C0\nG0 X40 Y0 Z100 B60 C0\n";

fn pipe(body: &str) -> Result<Vec<PlannedPath>, PathError> {
    plan_on("pipe-welder", &format!("{PIPE}{body}\nM2"))
}

/// Where the axes stand at the end (mm, degrees).
fn end(machine: &str, paths: &[PlannedPath]) -> [f64; AXES] {
    followed(machine, paths, 0.1).last().unwrap().2
}

fn assert_axes(seen: [f64; AXES], wanted: [f64; AXES]) {
    for (seen_one, wanted_one) in seen.iter().zip(wanted) {
        assert!((seen_one - wanted_one).abs() < 1e-6, "{seen:?} is not {wanted:?}");
    }
}

#[test]
fn words_of_axes_that_a_machine_does_not_have_are_refused() {
    assert_eq!(
        pipe("G0 A5").unwrap_err().to_string(),
        "line 4, column 4: pipe-welder has no A; its words are X Z B C, and X Y Z of the tip"
    );
    let no = |error: PathError| match error {
        PathError::NotFitted { place, word, .. } => (place.line, word),
        other => panic!("{other}"),
    };
    assert_eq!(no(pipe("G0 V1=1").unwrap_err()), (4, "V1"));
    // Of the tip, but not of an axis.
    assert!(pipe("G0 Y5 C7.125016").is_ok());
    assert_eq!(no(pipe("G53 G0 Y5").unwrap_err()), (4, "Y"));
    assert_eq!(no(plan_on("ac-head", "G53 G0 B5\nM2").unwrap_err()), (1, "B"));
}

#[test]
fn what_a_first_motion_does_not_say_stays_as_the_machine_stands() {
    let park = planner_of("ac-head").planning.park_axes();
    let whole = format!("G0 X500 Y500 Z100 A{} C{}\nM2", park[3], park[5]);
    let [said, not_said] = [&whole, "G0 X500 Y500 Z100\nM2"].map(|text| plan_on("ac-head", text).unwrap());
    assert_axes(end("ac-head", &not_said), end("ac-head", &said));
    let error = plan_on("ac-head", "G21\nM5\nM2").unwrap_err();
    assert_eq!(error.to_string(), "the program does not move the machine");
}

#[test]
fn steps_go_on_from_where_the_machine_stands_if_the_program_was_read_for_it() {
    let planner = planner_of("ac-head");
    let park = planner.planning.park_axes();
    let text = "G91\nG0 X10 Z-5\nG90 G53 G0 A20\nG91 G0 Y5\nG28\nM2";
    let read = |setup: nc::Setup| {
        let options = nc::Options {
            setup: std::sync::Arc::new(setup),
            ..nc::Options::default()
        };
        nc::interpret(text, options).unwrap()
    };
    let other = nc::Setup {
        start: [1.0; AXES],
        ..planner.setup(&park)
    };
    let error = planner.program(&read(other), &park, None).unwrap_err();
    assert!(
        matches!(error, PathError::OtherStart { place } if place.line == 2),
        "{error}"
    );
    let paths = planner.program(&read(planner.setup(&park)), &park, None).unwrap();
    assert_axes(end("ac-head", &paths), park);
}

#[test]
fn beams_and_tracking_that_a_machine_does_not_have_are_refused() {
    let message = |body: &str| pipe(body).unwrap_err().to_string();
    assert_eq!(
        message("M62 P1\nG0 Z110"),
        "line 4, column 1: pipe-welder has no beam 2"
    );
    assert_eq!(
        message("M67 E1 Q5\nG0 Z110"),
        "line 4, column 1: pipe-welder has no beam 2"
    );
    assert_eq!(
        message("M62 P2\nG0 Z110"),
        "line 4, column 1: pipe-welder has no seam tracking"
    );
}

/// Twice around the branch would not fit the travel; once does, and the axes know of the turn.
#[test]
fn an_axis_turns_on_with_the_tip_and_comes_back_in_axis_space() {
    let mut body = "F1200\nG1\n".to_owned();
    for i in 1..=72 {
        let phi = f64::from(5 * i).to_radians();
        let (x, y) = (40.0 * phi.cos(), 40.0 * phi.sin());
        writeln!(body, "X{x:.6} Y{y:.6} C{}", 5 * i).unwrap();
    }
    let paths = pipe(&body).unwrap();
    assert_axes(
        end("pipe-welder", &paths),
        [70.0, 0.0, 100.0 + 30.0 * 3f64.sqrt(), 0.0, 60.0, 360.0],
    );

    // The tip is where C0 is, but C has turned.
    let error = pipe(&format!("{body}G0 Z110 C0")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 78, column 4: C would come to 360.000°, not to 0.000°: a block turns the short way; write it as several \
         blocks of less than 180°"
    );
    let paths = pipe(&format!("{body}G53 G0 X190\nG53 G0 C0\nG0 X40 Y0 Z100")).unwrap();
    assert_axes(
        end("pipe-welder", &paths),
        [70.0, 0.0, 100.0 + 30.0 * 3f64.sqrt(), 0.0, 60.0, 0.0],
    );
}

#[test]
fn a_tip_that_contradicts_its_axis_is_named() {
    assert_eq!(
        pipe("G0 X0 Y40 C80").unwrap_err().to_string(),
        "line 4, column 4: C would come to 90.000°, not to 80.000°: the position of this axis follows from the tip; correct the \
         word, or X Y Z"
    );
    assert!(pipe("G0 X0 Y40 C90").is_ok());
}

/// More than half a turn in one block goes the other way round.
#[test]
fn a_block_that_turns_more_than_half_a_turn_is_refused() {
    let start = "G53 G0 C-100\nG43.4\nG0 X800 Y700 Z200 A30 C-100\n";
    let plan = |body: &str| plan_on("ac-head", &format!("{start}{body}\nM2"));
    let error = plan("G0 C100").unwrap_err();
    assert!(
        matches!(error, PathError::Turned { place: SourcePosition { line: 4, .. }, axis: "C", programmed, reached, .. }
            if (programmed - 100.0).abs() < 1e-9 && (reached + 260.0).abs() < 1e-6),
        "{error}"
    );
    let paths = plan("G0 C0\nG0 C100").unwrap();
    assert!((end("ac-head", &paths)[5] - 100.0).abs() < 1e-6);
}

/// The tool would continue turning evenly, but no axis can follow from one end of its turn to the other.
#[test]
fn an_axis_that_would_jump_is_named() {
    let error = crate::path::tests::plan("G0 Z300\nG0 A-90\nG0 A95").unwrap_err();
    assert!(
        matches!(error, PathError::Jump { place: SourcePosition { line: 5, .. }, axis: "A", from, to } if from < -175.0 && to > 175.0),
        "{error}"
    );
    assert!(crate::path::tests::plan("G0 Z300\nG0 A-90\nG0 A0\nG0 A95").is_ok());
}

/// With A upright the pose leaves C free: it stays, and the planner knows. In axis space it turns.
#[test]
fn where_the_pose_leaves_an_axis_free_it_stays() {
    let start = "G43.4\nG0 X500 Y500 Z200 A0 C0\n";
    let plan = |body: &str| plan_on("ac-head", &format!("{start}{body}\nM2"));
    let paths = plan("G0 Z150 C90\nG0 Z100 A-30").unwrap();
    let seen = end("ac-head", &paths);
    assert!((seen[3] + 30.0).abs() < 1e-6 && seen[5].abs() < 1e-6, "{seen:?}");
    let paths = plan("G53 G0 C90\nG0 X500 Y500 Z100 A-30").unwrap();
    let seen = end("ac-head", &paths);
    assert!(
        (seen[3] + 30.0).abs() < 1e-6 && (seen[5] - 90.0).abs() < 1e-6,
        "{seen:?}"
    );
    // Tilting towards where C does not stand needs an endless turn there.
    let error = plan("G0 Z100 A-30 C90").unwrap_err();
    assert!(
        matches!(
            error,
            PathError::Kinematics {
                place: SourcePosition { line: 3, .. },
                ..
            }
        ),
        "{error}"
    );
}

/// Named axes go straight in axis space, the others stay, and the program continues from there.
#[test]
fn g53_moves_the_axes_named_and_the_tip_goes_on_from_there() {
    let body = "G43.4\nG0 X30 Y20 Z150 A5 B10 C20\nG53 G0 Z500 C-100\nG0 X30 Y20 Z160\nM2";
    let paths = plan_on("wire-arc", body).unwrap();
    assert_eq!(paths[1].space, PathSpace::Axes);
    let seen = followed("wire-arc", &paths, 0.5);
    let of_path = |index: usize| seen.iter().filter(move |at| at.0 == index).map(|at| at.2);
    let (start, stop) = (of_path(1).next().unwrap(), of_path(1).next_back().unwrap());
    for axes in of_path(1) {
        let part = (axes[2] - start[2]) / (500.0 - start[2]);
        assert!((axes[5] - (20.0 - 120.0 * part)).abs() < 1e-9);
        for i in [0, 1, 3, 4] {
            assert!((axes[i] - start[i]).abs() < 1e-9);
        }
    }
    assert!((stop[2] - 500.0).abs() < 1e-9);
    // The next block begins where the axes are, and keeps their angles.
    let last = seen.last().unwrap().2;
    let tip = planner_of("wire-arc").tip(&last);
    for (seen, wanted) in tip.position_mm.iter().zip([30.0, 20.0, 160.0]) {
        assert!((seen - wanted).abs() < 1e-6);
    }
    assert!(
        (last[3] - 5.0).abs() < 1e-6 && (last[5] + 100.0).abs() < 1e-6,
        "{last:?}"
    );
    let error = plan_on("wire-arc", "G53 G0 Z601\nM2").unwrap_err();
    assert!(
        matches!(
            error,
            PathError::Travel {
                place: SourcePosition { line: 1, .. },
                axis: "Z",
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn a_dwell_stands_before_its_path() {
    let paths = pipe("G4 P2.5\nG53 G0 X100\nF300\nG1 Z110\nG4 P1\nG1 Z120").unwrap();
    let dwells: Vec<f64> = paths.iter().map(|path| path.dwell_before_s).collect();
    assert_eq!(dwells, [0.0, 0.0, 2.5, 0.0, 1.0]);
}

#[test]
fn every_machine_parks_from_where_a_program_left_it() {
    let names = [
        "dual-beam-gantry",
        "pipe-welder",
        "ac-head",
        "wire-arc",
        "stir-gantry",
    ];
    for name in names {
        let planner = planner_of(name);
        let park = planner.planning.park_axes();
        let first = planner.planning.park_first[0] as usize;
        let from = std::array::from_fn(|i| if planner.fitted[i] { park[i] - 3.0 } else { 0.0 });
        let paths = planner.park(&from).unwrap();
        let ends: Vec<_> = paths
            .iter()
            .map(|path| path.path().at(path.length_mm()).unwrap().axes().position)
            .collect();
        assert!(
            (ends[0][first] / AXIS_UNIT[first] - park[first]).abs() < 1e-9,
            "{name}"
        );
        for i in 0..AXES {
            assert!((ends[1][i] / AXIS_UNIT[i] - park[i]).abs() < 1e-9, "{name}");
        }
    }
}

/// From one side of the vertical to the other while C turns on: about one axis the tool would pass beside the pole, and
/// C would come to the other side.
#[test]
fn a_straight_move_of_a_round_tool_passes_its_pole() {
    let text = "G53 G0 Z600\nG43.4\nG0 X800 Y700 Z200 A-3 C87\nG0 Z205 A4 C80\nM2";
    let paths = plan_on("ac-head", text).unwrap();
    let steps = followed("ac-head", &paths[2..], 0.05);
    for pair in steps.windows(2) {
        assert!((pair[1].2[5] - pair[0].2[5]).abs() < 0.1, "{:?}", pair[1].2);
    }
    let end = steps.last().unwrap().2;
    assert!(
        (end[3] - 4.0).abs() < 1e-6 && (end[5] - 80.0).abs() < 1e-6,
        "{end:?}"
    );
}
