//! Canned cycles, motion by motion.

use super::*;

/// Rapid or feed, and X and Z where they are said.
fn motions(body: &str) -> Vec<(bool, Option<f64>, Option<f64>)> {
    let program = run(body).unwrap();
    let targets = program.paths[2..].iter().flat_map(|path| &path.targets);
    targets
        .map(|target| (target.feed.is_some(), target.words.axes[0], target.words.axes[2]))
        .collect()
}

fn down(z: f64) -> (bool, Option<f64>, Option<f64>) {
    (true, None, Some(z))
}

fn up(z: f64) -> (bool, Option<f64>, Option<f64>) {
    (false, None, Some(z))
}

fn over(x: f64, z: f64) -> (bool, Option<f64>, Option<f64>) {
    (false, Some(x), Some(z))
}

#[test]
fn holes_are_drilled_one_after_the_other_from_the_level_before() {
    let expected = [up(10.0), over(5.0, 10.0), up(2.0), down(-3.0), up(10.0)];
    assert_eq!(motions("F100\nG0 Z10\nG98 G81 X5 Z-3 R2\nM2"), expected);
    let expected = [
        up(10.0),
        over(5.0, 10.0),
        up(2.0),
        down(-3.0),
        up(2.0),
        over(6.0, 2.0),
        down(-3.0),
        up(2.0),
    ];
    assert_eq!(motions("F100\nG0 Z10\nG99 G81 X5 Z-3 R2\nX6\nM2"), expected);
    // From below, first up; G91 steps from hole to hole.
    let expected = [
        up(2.0),
        over(4.0, 2.0),
        down(-1.0),
        up(2.0),
        over(8.0, 2.0),
        down(-1.0),
        up(2.0),
    ];
    assert_eq!(motions("F100\nG91 G81 X4 R2 Z-3 L2\nM2"), expected);
}

#[test]
fn a_run_that_goes_on_in_another_plane_begins_there() {
    // Y of the tip is 30 before the first hole along Y, and again after it.
    let program = run("F100\nG0 Y30 Z4\nG98 G81 X5 Z-3 R2\nG18 X6 Z1 Y-3 R2\nM2").unwrap();
    let targets = program.paths[3..].iter().flat_map(|path| &path.targets);
    let along_y: Vec<_> = targets.filter_map(|target| target.words.axes[1]).collect();
    assert_eq!(along_y, [30.0, 30.0, 2.0, -3.0, 30.0]);
}

#[test]
fn pecks_go_down_by_q() {
    let expected = [
        over(1.0, 0.0),
        down(-2.0),
        up(0.0),
        up(-1.746),
        down(-3.0),
        up(0.0),
    ];
    assert_eq!(motions("F100\nG83 X1 R0 Z-3 Q2\nM2"), expected);
    let expected = [over(1.0, 0.0), down(-2.0), up(-1.746), down(-3.0), up(0.0)];
    assert_eq!(motions("F100\nG73 X1 R0 Z-3 Q2\nM2"), expected);
    let problem = |body: &str| super::problem(body).0;
    assert!(matches!(
        problem("F100\nG83 X1 R0 Z-3\nM2"),
        Problem::Missing {
            code: "G83",
            word: "Q"
        }
    ));
    assert!(matches!(
        problem("F100\nG83 X1 R0 Z-3 Q1e\nM2"),
        Problem::NoNumber(_)
    ));
    assert!(matches!(
        problem("F100\nG83 X1 R0 Z-3 Q.00001\nM2"),
        Problem::Impossible { .. }
    ));
    assert!(matches!(
        problem("F100\nG81 X1 R-4 Z-3\nM2"),
        Problem::Impossible { .. }
    ));
    assert!(matches!(
        problem("F100\nG81 X1 Z-3\nM2"),
        Problem::Missing {
            code: "G81",
            word: "R"
        }
    ));
}

#[test]
fn boring_feeds_back_or_stops_the_spindle() {
    assert_eq!(
        motions("F100\nG85 X1 R0 Z-3\nG80\nM2"),
        [over(1.0, 0.0), down(-3.0), down(0.0)]
    );
    let program = run("F100 S500 M3\nG86 X1 R0 Z-3 P1\nG0 Z5\nM2").unwrap();
    let events: Vec<_> = program
        .paths
        .iter()
        .flat_map(|path| &path.events)
        .map(|event| event.action)
        .collect();
    let expected = [
        ProgramAction::SpindleSpeed(500.0),
        ProgramAction::SpindleOn(Turn::Clockwise),
        ProgramAction::SpindleOff,
        ProgramAction::SpindleOn(Turn::Clockwise),
        ProgramAction::SpindleOff,
    ];
    assert_eq!(events, expected);
}

#[test]
fn g80_goes_back_to_the_motion_before_the_cycle_and_may_stand_beside_another() {
    // As the post-processors for Fanuc and Haas have it.
    let drilled = [up(10.0), over(5.0, 10.0), up(2.0), down(-3.0), up(10.0)];
    let back = motions("F100\nG0 Z10\nG98 G81 X5 Z-3 R2\nG80\nZ15\nM2");
    assert_eq!(back[..5], drilled);
    assert_eq!(back[5..], [up(15.0)]);
    let fed = motions("F100\nG1 Z10\nG98 G81 X5 Z-3 R2\nG80\nZ15\nM2");
    assert_eq!(fed[5..], [down(15.0)]);
    // A line that many programs begin with, and one that leaves a cycle.
    assert_eq!(motions("G0 G17 G40 G49 G80 G90\nZ5\nM2"), [up(5.0)]);
    let left = motions("F100\nG0 Z10\nG98 G81 X5 Z-3 R2\nG1 G80 Z15\nM2");
    assert_eq!(left[5..], [down(15.0)]);
    assert_eq!(
        motions("F100\nG0 Z10\nG98 G81 X5 Z-3 R2\nG80 Z15\nM2")[5..],
        [up(15.0)]
    );
    // Without a cycle there is nothing to go back to.
    let error = run("F100\nG1 Z10\nG80\nZ15\nM2").unwrap_err();
    assert!(
        error.to_string().contains("axis words without a motion"),
        "{error}"
    );
}

#[test]
fn cycles_without_r_begin_at_their_initial_level_where_the_machine_file_says_so() {
    let read = |r_at_initial_level, body: &str| {
        let setup = Setup {
            r_at_initial_level,
            ..Setup::default()
        };
        let options = Options {
            setup: setup.into(),
            ..Options::default()
        };
        interpret(&format!("{HEADER}G0 Z20\nF100\n{body}\nG80\nM2"), options)
    };
    let heights = |program: &Program| -> Vec<f64> {
        let targets = program.paths[3..].iter().flat_map(|path| &path.targets);
        targets.filter_map(|target| target.words.axes[2]).collect()
    };
    let (code, word) = ("G81", "R");
    let error = read(false, "G98 G81 X5 Z-3").unwrap_err();
    assert_eq!(error.problem, Problem::Missing { code, word });
    for body in ["G98 G81 X5 Z-3\nX9", "G91 G98 G81 X5 Z-23\nX4"] {
        let without = read(true, body).unwrap();
        let r = if body.starts_with("G91") { "R0" } else { "R20" };
        let with = read(false, &body.replace("X5", &format!("X5 {r}"))).unwrap();
        assert_eq!(without.paths.len(), with.paths.len(), "{body}");
        assert_eq!(heights(&without), heights(&with), "{body}");
        assert!(heights(&without).contains(&-3.0), "{body}");
        let told =
            "without R a cycle begins at the level where the first one began, as the machine file says";
        assert_eq!(
            without
                .notices
                .iter()
                .filter(|notice| notice.text == told)
                .count(),
            1
        );
    }
}
