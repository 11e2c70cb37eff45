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
    assert!(wrong("ROT X30").contains("a tilted plane"));
    assert!(wrong("G18\nROT RPL=30").contains("select the plane with G17"));
    assert!(wrong("TRANS X1\nG92 X0").contains("end them first by TRANS"));
}

#[test]
fn g500_ends_the_coordinate_system() {
    assert_eq!(end("G10 L2 P1 X100\nG500\nG0 X1 Y2"), [1.0, 2.0]);
    assert_eq!(end("G10 L2 P5 X50 Y1\nG505\nG0 X1 Y2"), [51.0, 3.0]);
    assert_eq!(end("G10 L2 P1 X100\nG500 G0 X1 Y2\nG54 X0 Y0"), [100.0, 0.0]);
    assert!(wrong("G500\nG10 L2 P0 X1").contains("with G500 no coordinate system holds"));
}
