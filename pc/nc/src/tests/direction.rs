//! Directions of the tool as vectors, and what is passed over of other controllers.

use super::*;
use shared::io::AXES;
use std::sync::Arc;

/// A head whose A B C are a hundred times the components of its direction, and which does not point downwards.
#[derive(Debug)]
struct Head;

impl TipAndAxes for Head {
    fn tip(&self, axes: &[f64; AXES]) -> [f64; AXES] {
        *axes
    }

    fn axes(&self, tip: &[f64; AXES]) -> Option<[f64; AXES]> {
        Some(*tip)
    }

    fn pointing(&self, tip: &[f64; AXES], direction: [f64; 3]) -> Result<[f64; 3], String> {
        match direction[2] < 0.0 {
            true => Err(format!("that is down at X{}", tip[0])),
            false => Ok(direction.map(|part| 100.0 * part)),
        }
    }
}

fn read(text: &str) -> Result<Program, NcError> {
    let setup = Setup {
        kinematics: Some(Arc::new(Head)),
        ..Setup::default()
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    interpret(text, options)
}

/// The end of the last motion: what it says of A B C, rounded to 6 decimals.
fn angles(body: &str) -> [Option<f64>; 3] {
    let program = read(&format!("G0 X0 Y0 Z50 A0 B0 C0 F600\n{body}\nM2")).unwrap();
    let path = program.paths.last().unwrap();
    let axes = path.targets.last().unwrap().words.axes;
    [3, 4, 5].map(|axis| axes[axis].map(|angle| (angle * 1e6).round() / 1e6))
}

fn wrong(body: &str) -> String {
    let error = read(&format!("G0 X0 Y0 Z50 A0 B0 C0 F600\n{body}\nM2")).unwrap_err();
    error.to_string()
}

#[test]
fn a_direction_is_made_rotary_axes_by_the_machine_whatever_its_length() {
    let leaning = [Some(60.0), Some(0.0), Some(80.0)];
    assert_eq!(angles("TRAORI\nG1 X10 A3=0.6 B3=0 C3=0.8"), leaning);
    // Components that are not said are 0, and the direction alone is a motion.
    assert_eq!(angles("G1 A3=3 C3=4"), leaning);
    assert_eq!(angles("G2 X10 R5 A3=3 C3=4"), leaning);
    assert_eq!(angles("G91 G1 X1\nX1 A3=3 C3=4"), leaning);
    // It turns with the coordinates of the program, and has no units.
    let turned = [Some(0.0), Some(60.0), Some(80.0)];
    assert_eq!(angles("G10 L2 P1 R90\nG20 G1 X10 A3=3 C3=4"), turned);
}

#[test]
fn i_j_k_are_a_direction_after_g43_5_in_straight_motions_only() {
    let leaning = [Some(60.0), Some(0.0), Some(80.0)];
    assert_eq!(angles("G43.5 H1\nG1 X10 I3 K4"), leaning);
    assert_eq!(angles("G43.5 H1 G1 X10 I3 K4"), leaning);
    assert_eq!(angles("G43.5\nG1 X10 I3 K4\nX20"), [None; 3]);
    assert_eq!(angles("G43.5\nG0 I3 K4"), leaning);
    // A centre.
    assert_eq!(angles("G43.5\nG2 X10 I5"), [None; 3]);
    for end in ["G43.4", "G49"] {
        let error = wrong(&format!("G43.5\n{end}\nG1 X10 I3 K4"));
        assert!(
            error.starts_with("line 4, column 8: I belongs to no code of this block"),
            "{end}: {error}"
        );
    }
}

#[test]
fn directions_that_are_none_are_refused() {
    let of_tool = |why: &str| format!("line 2, column 7: the direction of the tool: {why}");
    assert_eq!(
        wrong("G1 X1 A3=0 C3=0"),
        "line 2, column 7: the direction of the tool is zero: it leads from the tip to the machine, with at least one \
         component"
    );
    assert_eq!(
        wrong("G1 X1 A3=3 C3=-4"),
        "line 2, column 7: the tool cannot point along X0.6 Y0 Z-0.8: that is down at X1"
    );
    assert_eq!(
        wrong("G1 X1 A3=1 B5"),
        of_tool("it says where the rotary axes go: leave A B C out")
    );
    assert_eq!(
        wrong("G81 X1 A3=1 Z-1 R1"),
        "line 2, column 8: the direction of the tool: it is possible with G0, G1, G2 and G3 only: write A B C, or a block of \
         its own"
    );
    assert!(wrong("G43.5\nG1 I1 A3=1").contains("it is said by I J K too: leave one out"));
    // Codes that take axes alone.
    for code in ["G28", "G30 X1", "G92 X1", "G52 X1", "G10 L2 P1 X1", "G53 G0 X1"] {
        for word in ["A3=", "V1="] {
            let error = wrong(&format!("{code} {word}1"));
            assert!(
                error.contains(&format!("{word} belongs to no code of this block")),
                "{code}: {error}"
            );
        }
    }
    assert!(wrong("G81 X1 Z-1 R1 V1=1").contains("V1= belongs to no code of this block"));
    assert!(wrong("G43.5\nG53 G0 X1 I1").contains("I belongs to no code of this block"));
    let error = interpret("G0 X1 A3=1\nM2", Options::default())
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "line 1, column 7: the direction of the tool: it needs the kinematics of a machine"
    );
}

#[test]
fn what_other_controllers_say_besides_is_told_once() {
    let told = |body: &str| {
        let program = read(&format!("{body}\nM2")).unwrap();
        let notices = program.notices.into_iter();
        notices
            .map(|notice| (notice.place.line, notice.text))
            .collect::<Vec<_>>()
    };
    let once = told("G05.1 Q1\nG21 G0 X1\nG05.1 Q0\nN7 ORIWKS ORIAXES\nORIAXES\nG642\nG0 X2\nG642");
    let lines: Vec<_> = once.iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [1, 4, 6], "{once:?}");
    assert!(once[0].1.starts_with("G5.1 Q changes nothing"), "{once:?}");
    assert!(once[1].1.starts_with("ORIAXES changes nothing"), "{once:?}");
    assert!(once[2].1.starts_with("G642 is taken as G64"), "{once:?}");
    assert!(wrong("G5.1 Q2").contains("Q2 is not possible: Q1 begins"));
    // The curve of this name is what it was.
    let curve = read("G0 X0 Y0 Z0 A0 B0 C0 F600\nG5.1 X10 Y0 I5 J5\nM2").unwrap();
    assert!(matches!(curve.paths[1].targets[0].way, Way::Nurbs(_)));
    assert!(wrong("G5.1 X1 Q1").contains("Q belongs to no code"));
}

#[test]
fn g642_keeps_the_tolerance_of_the_machine_or_the_default() {
    let control = |setup: Setup| {
        let options = Options {
            setup: Arc::new(setup),
            ..Options::default()
        };
        let program = interpret("G64 P9 Q9\nG642\nG0 X1\nM2", options).unwrap();
        program.paths[0].targets[0].control
    };
    let within = |tolerance: f64| {
        PathControl::Blend(Blend {
            tolerance: Some(tolerance),
            smoothing: None,
        })
    };
    assert_eq!(control(Setup::default()), within(0.05));
    let own = Setup {
        control: within(0.2),
        ..Setup::default()
    };
    assert_eq!(control(own), within(0.2));
}
