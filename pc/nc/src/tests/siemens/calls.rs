//! Subprograms of Siemens programs.

use super::{wrong, xs};
use crate::tests::{HEADER, run};
use crate::{FeedRate, Options, Setup, interpret};
use std::sync::Arc;

/// X of all motions of a program with subprograms behind its end.
fn with(body: &str, subprograms: &str) -> Vec<f64> {
    let program = run(&format!("{body}\nM30\n{subprograms}\n")).unwrap_or_else(|error| panic!("{error}"));
    let targets = program.paths[2..].iter().flat_map(|path| &path.targets);
    targets.filter_map(|target| target.words.axes[0]).collect()
}

#[test]
fn subprograms_are_called_by_name_and_by_number() {
    assert_eq!(with("CONTOUR1\nG0 X9", "PROC CONTOUR1\nG0 X1\nRET"), [1.0, 9.0]);
    assert_eq!(
        with(
            "R1=0\nL123 P2\nN30 L123 P=R1\nG0 X9",
            "%_N_L123_SPF\n;$PATH=/_N_SPF_DIR\nR1=R1+1\nG0 X=R1\nM17"
        ),
        [1.0, 2.0, 3.0, 4.0, 9.0]
    );
    assert_eq!(
        with(
            "L140(2,7) P2\nG0 X9",
            "PROC L140(REAL FIRST, REAL SECOND)\nG0 X=FIRST\nX=SECOND\nRET"
        ),
        [2.0, 7.0, 2.0, 7.0, 9.0]
    );
    assert!(wrong("L140(2)").contains("L140"));
    // Two calls inside each other, each with its own variables; R parameters are those of all.
    let inner = "PROC OUTER(REAL DEPTH, INT COUNT=2)\nDEF REAL HERE=DEPTH\nINNER(DEPTH+1)\nG0 X=HERE+COUNT\nRET\nPROC INNER(REAL DEPTH)\nG0 X=DEPTH\nRET";
    assert_eq!(with("OUTER(10)\nOUTER(20,7)", inner), [11.0, 12.0, 21.0, 27.0]);
    assert_eq!(
        with(
            "DEF REAL DEPTH=5\nEXTERN SUB(REAL)\nSUB(1.5) P2\nG0 X=DEPTH",
            "PROC SUB(REAL DEPTH) DISPLOF\nG0 X=DEPTH\nDEPTH=9\nX=DEPTH\nM17"
        ),
        [1.5, 9.0, 1.5, 9.0, 5.0]
    );
}

#[test]
fn the_end_of_a_program_ends_a_subprogram_that_calls_return_from() {
    assert_eq!(
        with("SUB1\nG0 X9", "%_N_SUB1_MPF\nG0 X1\nM30\n%_N_OTHER_SPF\nG0 X2"),
        [1.0, 9.0]
    );
    assert_eq!(
        with("SUB1\nG0 X9", "%_N_SUB1_SPF\nG0 X1\n%_N_OTHER_SPF\nG0 X2\nM17"),
        [1.0, 9.0]
    );
    assert_eq!(
        with("SUB1\nG0 X9", "PROC SUB1\nIF 1==1\nG0 X1\nRET\nENDIF\nG0 X2"),
        [1.0, 9.0]
    );
    assert_eq!(xs("G0 X1\nM17\n; nothing\n%\n"), [1.0]);
    assert!(
        wrong("G0 X1\nM17\nG0 X2").contains("M17: it ends the program (Siemens), and blocks stand behind it")
    );
    assert_eq!(xs("G0 X1\nRET\nG0 X2"), [1.0]);
    // Labels are those of the program that jumps.
    assert_eq!(
        with(
            "SUB1\nGOTOF END\nG0 X8\nEND: G0 X9",
            "PROC SUB1\nGOTOF END\nG0 X2\nEND: G0 X3\nRET"
        ),
        [3.0, 9.0]
    );
}

#[test]
fn subprograms_may_be_in_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("FAR_SUB.SPF", "PROC FAR_SUB(REAL AT)\nG0 X=AT\nM17\n");
    write("plain.mpf", "G0 X2\nM30\n");
    write("BAD.SPF", "G0 X\n");
    let setup = Setup {
        folders: vec![folder.path().to_owned()],
        ..Setup::default()
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    let read = |body: &str| interpret(&format!("{HEADER}{body}\nM30\n"), options.clone());
    let program = read("far_sub(4)\nPLAIN\nG0 X5").unwrap();
    assert_eq!(program.paths.len(), 5);
    assert!(
        read("BAD")
            .unwrap_err()
            .to_string()
            .contains("in BAD.SPF: X needs a number")
    );
    assert!(
        read("FAR_SUB(1,2)")
            .unwrap_err()
            .to_string()
            .contains("the subprogram takes 1 arguments")
    );
    assert!(
        read("PLAIN(1)")
            .unwrap_err()
            .to_string()
            .contains("the subprogram takes 0 arguments")
    );
}

#[test]
fn what_is_no_call_is_told() {
    assert!(wrong("NOTHERE").contains("NOTHERE is not understood: there is no such word, and no subprogram"));
    assert!(wrong("SUB1\nM30\nPROC SUB1\nSUB1\nRET").contains("more than 32 subroutines inside each other"));
    for body in [
        "G0 X1\nPROC SUB1\nG0 X2",
        "SUB1\nM30\nPROC SUB1\nG0 X1\nPROC SUB2\nG0 X2",
    ] {
        assert!(
            wrong(body).contains("another program begins here"),
            "{}",
            wrong(body)
        );
    }
    assert!(wrong("SUB1(\"text\")").contains("this is a text"));
    assert!(wrong("CALL \"NAME\"").contains("CALL"));
    assert!(
        wrong("AGAIN: G0 X1\nREPEAT PART P1\nM30\nPART: RET\nENDLABEL:").contains("RET: it stands in a part")
    );
}

#[test]
fn a_tape_mark_may_follow_the_header_of_an_archive() {
    let text = "%_N_PART_MPF\n%\nG0 X1 Y0 Z0\nM30\n%\n";
    let program = interpret(text, Options::default()).unwrap();
    assert_eq!(program.paths.len(), 1);
    let text = "%_N_PART_MPF\nG0 X1 Y0 Z0\n%\nwhat follows is not read";
    assert_eq!(interpret(text, Options::default()).unwrap().paths.len(), 1);
}

#[test]
fn a_subprogram_with_save_leaves_codes_and_frame_as_they_were() {
    let inner = |save: &str| format!("PROC SUB1 {save}\nG1 G91 G55 X2 F100\nTRANS X50\nM17");
    assert_eq!(
        with("TRANS X10\nG0 X1\nSUB1\nX1\nG0 X2", &inner("SAVE")),
        [11.0, 13.0, 11.0, 12.0]
    );
    assert_eq!(
        with("TRANS X10\nG0 X1\nSUB1\nX1\nG0 X2", &inner("")),
        [11.0, 13.0, 14.0, 16.0]
    );
    // At each of its ends, and behind what M70 saved in it.
    let twice = "PROC SUB1 SAVE DISPLOF\nM70\nG0 G91 X2\nM72\nIF 1==1\nG91\nRET\nENDIF\nM17";
    assert_eq!(with("G0 X1\nSUB1 P2\nG0 X9", twice), [1.0, 3.0, 5.0, 9.0]);
    // F is no G code, and is kept.
    let program = run("G1 X1 F500\nSUB1\nX7\nM30\nPROC SUB1 SAVE\nG0 X2 F100\nRET").unwrap();
    let last = program.paths.last().unwrap().targets.last().unwrap();
    assert_eq!(
        (last.words.axes[0], last.feed),
        (Some(7.0), Some(FeedRate::PerMinute(100.0)))
    );
}
