//! Lengths of tools: where the tip of the machine goes so that the end of the tool in use is where the program says.

use super::*;
use shared::io::AXES;
use std::sync::Arc;

/// A head whose tool leans from Z towards X by B; A turns it about itself when it is upright, and does nothing else.
#[derive(Debug)]
struct Head;

impl TipAndAxes for Head {
    fn tip(&self, axes: &[f64; AXES]) -> [f64; AXES] {
        *axes
    }

    fn axes(&self, tip: &[f64; AXES]) -> Option<[f64; AXES]> {
        Some(*tip)
    }

    fn direction(&self, [_, b, _]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = b.to_radians().sin_cos();
        [sin, 0.0, cos]
    }
}

fn tool(length_mm: f64) -> Tool {
    Tool {
        length_mm,
        diameter_mm: 8.0,
    }
}

fn read_with(tools: &[(u32, f64)], body: &str) -> Result<Program, NcError> {
    let setup = Setup {
        kinematics: Some(Arc::new(Head)),
        tools: tools
            .iter()
            .map(|(number, length)| (*number, tool(*length)))
            .collect(),
        ..Setup::default()
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    interpret(&format!("G0 X0 Y0 Z0 A0 B0 C0 F600\n{body}\nM2"), options)
}

/// Tools 2 and 3 are 10 mm and 4 mm longer than that of the machine.
fn read(body: &str) -> Result<Program, NcError> {
    read_with(&[(2, 10.0), (3, 4.0)], body)
}

/// X Y Z of the last motion, rounded.
fn last(body: &str) -> [Option<f64>; 3] {
    let program = read(body).unwrap();
    let target = program.paths.last().unwrap().targets.last().unwrap().clone();
    let round = |value: f64| (value * 1e6).round() / 1e6;
    [0, 1, 2].map(|axis| target.words.axes[axis].map(round))
}

fn wrong(body: &str) -> String {
    read(body).unwrap_err().to_string()
}

#[test]
fn upright_a_length_is_a_shift_of_z_and_moves_nothing_by_itself() {
    let z = |z: f64| [None, None, Some(z)];
    assert_eq!(last("G43 H2\nG0 Z5"), z(15.0));
    assert_eq!(last("T3 M6\nG43\nG0 Z5"), z(9.0));
    assert_eq!(last("G43 H2\nG43 H3\nG0 Z5\nG43 H0\nZ6"), z(6.0));
    assert_eq!(last("G43 H2\nG43.2 H3\nG0 Z5"), z(19.0));
    assert_eq!(last("G43.1 Z7\nG0 Z5"), z(12.0));
    assert_eq!(last("G20 G43.1 Z1\nG21 G0 Z5"), z(30.4));
    assert_eq!(last("G43 H2\nG0 Z5\nG49\nZ6"), z(6.0));
    // A step, and a place that parameters say, are of the end of the tool.
    assert_eq!(last("G43 H2\nG91 G0 Z5"), z(5.0));
    assert_eq!(last("G43 H2\nG0 Z[#5422+15]"), z(15.0));
    // The parameter is of the tool in the machine, whatever is in use, in mm as LinuxCNC has it in units of the machine.
    assert_eq!(last("T3 M6\nG43 H2\nG20\nG0 Z[#5403]"), z(4.0 * 25.4 + 10.0));
    assert_eq!(last("T3 M6\nG10 L1 P3 Z6\nG0 Z#5403"), z(6.0));
    // Machine coordinates are as ever.
    assert_eq!(last("G43 H2\nG53 G0 Z5"), z(5.0));
    assert_eq!(last("G43 H2\nG53 G0 Z5\nG91 G0 Z1"), z(6.0));
    assert_eq!(read("G43 H2").unwrap().paths.len(), 1);
}

#[test]
fn the_length_is_along_the_tool() {
    let leaning = last("G43 H2\nG0 X1 Y2 Z3 B90");
    assert_eq!(leaning, [Some(11.0), Some(2.0), Some(3.0)]);
    // What is not said goes too, as the end of the tool stays where it is.
    assert_eq!(last("G43 H2\nG0 B90"), [Some(10.0), None, Some(-10.0)]);
    assert_eq!(last("G0 B90\nG43 H2\nG1 X5"), [Some(15.0), None, None]);
    assert_eq!(last("G0 B90\nG43 H2\nG0 X5\nG49\nG1 X7"), [Some(7.0), None, None]);
    // Of an arc the centre goes along.
    let program = read("G0 B90\nG43 H2\nG2 X10 Y0 I5\nM2").unwrap();
    let arc = &program.paths.last().unwrap().targets[0];
    assert_eq!(
        (arc.words.axes[0], &arc.way),
        (Some(20.0), &program.paths.last().unwrap().targets[0].way)
    );
    let curve = read("G43 H2\nG6.2 P2 K0 X0 Y0 Z0\nK0 X3 Y1 Z2\nK1\nK1\nM2").unwrap();
    let Way::Nurbs(way) = &curve.paths.last().unwrap().targets[0].way else {
        panic!("a NURBS")
    };
    assert_eq!(way.points[1].position, [Some(3.0), Some(1.0), Some(12.0)]);
}

#[test]
fn a_tool_with_a_length_does_not_turn_while_it_feeds_but_about_itself() {
    for body in ["G1 B10", "G1 X5 B10", "G2 X10 I5 B1", "G1 X1 B360"] {
        assert!(
            wrong(&format!("G43 H2\n{body}")).contains("must not turn"),
            "{body}"
        );
        assert!(read(body).is_ok(), "{body}");
    }
    assert!(read("G43 H2\nG1 X5 A10 C20").is_ok());
    assert!(read("G43 H2\nG0 X5 B10").is_ok());
}

#[test]
fn the_table_is_of_the_machine_file_and_of_the_program() {
    let z = |z: f64| [None, None, Some(z)];
    assert_eq!(last("G10 L1 P2 Z3\nG43 H2\nG0 Z5"), z(8.0));
    // What is in use stays so until the next G43.
    assert_eq!(last("G43 H2\nG10 L1 P2 Z3\nG0 Z5"), z(15.0));
    assert_eq!(last("G10 L1 P7 Z1\nG43 H7\nG0 Z5"), z(6.0));
    // Where the machine stands the end of the tool is then at Z1, so that nothing goes there; the same in G59.3.
    let measured = "G92 Z-20\nG0 Z5\nG10 L10 P7 Z1\nG43 H7\nG0 Z1";
    assert_eq!(
        (last(measured), read(measured).unwrap().paths.len()),
        (z(25.0), 2)
    );
    let measured = "G10 L2 P9 Z2\nG0 Z30\nG10 L11 P7 Z1\nG0 Z0\nG43 H7\nG59.3\nG0 Z1";
    assert_eq!(last(measured), z(30.0));
    // A local offset does not count there.
    let local = "G10 L2 P9 Z2\nG0 Z30\nG92 Z5\nG10 L11 P7 Z1\nG92.1\nG0 Z0\nG43 H7\nG59.3\nG0 Z1";
    assert_eq!(last(local), z(30.0));
    assert!(wrong("G43 H9").contains("there is no tool 9: give it a table [tools.9]"));
    assert!(wrong("G10 L1 P2 X1 Z1").contains("a length along Z only"));
    assert!(wrong("G43.1 Y1").contains("a length along Z only"));
    assert!(wrong("G43.1").contains("G43.1 needs Z"));
    assert!(wrong("G43.2").contains("G43.2 needs H"));
    assert!(wrong("G43.1 Z5 G0").contains("takes the axis words"));
    assert!(wrong("G10 L1 P0 Z1").contains("numbers from 1"));
    assert!(wrong("G0 B10\nG10 L10 P2 Z0").contains("must be upright"));
    assert!(wrong("#5403=1").contains("cannot be set"));
    // Without a table all tools are that of the machine, which is told.
    let program = read_with(&[], "G43 H5\nG0 Z5").unwrap();
    assert!(program.notices[0].text.starts_with("H5 changes nothing"));
}

#[test]
fn a_length_before_the_first_motion_relies_on_nothing() {
    let text = "G43.1 Z5\nG0 X1 Y2 Z3 A0 B0 C0\nM2";
    let program = interpret(text, Options::default()).unwrap();
    assert_eq!(program.assumes, None);
    assert_eq!(program.paths[0].targets[0].words.axes[2], Some(8.0));
}

#[test]
fn a_tool_goes_beside_a_contour_with_its_length() {
    let body = "T2 M6\nG43 H2\nG41 G1 X20\nX40\nZ-1\nY30";
    assert_eq!(last(body), [Some(36.0), Some(30.0), None]);
    assert_eq!(
        last("T2 M6\nG43 H2\nG41 G1 X20\nX40\nZ-1"),
        [None, None, Some(9.0)]
    );
    assert!(wrong("T2 M6\nG43 H2\nG41 G1 X20\nX40 B5").contains("not turned beside a contour"));
}
