//! Where a program begins and ends on its tape, and words of axes that only other machines have.

use super::*;

const MOVES: &str = "G21 G0 X5 Y0 Z0\n";

fn paths(text: &str) -> usize {
    interpret(text, Options::default()).unwrap().paths.len()
}

fn wrong(text: &str) -> String {
    interpret(text, Options::default()).unwrap_err().to_string()
}

#[test]
fn comments_may_stand_before_the_first_tape_mark() {
    for before in ["(a part)\n", "\n; a part\n(of two)\n", "// a part\n", ""] {
        assert_eq!(paths(&format!("{before} %\n{MOVES}M2\n")), 1, "{before}");
        assert_eq!(
            paths(&format!("{before}%12 (a part)\n{MOVES}%\nG0 X9\n")),
            1,
            "{before}"
        );
    }
    // Behind a block it is the end.
    assert_eq!(paths(&format!("{MOVES}%\nG0 X9\nM2\n")), 1);
}

#[test]
fn a_tape_mark_with_text_behind_it_does_not_end_a_program_unnoticed() {
    for mark in ["% LED ON", "%2", "%(the end) G0 X7", " %% relays"] {
        let text = format!("%\n{MOVES}{mark}\nG0 X9\nM2\n");
        if mark.starts_with("%(") {
            assert_eq!(paths(&text), 1, "{mark}");
        } else {
            assert!(
                wrong(&text).starts_with("line 3, column 1: '%' ends a program, and text"),
                "{mark}"
            );
        }
    }
    // The next program of an archive, as on Siemens controllers.
    assert_eq!(paths(&format!("%_N_A_MPF\n{MOVES}%_N_B_SPF\nG0 X9\nM17\n")), 1);
}

/// Paths and notices on a machine without A.
fn without_a(body: &str) -> Result<(usize, Vec<String>), String> {
    let mut setup = Setup::default();
    setup.fitted[3] = false;
    let options = Options {
        setup: setup.into(),
        ..Options::default()
    };
    let program = interpret(body, options).map_err(|error| error.to_string())?;
    let a = program.paths.iter().flat_map(|path| &path.targets);
    assert!(a.clone().all(|target| target.words.axes[3].is_none()));
    Ok((
        a.count(),
        program.notices.into_iter().map(|notice| notice.text).collect(),
    ))
}

#[test]
fn an_axis_that_the_machine_does_not_have_may_stay_at_0() {
    let told = "A0 changes nothing: the machine has no axis A".to_owned();
    for text in [
        "G21 G0 X5 Y0 Z0 A0\nG1 X6 A0. F100\nM2",
        "G21 G0 X5 Y0 Z0\nG91 G1 X1 A0 F100\nM2",
        "G21 G0 X5 Y0 Z0\nG2 X9 I2 A0 F100\nM2",
    ] {
        assert_eq!(without_a(text), Ok((2, vec![told.clone()])), "{text}");
    }
    // Alone it leads nowhere, and so does its way to the park position.
    assert_eq!(without_a("G21 G0 X5 Y0 Z0\nG0 A0\nG28 A0\nM2").unwrap().0, 1);
}

#[test]
fn an_axis_that_is_not_there_may_not_turn() {
    // The planner refuses it, with the words that the machine has.
    for text in [
        "G0 X5 A1\nM2",
        "G10 L2 P1 A30\nG0 X5 A0\nM2",
        "G92 A30\nG0 X5 A0\nM2",
    ] {
        let mut setup = Setup::default();
        setup.fitted[3] = false;
        let options = Options {
            setup: setup.into(),
            ..Options::default()
        };
        let program = interpret(text, options).unwrap();
        assert!(program.paths[0].targets[0].words.axes[3].is_some(), "{text}");
    }
}
