//! Arcs and polar coordinates of Siemens programs.

use super::wrong;
use crate::tests::run;
use crate::{ArcForm, ArcWay, Way};

/// Form and end of the last arc, rounded.
fn arc(body: &str) -> (ArcWay, [f64; 2]) {
    let program = run(&format!("F600\n{body}\nM2")).unwrap_or_else(|error| panic!("{error}"));
    let target = program.paths.last().unwrap().targets.last().unwrap().clone();
    let round = |value: f64| (value * 1e6).round() / 1e6 + 0.0;
    let Way::Arc(mut way) = target.way else {
        panic!("no arc: {target:?}")
    };
    way.form = match way.form {
        ArcForm::Centre(centre) => ArcForm::Centre(centre.map(round)),
        ArcForm::Radius(radius) => ArcForm::Radius(round(radius)),
    };
    (
        way,
        [0, 1].map(|axis| target.words.axes[axis].map_or(f64::NAN, round)),
    )
}

fn form(body: &str) -> ArcForm {
    arc(body).0.form
}

#[test]
fn an_arc_may_have_its_opening_angle() {
    assert_eq!(form("G3 X10 Y10 AR=90"), ArcForm::Radius(10.0));
    assert_eq!(form("G2 X10 Y10 AR=270"), ArcForm::Radius(-10.0));
    assert_eq!(form("G20\nG2 X1 Y0 AR=180"), ArcForm::Radius(12.7));
    assert_eq!(arc("G3 I0 J10 AR=90").1, [10.0, 10.0]);
    assert_eq!(arc("G2 I10 J0 AR=90").1, [10.0, 10.0]);
    assert_eq!(arc("G1 X5\nG2 I=AC(10) J=AC(0) AR=180").1, [15.0, 0.0]);
    for body in ["G2 X5 I5 AR=90", "G2 AR=90", "G2 X5 CR=9 AR=90"] {
        assert!(wrong(&format!("F9\n{body}")).contains("AR="), "{body}");
    }
    assert!(wrong("F9\nG2 X5 AR=360").contains("below 360"));
    assert!(wrong("F9\nG1 X5 AR=30").contains("AR= belongs to no code"));
}

#[test]
fn centres_may_be_coordinates() {
    assert_eq!(
        form("G1 X10 Y10\nG2 X30 Y10 I=AC(20) J=AC(10)"),
        ArcForm::Centre([10.0, 0.0, 0.0])
    );
    assert_eq!(
        form("G1 X10 Y10\nG90.1\nG2 X30 Y10 I20 J=IC(0)"),
        ArcForm::Centre([10.0, 0.0, 0.0])
    );
}

#[test]
fn an_arc_may_lead_through_a_point() {
    use shared::geometry::Turn;
    let (way, end) = arc("CIP X20 Y0 I1=10 J1=10");
    assert_eq!(
        (way.form, way.turn, end),
        (ArcForm::Centre([10.0, 0.0, 0.0]), Turn::Clockwise, [20.0, 0.0])
    );
    let (way, _) = arc("G91 CIP X20 Y0 I1=IC(10) J1=IC(-10)");
    assert_eq!(
        (way.form, way.turn),
        (ArcForm::Centre([10.0, 0.0, 0.0]), Turn::CounterClockwise)
    );
    let (way, _) = arc("CIP X20 Z0 I1=10 K1=10");
    assert_eq!(
        (way.plane(), way.form),
        (Some(crate::Plane::Zx), ArcForm::Centre([10.0, 0.0, 0.0]))
    );
    // It holds on.
    assert_eq!(
        form("CIP X20 Y0 I1=10 J1=10\nX40 I1=30 J1=10"),
        ArcForm::Centre([10.0, 0.0, 0.0])
    );
    // In space: all three points are 15 mm from X10 Y5 Z10, in the plane where Z is X.
    let (way, _) = arc("CIP X20 Y0 Z20 I1=10 J1=-10 K1=10");
    let ArcForm::Centre(centre) = way.form else {
        panic!("a centre")
    };
    let near = |own: [f64; 3], expected: [f64; 3]| (0..3).all(|i| (own[i] - expected[i]).abs() < 1e-9);
    let (half, counter) = (0.5f64.sqrt(), Turn::CounterClockwise);
    assert!(near(centre, [10.0, 5.0, 10.0]), "{centre:?}");
    assert!(
        near(way.about, [-half, 0.0, half]) && way.turn == counter,
        "{way:?}"
    );
    assert!(wrong("F9\nCIP X20 Y0 I1=10").contains("on a straight line"));
    assert!(wrong("CIP X20 Y0 I1=10 J1=10").contains("CIP needs a feed"));
    assert!(wrong("F9\nCIP X20 Y0").contains("I1= J1= K1="));
}

#[test]
fn a_helix_has_turns_besides() {
    assert_eq!(arc("G3 X0 Y0 Z-9 I10 J0 TURN=2").0.more_turns, 2);
    assert!(wrong("F9\nG3 X0 Y0 I10 TURN=1.5").contains("the turns besides an arc"));
}

#[test]
fn polar_coordinates_go_about_a_pole() {
    let end = |body: &str| {
        let program = run(&format!("{body}\nM2")).unwrap_or_else(|error| panic!("{error}"));
        let words = program.paths.last().unwrap().targets[0].words;
        [0, 1].map(|axis| (words.axes[axis].unwrap() * 1e6).round() / 1e6 + 0.0)
    };
    assert_eq!(end("G111 X10 Y20\nG0 RP=5 AP=90"), [10.0, 25.0]);
    assert_eq!(end("G111 X10 Y20\nG0 RP=5 AP=90\nAP=180"), [5.0, 20.0]);
    assert_eq!(end("G111 X10 Y20\nG0 RP=5 AP=90\nAP=IC(-90)"), [15.0, 20.0]);
    assert_eq!(end("G0 X3 Y4\nG110 X1 Y0\nG0 RP=5 AP=0"), [9.0, 4.0]);
    assert_eq!(end("G111 X10 Y20\nG112 X1 Y1\nG0 RP=5 AP=0"), [16.0, 21.0]);
    assert_eq!(end("G0 RP=7 AP=0"), [7.0, 0.0]);
    assert_eq!(
        form("G111 X10 Y0\nG2 RP=10 AP=0"),
        ArcForm::Centre([10.0, 0.0, 0.0])
    );
    assert_eq!(form("G111 X10 Y0\nG2 RP=10 AP=0 CR=12"), ArcForm::Radius(12.0));
    assert!(wrong("G0 X5 RP=3").contains("axis words of the plane"));
    assert!(wrong("G0 RP=-3 AP=0").contains("must not be negative"));
}
