//! What programs mean, and what is refused where.

mod compensation;
mod coordinates;
mod cycles;
mod dialects;
mod direction;
mod explain;
mod flow;
mod laser;
mod macros;
mod mirror;
mod modes;
mod nurbs;
mod outputs;
mod probing;
mod reading;
mod siemens;
mod tape_marks;
mod tapping;
mod tilt;
mod tool_length;
mod waits;

use super::reading::interpret;
use super::*;
use shared::geometry::Turn;

pub(crate) const HEADER: &str = "G21 G17 G90 G94 G40 G54 G64\nG43.4\nG0 X0 Y0 Z50 A0 B0 C0\nG0 Z0\n";

fn run(body: &str) -> Result<Program, NcError> {
    interpret(&format!("{HEADER}{body}"), Options::default())
}

/// Problem and line within the body.
fn problem(body: &str) -> (Problem, i64) {
    let error = run(body).unwrap_err();
    (
        error.problem,
        i64::from(error.place.line) - HEADER.lines().count() as i64,
    )
}

#[test]
fn g1_blocks_make_one_path_and_each_g0_its_own() {
    let program = run("F6000\nG1 X10\nX20 Y1\nx30 y3 v1=0.5 a1\nG0 Z50\nM2").unwrap();
    let shape: Vec<_> = program
        .paths
        .iter()
        .map(|p| (p.motion, p.targets.len()))
        .collect();
    let (feed, rapid) = (Motion::Feed, Motion::Rapid);
    assert_eq!(shape, [(rapid, 1), (rapid, 1), (feed, 3), (rapid, 1)]);
    let end = &program.paths[2].targets[2];
    assert_eq!(
        (&end.way, end.place),
        (&Way::Line, SourcePosition { line: 8, column: 1 })
    );
    assert_eq!(
        end.words.axes,
        [Some(30.0), Some(3.0), None, Some(1.0), None, None]
    );
    assert_eq!(end.words.extension, [Some(0.5), None]);
    assert_eq!(end.feed, Some(FeedRate::PerMinute(6000.0)));
    assert_eq!(program.paths[3].targets[0].feed, None);
}

#[test]
fn block_delete_is_the_operators_choice() {
    let body = "F600\nG1 X10\n/X20\nM2";
    assert_eq!(run(body).unwrap().paths[2].targets.len(), 2);
    let text = format!("{HEADER}{body}");
    let options = Options {
        block_delete: true,
        ..Options::default()
    };
    let program = interpret(&text, options).unwrap();
    assert_eq!(program.paths[2].targets.len(), 1);
}

#[test]
fn what_cannot_be_done_is_named_with_its_line() {
    assert_eq!(problem("\nG1 X10\nM2"), (Problem::NoFeed("G1"), 2));
    assert_eq!(problem("G0 X5 P1\nM2"), (Problem::Orphan("P".into()), 1));
    assert_eq!(problem("M62 P0 Q1\nM2"), (Problem::Orphan("Q".into()), 1));
    let (code, word) = ("M67", "Q");
    assert_eq!(problem("M67 E0\nM2"), (Problem::Missing { code, word }, 1));
    assert!(matches!(
        problem("M62 P11\nM2"),
        (Problem::Value { value: 11.0, .. }, 1)
    ));
    assert!(matches!(problem("F-5\nM2"), (Problem::Value { .. }, 1)));
    let bare = |text: &str| interpret(text, Options::default()).unwrap_err().problem;
    assert_eq!(bare("G43.4\nF9\nX5\nM2"), Problem::NoMotion);
}

#[test]
fn a_block_that_says_nothing_new_is_no_motion() {
    let program = run("F600\nG1 X10\nX10 Y0\nG0 X10\nZ0\nM2").unwrap();
    assert_eq!(program.paths.len(), 3);
    // After G53 the program no longer says where the tip is.
    let program = run("G53 G0 Z900\nG0 Z0\nM2").unwrap();
    assert_eq!(program.paths.len(), 4);
}

#[test]
fn arcs_have_a_centre_or_a_radius() {
    let program = run("F600\nG2 X10 Y10 I10\nG3 I-5 J0.5\nX20 R-8\nG1 X30\nM2").unwrap();
    let [path] = &program.paths[2..] else {
        panic!("one path")
    };
    let ways: Vec<_> = path.targets.iter().map(|t| t.way.clone()).collect();
    let arc = |turn, form| {
        Way::Arc(ArcWay {
            about: Plane::Xy.normal(),
            turn,
            form,
            more_turns: 0,
        })
    };
    let counter = Turn::CounterClockwise;
    let expected = [
        arc(Turn::Clockwise, ArcForm::Centre([10.0, 0.0, 0.0])),
        arc(counter, ArcForm::Centre([-5.0, 0.5, 0.0])),
        arc(counter, ArcForm::Radius(-8.0)),
        Way::Line,
    ];
    assert_eq!(ways, expected);
    assert_eq!(problem("F600\nG2 X10 I5 R5\nM2"), (Problem::CentreAndRadius, 2));
    let (code, word) = ("G3", "a centre (I J K) or R");
    assert_eq!(problem("F600\nG3 X10\nM2"), (Problem::Missing { code, word }, 2));
    assert!(matches!(
        problem("F600\nG2 X5 R0\nM2"),
        (Problem::Value { .. }, 2)
    ));
    assert_eq!(problem("F600\nG1 X5 I2\nM2"), (Problem::Orphan("I".into()), 2));
    assert_eq!(problem("G2 X5 I2\nM2"), (Problem::NoFeed("G2"), 1));
}

#[test]
fn g53_moves_axes_once_and_needs_g0() {
    let program = run("G53 G0 Z900 C-450\nX5\nM2").unwrap();
    let axes = &program.paths[2];
    assert_eq!(axes.targets[0].way, Way::Axes);
    let expected = [None, None, Some(900.0), None, None, Some(-450.0)];
    assert_eq!(axes.targets[0].words.axes, expected);
    assert_eq!(program.paths[3].targets[0].way, Way::Line);
    // It needs no G43.4, and says nothing of the tip.
    let bare = |text: &str| interpret(text, Options::default());
    assert!(bare("G53 G0 Z5\nM2").is_ok());
    let error = bare("G53 G0 X0 Y0 Z5\nG91\nG0 X1\nM2").unwrap_err();
    assert_eq!(error.problem, Problem::UnknownPosition);

    assert_eq!(problem("F5\nG1 G53 X5\nM2"), (Problem::AxesNeedRapid, 2));
    assert_eq!(problem("G53 G0 V1=2\nM2"), (Problem::Orphan("V1=".into()), 1));
    assert_eq!(problem("M62 P0\nG53 G0 Z5\nM2"), (Problem::OnInAxes("M62"), 1));
    assert!(run("M63 P0\nG53 G0 Z5\nM2").is_ok());
}

#[test]
fn a_dwell_ends_a_path_and_delays_the_next() {
    let program = run("F600\nG1 X10\nG4 P1.5\nG4 P0.5\nX20\nX30\nM2").unwrap();
    let shape: Vec<_> = program.paths[2..]
        .iter()
        .map(|p| (p.targets.len(), p.dwell_before_s))
        .collect();
    assert_eq!(shape, [(1, 0.0), (2, 2.0)]);
    let (code, word) = ("G4", "P");
    assert_eq!(problem("G4\nM2"), (Problem::Missing { code, word }, 1));
    assert!(matches!(
        problem("G4 P-1\nM2"),
        (Problem::Value { value: -1.0, .. }, 1)
    ));
    let program = run("G4 P1\nM2").unwrap();
    assert_eq!(program.paths[2].dwell_before_s, 1.0);
    let (first, second) = ("G4", "M62");
    assert_eq!(
        problem("G4 M62 P1\nM2"),
        (Problem::ModalGroup { first, second }, 1)
    );
    let (first, second) = ("G4", "G53");
    assert_eq!(
        problem("G4 G53 P1\nM2"),
        (Problem::ModalGroup { first, second }, 1)
    );
}

#[test]
fn a_message_reads_as_a_sentence_with_its_place() {
    assert_eq!(
        run("G1 X10 F600\nG5.5 X5\nM2").unwrap_err().to_string(),
        "line 6, column 1: G5.5 is not understood"
    );
}
