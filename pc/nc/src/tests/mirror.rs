//! G51.1, G101 and G68: mirrors and rotations of other controllers.

use super::dialects::{ends, told, wrong};
use super::*;

/// X and Y of each motion, rounded.
fn places(body: &str) -> Vec<[f64; 2]> {
    let round = |value: f64| (value * 1e6).round() / 1e6 + 0.0;
    let program = format!("{body}\nM2");
    ends(&program)
        .into_iter()
        .map(|[x, y, _]| [round(x), round(y)])
        .collect()
}

#[test]
fn mirrors_lie_where_their_words_say() {
    for (body, expected) in [
        ("G51.1 X0\nG0 X1 Y2", [-1.0, 2.0]),
        ("G51.1 X10\nG0 X1 Y2", [19.0, 2.0]),
        ("G51.1 X10 Y-5\nG0 X1 Y2", [19.0, -12.0]),
        ("G51.1 X10\nG51.1 Y0\nG0 X1 Y2", [19.0, -2.0]),
        ("G51.1 X10 Y0\nG50.1 X0\nG0 X1 Y2", [1.0, -2.0]),
        ("G51.1 X10 Y0\nG50.1\nG0 X1 Y2", [1.0, 2.0]),
        ("G101 X0 Y0\nG0 X1 Y2", [-1.0, -2.0]),
        ("G101 X0 Y0\nG100 Y0\nG0 X1 Y2", [-1.0, 2.0]),
        ("G20 G51.1 X1\nG0 X0 Y0", [50.8, 0.0]),
        ("G10 L2 P1 X100\nG51.1 X10\nG0 X1 Y2", [119.0, 2.0]),
        // Steps are mirrored too, from where the tip is.
        ("G0 X5 Y5\nG51.1 X0\nG91 X1 Y1", [4.0, 6.0]),
        ("G52 X3\nG51.1 X10\nG0 X1 Y2", [22.0, 2.0]),
    ] {
        assert_eq!(places(body).last(), Some(&expected), "{body}");
    }
    assert_eq!(places("G0 X5 Y5\nG51.1 X0"), [[5.0, 5.0]], "it moves nothing");
}

#[test]
fn arcs_are_mirrored_with_their_sense_and_cycles_with_their_places() {
    let arc = |body: &str| {
        let program =
            run(&format!("F600 G0 X10 Y0 Z0\n{body}\nM2")).unwrap_or_else(|error| panic!("{error}"));
        let target = program.paths.last().unwrap().targets.last().unwrap().clone();
        match target.way {
            Way::Arc(arc) => (arc.turn, arc.form),
            way => panic!("{way:?}"),
        }
    };
    let (turn, form) = arc("G51.1 X0\nG0 X10 Y0\nG3 X0 Y10 I-10 J0");
    assert_eq!((turn, form), (Turn::Clockwise, ArcForm::Centre([10.0, 0.0, 0.0])));
    let (turn, form) = arc("G101 X0 Y0\nG0 X10 Y0\nG3 X0 Y10 R10");
    assert_eq!((turn, form), (Turn::CounterClockwise, ArcForm::Radius(10.0)));
    let (turn, form) = arc("G68 X0 Y0 R90\nG0 X10 Y0\nG3 X0 Y10 I-10 J0");
    assert_eq!(turn, Turn::CounterClockwise);
    assert!(matches!(form, ArcForm::Centre([x, y, _]) if x.abs() < 1e-12 && (y + 10.0).abs() < 1e-12));
    let holes: Vec<_> = ends("G51.1 X0\nF100 G99 G81 X1 Y2 Z-5 R2\nX3\nM2")
        .into_iter()
        .filter(|end| end[2] == -5.0)
        .collect();
    assert_eq!(holes, [[-1.0, 2.0, -5.0], [-3.0, 2.0, -5.0]]);
}

#[test]
fn a_rotation_is_about_the_point_that_is_said() {
    for (body, expected) in [
        ("G68 X0 Y0 R90\nG0 X1 Y2", [-2.0, 1.0]),
        ("G68 X10 Y0 R90\nG0 X11 Y0", [10.0, 1.0]),
        ("G68 X10 Y0 R90\nG0 X11 Y0\nX12", [10.0, 2.0]),
        ("G68 X10 Y0 R90\nG0 X11 Y0\nG69\nX3 Y4\nX5", [5.0, 4.0]),
        ("G68 X0 Y0 R90\nG68 X0 Y0 R180\nG0 X1 Y2", [-1.0, -2.0]),
        ("G20 G68 X1 Y0 R90\nG0 X2 Y1", [0.0, 25.4]),
    ] {
        assert_eq!(places(body).last(), Some(&expected), "{body}");
    }
    // Z alone is the same everywhere.
    assert!(run("G0 X1 Y1\nG68 X0 Y0 R90\nZ5\nX2 Y2\nM2").is_ok());
    assert_eq!(told("G69\nG0 X1\nM2").len(), 1);
    assert!(told("G68 X0 Y0 R9\nG0 X1 Y1\nG69\nM2").is_empty());
}

#[test]
fn what_controllers_do_not_allow_beside_these_is_refused() {
    for (body, why) in [
        ("G51.1", "G51.1 needs X, Y or Z"),
        ("G51.1 A0", "X, Y and Z only"),
        ("G101 X5", "write 0"),
        ("G91 G51.1 X5", "write it with G90"),
        ("G1 G51.1 X5", "takes the axis words"),
        ("G51.1 X0\nG52 X5", "end it first by G50.1"),
        ("G101 Y0\nG52 X5 Y3", "end it first by G50.1, G100 or G69"),
        ("G51.1 X0\nG92 X5", "end it first by G50.1"),
        ("G51.1 X0\nG10 L2 P1 X5", "end it first by G50.1"),
        ("G51.1 X0\nG55", "end it first by G50.1"),
        ("G51.1 X0\nG500", "end it first by G50.1"),
        ("G51.1 X0\nTRANS X5", "end it first by G50.1"),
        ("TRANS X5\nG51.1 X0", "end them first by TRANS"),
        ("TRANS X5\nG68 X0 Y0 R5", "end them first by TRANS"),
        ("G51.1 X0\nG68 X0 Y0 R5", "a mirror holds"),
        ("G68 X0 Y0 R5\nG51.1 X0", "a rotation holds"),
        ("G68 R5", "write the centre X Y"),
        ("G68 X0 Y0", "write the centre X Y"),
        ("G68 X0 Y0 Z0 R5", "about Z only"),
        ("G18 G68 X0 Y0 R5", "about Z only"),
        ("G91 G68 X0 Y0 R5", "write it with G90"),
        ("G68 X0 Y0 R5\nG0 X1", "says X and Y"),
        ("G68 X0 Y0 R5\nG91 G0 X1 Y1", "says X and Y"),
        ("G0 X1 Y1\nG68 X0 Y0 R5\nX1 Y1\nG69\nY3", "says X and Y"),
        ("G51.1 X0\nG0 X1 C5", "the tool does not"),
        ("G51.1 Z0\nF9 G81 X1 Y1 Z-1 R1", "cycles need Z as it is"),
        ("G51.1 X0\nWELDON=root", "do not follow"),
        ("F9 G81 X1 Y1 Z-1 R1\nA5", "only X, Y and Z are moved in a cycle"),
    ] {
        let error = wrong(&format!("{body}\nM2"));
        assert!(error.contains(why), "{body}: {error}");
    }
    // The same system again changes nothing.
    assert_eq!(places("G51.1 X0\nG54\nG0 X1 Y0"), [[-1.0, 0.0]]);
    assert_eq!(told("G50.1 X0 Y0\nG100 X0\nM2").len(), 2);
}

#[test]
fn surplus_words_of_g10_are_told() {
    let told = told("G10 L2 P1 J1 X5 R0\nG0 X1\nM2");
    assert_eq!(
        told,
        ["I, J and Q of G10 change nothing: they are angles and place of tools of lathes"]
    );
    assert_eq!(places("G10 L2 P1 J1 I2 Q3 X5\nG0 X1 Y0"), [[6.0, 0.0]]);
    assert!(wrong("G10 L2 P1 K1 X5\nM2").contains("K belongs to no code"));
}
