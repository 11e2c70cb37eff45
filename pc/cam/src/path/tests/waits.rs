//! Waits of a program: before which paths they are, on which machine, and where a program is started at a line.

use super::*;

/// Lines of the waits before each path.
fn lines(paths: &[PlannedPath]) -> Vec<Vec<u32>> {
    let of_path = |path: &PlannedPath| path.waits_before.iter().map(|wait| wait.place.line).collect();
    paths.iter().map(of_path).collect()
}

#[test]
fn a_wait_is_before_the_path_that_follows_it_in_the_program() {
    let text = "M0\nG0 X450\nM0\nF600\nM66 P0 L3 Q1\nG1 X500\nT1 M6\nT2 M6\nX520\nG2 X560 I20\nM0\nM2";
    let paths = plan_on("wire-arc", &format!("G0 X400 Y0 Z0\n{text}")).unwrap();
    assert_eq!(
        lines(&paths),
        [vec![], vec![2], vec![4, 6], vec![], vec![9], vec![12]]
    );
    // Another tool is no error any more, and the first one is told.
    let program = interpret("T3 M6\nG0 X1\nT3 M6\nG0 X2\nT4 M6\nG0 X3\nM2", Options::default()).unwrap();
    assert_eq!(
        planner_of("wire-arc").notices(&program),
        ["line 1, column 4: tool 3 must be in the machine"]
    );
}

#[test]
fn an_input_that_the_machine_does_not_have_is_refused() {
    let wait = |machine: &str, p: u32| plan_on(machine, &format!("G0 X500 Y0\nM66 P{p} L3 Q1\nM2"));
    assert!(wait("wire-arc", 1).is_ok());
    assert_eq!(
        wait("wire-arc", 3).unwrap_err().to_string(),
        "line 2, column 1: wire-arc has no input 4"
    );
    assert_eq!(planner_of("wire-arc").input_name(1), Some("gas_flow"));
}

#[test]
fn a_weld_of_weld_data_has_no_wait_inside() {
    let text = "G0 X500 Y0\nWELDON=root\nM0\nG1 X510 F600\nWELDOFF\nM2";
    let program = interpret(text, Options::default()).unwrap();
    let mut planner = planner_of("wire-arc");
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../programs/butt-joint.ngc");
    planner.welding = Arc::new(WeldData::beside(std::path::Path::new(folder)).unwrap());
    let park = planner.planning.park_axes();
    let error = planner.program(&program, &park, None).unwrap_err();
    assert!(matches!(error, PathError::Weld(WeldError::On { .. })), "{error}");
    // Before it there may be one.
    let text = "G0 X500 Y0\nM0\nWELDON=root\nG1 X580 F600\nWELDOFF\nM0\nM2";
    let program = interpret(text, Options::default()).unwrap();
    let paths = planner.program(&program, &park, None).unwrap();
    let waits: Vec<u32> = lines(&paths).concat();
    assert_eq!(waits, [2, 6]);
}

#[test]
fn a_program_that_is_started_at_a_line_waits_from_there_on() {
    let text = "M0\nG0 X500 Y0\nM0\nG1 X510 F600\nX520\nM0\nX530\nM2";
    let program = interpret(text, Options::default()).unwrap();
    let planner = planner_of("wire-arc");
    let park = planner.planning.park_axes();
    for (line, wanted) in [
        (1, vec![1, 3, 6]),
        (2, vec![3, 6]),
        (3, vec![3, 6]),
        (4, vec![6]),
        (5, vec![6]),
        (6, vec![6]),
        (7, vec![]),
    ] {
        let paths = planner.program(&program, &park, None).unwrap();
        let started = planner.from_line(&program, paths, line, &park).unwrap();
        assert_eq!(lines(&started).concat(), wanted, "from line {line}");
    }
}
