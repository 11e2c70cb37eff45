//! TRANS, ROT, G500 and coordinate systems of Siemens programs.

use super::wrong;
use crate::tests::run;

/// X and Y of the last motion, rounded.
fn end(body: &str) -> [f64; 2] {
    let program = run(&format!("{body}\nM2")).unwrap_or_else(|error| panic!("{error}"));
    let words = program.paths.last().unwrap().targets.last().unwrap().words;
    [0, 1].map(|axis| (words.axes[axis].unwrap() * 1e6).round() / 1e6)
}

#[test]
fn frames_shift_and_turn_inside_the_coordinate_system() {
    assert_eq!(end("TRANS X10 Y5\nG0 X1 Y2"), [11.0, 7.0]);
    assert_eq!(end("TRANS X10 Y5\nATRANS X1\nG0 X1 Y2"), [12.0, 7.0]);
    assert_eq!(end("TRANS X10 Y5\nTRANS X1\nG0 X1 Y2"), [2.0, 2.0]);
    assert_eq!(end("TRANS X10 Y5\nAROT RPL=90\nG0 X1 Y2"), [8.0, 6.0]);
    assert_eq!(end("TRANS X10 Y5\nAROT Z90\nATRANS X1\nG0 X1 Y2"), [8.0, 7.0]);
    assert_eq!(end("TRANS X10\nROT RPL=90\nG0 X1 Y2"), [-2.0, 1.0]);
    assert_eq!(end("ROT RPL=90\nTRANS\nG0 X1 Y2"), [1.0, 2.0]);
    assert_eq!(end("G10 L2 P1 X100 R90\nTRANS X10\nG0 X1 Y2"), [98.0, 11.0]);
    // The tip stays where it is: steps go on from there.
    assert_eq!(end("G0 X5 Y5\nTRANS X10 Y10\nG91 X1 Y1"), [6.0, 6.0]);
    // About Z to X is about Y.
    assert_eq!(end("G18\nROT RPL=90\nG0 X1 Y2 Z3"), [3.0, 2.0]);
    assert!(wrong("ROT A30").contains("not with rotary axes"));
    assert!(wrong("ROT X30 RPL=2").contains("by RPL= or about axes"));
    assert!(wrong("TRANS X1\nG92 X0").contains("end them first by TRANS"));
}

#[test]
fn g500_ends_the_coordinate_system() {
    assert_eq!(end("G10 L2 P1 X100\nG500\nG0 X1 Y2"), [1.0, 2.0]);
    assert_eq!(end("G10 L2 P5 X50 Y1\nG505\nG0 X1 Y2"), [51.0, 3.0]);
    assert_eq!(end("G10 L2 P1 X100\nG500 G0 X1 Y2\nG54 X0 Y0"), [100.0, 0.0]);
    assert!(wrong("G500\nG10 L2 P0 X1").contains("with G500 no coordinate system holds"));
}

#[test]
fn frames_mirror_and_scale_what_comes_after_them() {
    assert_eq!(end("MIRROR X0\nG0 X1 Y2"), [-1.0, 2.0]);
    assert_eq!(end("MIRROR X5 Y0\nG0 X1 Y2"), [-1.0, -2.0]);
    assert_eq!(end("TRANS X10\nAMIRROR X0\nG0 X1 Y2"), [9.0, 2.0]);
    assert_eq!(end("TRANS X10\nAMIRROR X0\nATRANS X3\nG0 X1 Y2"), [6.0, 2.0]);
    assert_eq!(end("TRANS X10\nMIRROR X0\nG0 X1 Y2"), [-1.0, 2.0]);
    assert_eq!(end("MIRROR X0\nMIRROR\nG0 X1 Y2"), [1.0, 2.0]);
    assert_eq!(end("SCALE X2 Y3\nG0 X1 Y2"), [2.0, 6.0]);
    assert_eq!(end("SCALE X2 Y2\nATRANS X1\nG0 X1 Y2"), [4.0, 4.0]);
    assert_eq!(end("G20\nSCALE X2 Y2\nG0 X1 Y2"), [50.8, 101.6]);
    assert_eq!(end("TRANS X10\nASCALE X2 Y2\nAROT RPL=90\nG0 X1 Y2"), [6.0, 2.0]);
    assert_eq!(end("AROT RPL=90\nAMIRROR X0\nG0 X1 Y2"), [-2.0, -1.0]);
    // Steps are mirrored too, from where the tip is.
    assert_eq!(end("G0 X5 Y5\nMIRROR X0\nG91 X1 Y1"), [4.0, 6.0]);
    assert_eq!(end("G0 X5 Y5\nSCALE\nG91 X1 Y1"), [6.0, 6.0]);
}

#[test]
fn arcs_are_mirrored_with_their_sense_and_scaled_with_their_radius() {
    use crate::program::{ArcForm, Way};
    use shared::geometry::Turn;
    let arc = |body: &str| {
        let program = run(&format!("{body}\nM2")).unwrap_or_else(|error| panic!("{error}"));
        let target = program.paths.last().unwrap().targets.last().unwrap().clone();
        let Way::Arc(arc) = target.way else {
            panic!("an arc")
        };
        (arc.turn, arc.form)
    };
    let begin = "F600 G0 X10 Y0 Z0";
    let (turn, form) = arc(&format!("MIRROR X0\n{begin}\nG3 X0 Y10 I-10 J0"));
    assert_eq!((turn, form), (Turn::Clockwise, ArcForm::Centre([10.0, 0.0, 0.0])));
    let (turn, form) = arc(&format!("MIRROR X0 Y0\n{begin}\nG3 X0 Y10 CR=-10"));
    assert_eq!((turn, form), (Turn::CounterClockwise, ArcForm::Radius(-10.0)));
    let (turn, form) = arc(&format!(
        "SCALE X2 Y2\nAMIRROR Y0\n{begin}\nG2 X0 Y10 I=AC(0) J=AC(0)"
    ));
    assert_eq!(turn, Turn::CounterClockwise);
    assert_eq!(form, ArcForm::Centre([-20.0, 0.0, 0.0]));
    assert_eq!(
        arc(&format!("SCALE X2 Y2\n{begin}\nG3 X0 Y10 R10")).1,
        ArcForm::Radius(20.0)
    );
    let through = format!("MIRROR X0\n{begin}\nCIP X-10 Y0 I1=0 J1=10");
    assert_eq!(
        arc(&through),
        (Turn::Clockwise, ArcForm::Centre([10.0, 0.0, 0.0]))
    );
    assert!(wrong(&format!("SCALE X2\n{begin}\nG3 X0 Y10 R10")).contains("it is an ellipse"));
    assert!(wrong(&format!("SCALE X2\n{begin}\nCIP X-10 Y0 I1=0 J1=10")).contains("it is an ellipse"));
    let in_space = "CIP X-10 Y0 Z20 I1=0 J1=10 K1=10";
    assert!(wrong(&format!("SCALE X2 Y2\n{begin}\n{in_space}")).contains("it is an ellipse"));
    assert_eq!(
        arc(&format!("SCALE X2 Y2 Z2\n{begin}\n{in_space}")).1,
        ArcForm::Centre([-20.0, -10.0, 20.0])
    );
    let about_y = arc(&format!("MIRROR X0\nG18\n{begin}\nG3 X0 Z10 CR=10"));
    assert_eq!(about_y, (Turn::Clockwise, ArcForm::Radius(10.0)));
}

#[test]
fn what_mirror_and_scale_do_not_reach_is_refused() {
    assert!(wrong("SCALE X0").contains("a factor is above 0"));
    assert!(wrong("MIRROR C0").contains("only X, Y and Z are mirrored"));
    assert!(wrong("MIRROR X0\nG0 X1 C5").contains("the tool does not"));
    assert!(wrong("MIRROR X0\nG43.5\nG0 X1 I1 K1").contains("do not follow"));
    assert!(wrong("MIRROR Z0\nF100 G81 X1 Y1 Z-1 R1").contains("cycles need Z as it is"));
    assert!(wrong("MIRROR Z0\nF100 G0 X0 Y0 Z5\nCYCLE81(5,0,1,-3)").contains("cycles need Z as it is"));
    assert!(wrong("SCALE X2 Y2\nF100 G0 X0 Y0 Z0\nG1 X5 RND=1\nY5").contains("are not scaled"));
    assert!(wrong("MIRROR X0\nWELDON=root").contains("its data do not follow"));
    assert!(wrong("MIRROR X0\nG92 X0").contains("end them first by TRANS"));
    let rounded = |between: &str| format!("F100 G0 X0 Y0 Z0\nRNDM=1\nG1 X5\n{between}\nG1 Y5\nX0\nRNDM=0");
    let text = wrong(&rounded("SCALE X2 Y2"));
    assert!(
        text.contains("line 9, column 4: MIRROR or SCALE: roundings and chamfers"),
        "{text}"
    );
    assert!(wrong(&rounded("ASCALE X2")).contains("RNDM=0 before"));
    assert!(run(&format!("{}\nM2", rounded("RNDM=0\nSCALE X2 Y2"))).is_ok());
    assert!(run(&format!("{}\nM2", rounded("MIRROR X0"))).is_ok());
    assert!(run("MIRROR X0\nF100 G81 X1 Y1 Z-1 R1\nM2").is_ok());
    assert!(run("MIRROR X0\nF100 G0 X0 Y0 Z0\nG1 X5 RND=1\nY5\nM2").is_ok());
}

#[test]
fn no_mirror_or_scale_begins_in_an_open_weld() {
    let open = |body: &str| format!("F100 G0 X0 Y0 Z0\nWELDON=root\nG1 X5\n{body}\nG1 X6\nWELDOFF\nX7");
    for body in [
        "MIRROR X0",
        "AMIRROR Y0",
        "SCALE X2",
        "ASCALE X2 Y2",
        "G51.1 X0",
        "G101 Y0",
    ] {
        let text = wrong(&open(body));
        assert!(
            text.contains("line 8, column 1") && text.contains("a weld is open"),
            "{body}: {text}"
        );
    }
    for body in [
        "MIRROR",
        "TRANS X1",
        "AROT RPL=5",
        "WELDOFF\nMIRROR X0",
        "WELDOFF\nSCALE X2\nSCALE\nWELDON=cap",
    ] {
        let result = run(&format!("{}\nM2", open(body)));
        assert!(result.is_ok(), "{body}: {result:?}");
    }
}
