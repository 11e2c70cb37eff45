//! Jobs that the post-processor refuses: with the operation, the command and what to do, and without a program.

use crate::stored::{python_is_there, run_objects};
use std::process::Output;

/// Commands of an operation, arguments, and what the message says.
const REFUSED: [(&str, &str, &str); 16] = [
    (
        r#"["G38.2", {"Z": -5.0, "F": 1.0}]"#,
        "",
        "operation 'Bad', command 2 (G38.2 Z-5 F1): this command is not known",
    ),
    (
        r#"["G84", {"Z": -5.0}]"#,
        "",
        "(G84 Z-5): this command is not known",
    ),
    (
        r#"["G1", {"X": 1.0, "E": 2.0, "F": 1.0}]"#,
        "",
        "G1 takes no word E",
    ),
    (r#"["G1", {"X": 1.0}]"#, "", "there is no feed above 0"),
    (
        r#"["G1", {"X": 1.0, "F": 0.0}]"#,
        "",
        "set horizontal and vertical feed",
    ),
    (r#"["G1", {"X": NaN, "F": 1.0}]"#, "", "nan is not a number"),
    (r#"["G2", {"X": 1.0, "F": 1.0}]"#, "", "I and J are missing"),
    (r#"["M4", {"S": 100.0}]"#, "", "set the spindle direction"),
    (r#"["M3", {"S": 0.0}]"#, "--beam", "to the power in W"),
    (
        r#"["G81", {"X": 1.0, "Y": 1.0, "Z": -1.0, "R": 1.0, "F": 1.0}]"#,
        "--beam",
        "a beam does not drill",
    ),
    (r#"["G0", {"X": 1.0}]"#, "--beam", "the beam is never on"),
    (
        r#"["G0", {"X": 1.0}]"#,
        "--inches",
        "unrecognized arguments: --inches; known are",
    ),
    (
        r#"["G1", {"X": 1.0, "F": 0.000001}]"#,
        "",
        "there is no feed above 0",
    ),
    (
        r#"["G0", {"X": 1.0}]"#,
        "--closed-plunge",
        "--closed-plunge is for --beam",
    ),
    (r#"["G0", {"X": 1.0}]"#, "--origin=1,2", "three numbers X,Y,Z"),
    (r#"["G0", {"X": 1.0}]"#, "--tolerance=-1", "0 mm or more"),
];

#[test]
fn what_the_post_does_not_know_is_refused_with_its_place() {
    if !python_is_there() {
        return;
    }
    for (command, arguments, message) in REFUSED {
        let objects = format!(r#"{{"label": "Bad", "commands": [["G0", {{"Z": 9.0}}], {command}]}}"#);
        assert_refused(&objects, arguments, message);
    }
}

#[test]
fn a_job_without_active_motions_is_refused() {
    if !python_is_there() {
        return;
    }
    let off = r#"{"label": "Off", "active": false, "commands": [["G0", {"Z": 9.0}]]}"#;
    assert_refused(off, "", "no active operation moves the tool");
    assert_refused(r#"{"label": "Stock"}"#, "", "'Stock' has no path");
}

/// Checks that there is a message, and no program.
fn assert_refused(objects: &str, arguments: &str, message: &str) {
    let Output {
        status,
        stdout,
        stderr,
    } = run_objects(objects, arguments);
    let error = String::from_utf8_lossy(&stderr);
    assert_eq!(status.code(), Some(1), "{objects}: {error}");
    assert!(error.contains(message), "{objects}: {error}");
    assert!(!error.contains("Traceback") && stdout.is_empty(), "{error}");
}
