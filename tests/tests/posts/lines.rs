//! What becomes of few commands, line by line.

use crate::stored::{python_is_there, run_objects};

/// Arguments, commands, and lines between the first and the last of the program.
const CASES: [(&str, &str, &[&str]); 12] = [
    // No minus before zero; a feed alone holds for what follows; commands without words do nothing.
    (
        "--precision=3",
        r#"["G0", {"X": -0.0001, "F": 50.0}], ["G0", {}], ["G1", {"F": 2.0}], ["G1", {"X": 1.0}]"#,
        &["G0 X0.000", "F120.000", "G1 X1.000"],
    ),
    // After another coordinate system nothing holds: the place is another one.
    (
        "--modal",
        r#"["G54", {}], ["G0", {"X": 1.0}], ["G55", {}], ["G0", {"X": 1.0}], ["G0", {"X": 1.0}], ["G0", {"Y": 1.0}]"#,
        &["G54", "G0 X1.0000", "G55", "G0 X1.0000", "Y1.0000"],
    ),
    // Nor is it known where an arc begins.
    (
        "",
        r#"["G0", {"X": 1.0, "Y": 0.0}], ["G55", {}], ["G3", {"X": 1.0, "Y": 0.00001, "I": -1.0, "J": 0.0, "F": 1.0}]"#,
        &[
            "G0 X1.0000 Y0.0000",
            "G55",
            "G3 X1.0000 Y0.0000 I-1.0000 J0.0000 F60.000",
        ],
    ),
    // What an arc does not say of the plane is as at its start.
    (
        "",
        r#"["G0", {"X": 1.0, "Y": 0.0}], ["G2", {"X": -1.0, "I": -1.0, "F": 1.0}]"#,
        &[
            "G0 X1.0000 Y0.0000",
            "G2 X-1.0000 Y0.0000 I-1.0000 J0.0000 F60.000",
        ],
    ),
    // After a cycle Z is not known, as it is not the bottom of the hole.
    (
        "",
        r#"["G81", {"X": 1.0, "Y": 1.0, "Z": -1.0, "R": 3.0, "F": 1.0}], ["G18", {}],
           ["G2", {"X": 1.00001, "Z": -1.0, "I": 1.0, "K": 0.0}]"#,
        &[
            "G81 X1.0000 Y1.0000 Z-1.0000 R3.0000 F60.000",
            "G80",
            "G18",
            "G2 X1.0000 Z-1.0000 I1.0000 K0.0000",
        ],
    ),
    // A run of cycles ends before what follows, and says all of its words.
    (
        "--modal",
        r#"["G0", {"X": 1.0, "Y": 1.0, "Z": 3.0}],
           ["G81", {"X": 1.0, "Y": 1.0, "Z": -1.0, "R": 3.0, "F": 1.0}],
           ["G81", {"X": 1.0, "Y": 2.0, "Z": -1.0, "R": 3.0, "F": 1.0}], ["G0", {"Z": 3.0}]"#,
        &[
            "G0 X1.0000 Y1.0000 Z3.0000",
            "G81 X1.0000 Y1.0000 Z-1.0000 R3.0000 F60.000",
            "G81 X1.0000 Y2.0000 Z-1.0000 R3.0000 F60.000",
            "G80",
            "G0 Z3.0000",
        ],
    ),
    // A spindle stops at the end, if it turns.
    (
        "",
        r#"["M3", {"S": 90.0}], ["G0", {"X": 1.0}]"#,
        &["M3 S90.0", "G0 X1.0000", "M5"],
    ),
    (
        "",
        r#"["M3", {"S": 90.0}], ["G0", {"X": 1.0}], ["M5", {}]"#,
        &["M3 S90.0", "G0 X1.0000", "M5"],
    ),
    // A beam goes off at rest before another tool and at the end, unless a rapid has closed it.
    (
        "--beam",
        r#"["M3", {"S": 90.0}], ["G1", {"X": 1.0, "F": 1.0}], ["M6", {"T": 2.0}], ["M3", {"S": 90.0}],
           ["G1", {"X": 2.0}]"#,
        &[
            "M67 E0 Q90.0",
            "M62 P0",
            "G1 X1.0000 F60.000",
            "M65 P0",
            "T2 M6",
            "M62 P0",
            "G1 X2.0000",
            "M65 P0",
        ],
    ),
    // After M5 it goes off with the next feed, or at rest before a dwell. A dwell alone leaves it as it is.
    (
        "--beam",
        r#"["M3", {"S": 90.0}], ["G1", {"X": 1.0, "F": 1.0}], ["G4", {"P": 2.0}], ["M5", {}], ["G4", {"P": 1.0}], ["M3", {"S": 90.0}],
           ["G1", {"X": 2.0}], ["M5", {}], ["G1", {"X": 3.0}]"#,
        &[
            "M67 E0 Q90.0",
            "M62 P0",
            "G1 X1.0000 F60.000",
            "G4 P2.0000",
            "M65 P0",
            "G4 P1.0000",
            "M62 P0",
            "G1 X2.0000",
            "M63 P0",
            "G1 X3.0000",
        ],
    ),
    // And at rest before a stop.
    (
        "--beam",
        r#"["M3", {"S": 90.0}], ["G1", {"X": 1.0, "F": 1.0}], ["M5", {}], ["M0", {}], ["G1", {"X": 3.0}]"#,
        &[
            "M67 E0 Q90.0",
            "M62 P0",
            "G1 X1.0000 F60.000",
            "M65 P0",
            "M0",
            "G1 X3.0000",
        ],
    ),
    // A feed is along Z only where X is known.
    (
        "--beam --closed-plunge",
        r#"["M3", {"S": 90.0}], ["G0", {"Z": 1.0}], ["G1", {"Z": 0.0, "F": 1.0}], ["G1", {"X": 0.0, "Z": 0.0}],
           ["G0", {"Z": 1.0}], ["M5", {}]"#,
        &[
            "G0 Z1.0000",
            "G1 Z0.0000 F60.000",
            "M67 E0 Q90.0",
            "M62 P0",
            "G1 X0.0000 Z0.0000",
            "G0 Z1.0000",
        ],
    ),
];

#[test]
fn few_commands_become_these_lines() {
    if !python_is_there() {
        return;
    }
    for (arguments, commands, expected) in CASES {
        let object = format!(r#"{{"label": "Few", "commands": [{commands}]}}"#);
        assert_eq!(lines(&object, arguments), expected, "{commands}");
    }
}

#[test]
fn coolant_is_on_for_its_operation_and_names_keep_their_letters() {
    if !python_is_there() {
        return;
    }
    let object = |label: &str, more: &str| {
        format!(r#"{{"label": "{label}", {more} "commands": [["(a (b)", {{}}], ["G0", {{"X": 1.0}}]]}}"#)
    };
    let dressed = object("Höhe (1)", r#""base": {"label": "Dressed", "coolant": "Mist"},"#);
    let dry = object("Dry\\n%", r#""coolant": "None","#);
    let output = run_objects(&format!("{dressed}, {dry}"), "");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let expected = "(from FreeCAD, for Seamwright)\nG21 G90 G17 G94 G64 P0.05\n(operation Höhe [1])\nM7\n(a [b)\nG0 X1.0000\n\
                    M9\n(operation Dry %)\n(a [b)\nG0 X1.0000\nM2\n";
    assert_eq!(text, expected);
    assert!(nc::interpret(&text, nc::Options::default()).is_ok());
}

/// Lines between the first and the last of the program of an object.
fn lines(object: &str, arguments: &str) -> Vec<String> {
    let output = run_objects(object, &format!("--no-comments {arguments}"));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    assert_eq!(
        lines.pop().as_deref(),
        Some("M2"),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(lines.remove(0), "G21 G90 G17 G94 G64 P0.05");
    lines
}
