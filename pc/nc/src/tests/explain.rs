//! How blocks are told, in the order of execution.

use super::*;

/// Every block of `text` and what it does, as `check --explain` lays it out.
fn told(text: &str) -> String {
    told_with(Options::default(), text)
}

fn told_with(options: Options, text: &str) -> String {
    let mut told = String::new();
    let read = explain(text, options.clone(), |block| {
        let inside = "  ".repeat(block.depth);
        told += &format!("{inside}{}: {}\n", block.line, block.text);
        for fact in block.facts {
            told += &format!("{inside}   {fact}\n");
        }
    });
    assert_eq!(read.unwrap(), interpret(text, options).unwrap());
    told
}

const PROGRAM: &str = "(a plate)
G20 G64 P0.001
G10 L2 P2 X4 Y2 R90
G55 G0 X1 Y0 Z1 A0 B0 C0
M67 E0 Q500
M62 P0
G1 X2 F10 (MSG, go)
G3 X2 Y2 J1
M63 P0

o100 sub
G91 G1 Z[#1]
G90
o100 endsub
#2 = [1/4]
o101 repeat [2]
o100 call [#2]
o101 endrepeat
G21
G21
G4 P1.5
G93 G1 C90 F2
M2
";

const TOLD: &str = "2: G20 G64 P0.001
   path: at the best speed (G64), within 0.0254 mm
   lengths are inches (G20)
3: G10 L2 P2 X4 Y2 R90
   G55: origin at X101.6 Y50.8 Z0 mm, A0 B0 C0 deg, turned by 90 deg about Z
4: G55 G0 X1 Y0 Z1 A0 B0 C0
   coordinate system G55: origin at X101.6 Y50.8 Z0 mm, A0 B0 C0 deg, turned by 90 deg about Z
   straight, rapid, to X1 Y0 Z1 in, A0 B0 C0 deg in G55
   tip at X101.6 Y76.2 Z25.4 mm, A0 B0 C0 deg
5: M67 E0 Q500
   power of beam 1: 500 W (of a spindle r/min) with the next motion
6: M62 P0
   gate of beam 1 opens with the next motion
7: G1 X2 F10 (MSG, go)
   feed from here: 254 mm/min
   power of beam 1: 500 W (of a spindle r/min) with this motion: M67 of line 5
   gate of beam 1 opens with this motion: M62 of line 6
   straight, F 254 mm/min, to X2 Y0 Z1 in, A0 B0 C0 deg in G55
   tip at X101.6 Y101.6 Z25.4 mm, A0 B0 C0 deg
   go
8: G3 X2 Y2 J1
   arc counter-clockwise about Z, radius 25.4 mm about X76.2 Y101.6 mm of the tip, F 254 mm/min, to X2 Y2 Z1 in, \
   A0 B0 C0 deg in G55
   tip at X50.8 Y101.6 Z25.4 mm, A0 B0 C0 deg
9: M63 P0
   gate of beam 1 closes with the next motion
11: o100 sub
   goes on at line 15
15: #2 = [1/4]
   #2 = 0.25
16: o101 repeat [2]
   goes on with the next line
17: o100 call [#2]
   calls the subroutine from line 12
  12: G91 G1 Z[#1]
     coordinates are steps
     gate of beam 1 closes with this motion: M63 of line 9
     straight, F 254 mm/min, to X2 Y2 Z1.25 in, A0 B0 C0 deg in G55
     tip at X50.8 Y101.6 Z31.75 mm, A0 B0 C0 deg
  13: G90
     coordinates are absolute
  14: o100 endsub
     returns to line 18
18: o101 endrepeat
   goes on at line 17
17: o100 call [#2]
   calls the subroutine from line 12
  12: G91 G1 Z[#1]
     coordinates are steps
     straight, F 254 mm/min, to X2 Y2 Z1.5 in, A0 B0 C0 deg in G55
     tip at X50.8 Y101.6 Z38.1 mm, A0 B0 C0 deg
  13: G90
     coordinates are absolute
  14: o100 endsub
     returns to line 18
18: o101 endrepeat
   goes on with the next line
19: G21
   lengths are mm (G21)
20: G21
   changes nothing
21: G4 P1.5
   stands for 1.5 s
22: G93 G1 C90 F2
   F is 1/F minutes of its block (G93)
   turns axes, in 30 s (G93), to X50.8 Y50.8 Z38.1 mm, A0 B0 C90 deg in G55
   tip at X50.8 Y101.6 Z38.1 mm, A0 B0 C90 deg
23: M2
   the program ends
";

#[test]
fn a_program_with_offset_subroutine_arc_and_inches_is_told_block_by_block() {
    assert_eq!(told(PROGRAM), TOLD);
}

#[test]
fn a_cycle_is_told_with_the_motions_that_it_makes_and_a_nurbs_where_it_ends() {
    let text = "G21 G0 X0 Y0 Z50 A0 B0 C0\nG99 G82 X10 Z-5 R2 P0.5 F100\nG80\nG5.2 P1 L3\nX20 Y0 P1\nX20 Y10 P1\nX30 Y10 P1\nG5.3\n\
                G53 G0 Z100\nM2";
    let wanted = "1: G21 G0 X0 Y0 Z50 A0 B0 C0
   straight, rapid, to X0 Y0 Z50 mm, A0 B0 C0 deg in G54
   tip at X0 Y0 Z50 mm, A0 B0 C0 deg
2: G99 G82 X10 Z-5 R2 P0.5 F100
   feed from here: 100 mm/min
   straight, rapid, to X10 Y0 Z50 mm, A0 B0 C0 deg in G54
   tip at X10 Y0 Z50 mm, A0 B0 C0 deg
   straight, rapid, to X10 Y0 Z2 mm, A0 B0 C0 deg in G54
   tip at X10 Y0 Z2 mm, A0 B0 C0 deg
   straight, F 100 mm/min, to X10 Y0 Z-5 mm, A0 B0 C0 deg in G54
   tip at X10 Y0 Z-5 mm, A0 B0 C0 deg
   stands for 0.5 s
   straight, rapid, to X10 Y0 Z2 mm, A0 B0 C0 deg in G54
   tip at X10 Y0 Z2 mm, A0 B0 C0 deg
3: G80
   motion: G0
4: G5.2 P1 L3
   motion: G5.2
   a NURBS begins: its points follow
5: X20 Y0 P1
   point or knot of the NURBS
6: X20 Y10 P1
   point or knot of the NURBS
7: X30 Y10 P1
   point or knot of the NURBS
8: G5.3
   NURBS of order 3 with 4 points, F 100 mm/min, to X30 Y10 Z2 mm, A0 B0 C0 deg in G54
   tip at X30 Y10 Z2 mm, A0 B0 C0 deg
9: G53 G0 Z100
   axes of the machine, straight in axis space, rapid, to Z100 mm
   where the tip is then is not known
10: M2
   the program ends
";
    assert_eq!(told(text), wanted);
}

#[test]
fn what_comes_before_an_error_is_told() {
    let mut lines = Vec::new();
    let text = "G0 X0\nG1 X1 F100\nG1 X2 Q7\nG1 X3";
    let error = explain(text, Options::default(), |block| lines.push(block.line)).unwrap_err();
    assert_eq!(lines, [1, 2]);
    assert_eq!(error.place.line, 3);
}

#[test]
fn lines_that_do_nothing_are_told_and_comments_are_not() {
    let options = Options {
        block_delete: true,
        ..Options::default()
    };
    let text = "%\n\n(a comment)\n; another\nN5 SOFT COMPCAD\n  /G0 X1\nO7\nM2";
    let wanted = "5: N5 SOFT COMPCAD
   changes nothing
6: /G0 X1
   left out: block delete
7: O7
   goes on with the next line
8: M2
   the program ends
";
    assert_eq!(told_with(options, text), wanted);
}

#[test]
fn a_way_beside_a_contour_is_told_where_the_tip_goes() {
    let text = "G21 G0 X0 Y0 Z0 A0 B0 C0 F600\nG41.1 D10 G1 X20\nX40\nY-30\nG40 X60\nM2\n";
    let told = told(text);
    for wanted in [
        "2: G41.1 D10 G1 X20\n   the tip goes 5 mm to the left of the contour\n   straight, F 600 mm/min, to X20 Y5 Z0 mm, A0 B0 C0 deg in G54",
        "4: Y-30\n   arc clockwise about Z, radius 5 mm about X40 Y0 mm of the tip, F 600 mm/min, to X45 Y0 Z0 mm",
        "   straight, F 600 mm/min, to X45 Y-30 Z0 mm, A0 B0 C0 deg in G54\n",
        "5: G40 X60\n   the tip goes to programmed places again\n   straight, F 600 mm/min, to X60 Y-30 Z0 mm",
    ] {
        assert!(told.contains(wanted), "{wanted}\n---\n{told}");
    }
}
