//! Tilted planes: where they lead, what moves in them, what turns the tool to them, and what is refused.

use super::*;
use nalgebra::{Rotation3, Vector3};

fn about(axis: usize, degrees: f64) -> Rotation3<f64> {
    let axis = nalgebra::Unit::new_normalize(Vector3::ith(axis, 1.0));
    Rotation3::from_axis_angle(&axis, degrees.to_radians())
}

/// X Y Z of every motion, and what makes an arc of it.
fn motions(body: &str) -> Vec<([f64; 3], Way)> {
    let program = run(&format!("{body}\nM2")).unwrap_or_else(|error| panic!("{body}: {error}"));
    let mut at = [0.0; 3];
    let mut found = Vec::new();
    for target in program.paths.iter().skip(2).flat_map(|path| &path.targets) {
        for (own, said) in at.iter_mut().zip(target.words.axes) {
            *own = said.unwrap_or(*own);
        }
        found.push((at, target.way.clone()));
    }
    found
}

fn ends(body: &str) -> Vec<Vector3<f64>> {
    motions(body)
        .into_iter()
        .map(|(at, _)| Vector3::from(at))
        .collect()
}

fn wrong(body: &str) -> String {
    run(&format!("{body}\nM2")).unwrap_err().to_string()
}

/// What a plane at 10, 20, 5, turned by 40 degrees about Z, 25 about X and -70 about Z again, makes of a place.
fn tilted(own: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(10.0, 20.0, 5.0) + about(2, 40.0) * about(0, 25.0) * about(2, -70.0) * own
}

const PLANE: &str = "G68.2 X10 Y20 Z5 I40 J25 K-70";

#[test]
fn what_is_programmed_in_a_plane_is_what_is_programmed_without_it_and_turned() {
    for body in [
        "G0 X1 Y2 Z3\nX4\nZ7\nG91 Y1\nX2 Z-1\nG90 X0",
        "F600\nG0 X5 Y0 Z2\nG1 X10\nG2 X20 I5\nG3 X20 Y10 R5\nG18 G3 X10 Z4 I-5\nG19 G2 Y0 Z6 J-3 K1\nG1 X0",
        "G0 X0 Y0 Z20\nG99 G81 X5 Y5 Z-3 R2 F100\nX10\nG98 G83 Y9 Z-3 R2 Q2\nG91 X2 L3\nG80 G90 G0 X0",
        "G0 X0 Y20 Z0\nG18 G99 G81 X5 Z5 Y-3 R2 F100\nX10\nG80",
        "F600 G0 X0 Y0 Z1\nG5 I2 J3 P-2 Q-3 X10 Y0\nG5.1 X20 Y0 I5 J5\nG6.2 P4 X20 Y0 Z1 K0\nX22 Y1 K0\nX25 Y1 Z3 K0\nX30 Y0 K0\nK1\nK1\nK1\nK1\nG0 X0",
        "G0 X0 Y0 Z1\nG16 G90 X10 Y30\nG15 X0",
    ] {
        let straight = ends(&format!("G0 X0 Y0 Z0\n{body}"));
        let inside = ends(&format!("{PLANE}\nG0 X0 Y0 Z0\n{body}"));
        // From Z0 of the tip the first motion of the straight one leads nowhere.
        let inside = &inside[1..];
        assert_eq!(straight.len(), inside.len(), "{body}");
        for (own, at) in straight.into_iter().zip(inside) {
            assert!((tilted(own) - at).norm() < 1e-9, "{body}: {own} at {at}");
        }
    }
}

#[test]
fn arcs_go_about_the_axis_of_the_plane() {
    let found = motions(&format!("{PLANE}\nG0 X0 Y0 Z0\nG2 X10 I5 F600\nG3 X0 R-6"));
    let normal = about(2, 40.0) * about(0, 25.0) * Vector3::z();
    let [(_, Way::Arc(by_centre)), (_, Way::Arc(by_radius))] = &found[1..] else {
        panic!("two arcs: {found:?}")
    };
    for arc in [by_centre, by_radius] {
        assert!((Vector3::from(arc.about) - normal).norm() < 1e-12);
        assert_eq!(arc.plane(), None);
    }
    assert_eq!(
        (by_centre.turn, by_radius.turn),
        (Turn::Clockwise, Turn::CounterClockwise)
    );
    let ArcForm::Centre(offset) = by_centre.form else {
        panic!("a centre")
    };
    let expected = tilted(Vector3::new(5.0, 0.0, 0.0)) - tilted(Vector3::zeros());
    assert!((Vector3::from(offset) - expected).norm() < 1e-12);
    assert_eq!(by_radius.form, ArcForm::Radius(-6.0));
}

#[test]
fn three_points_make_a_plane() {
    let at = |own: [f64; 3]| {
        let [x, y, z] = tilted(own.into()).into();
        format!("X{x:.12} Y{y:.12} Z{z:.12}")
    };
    let plane = format!(
        "G68.2 P2 Q1 {}\nG68.2 P2 Q3 {}\nG68.2 P2 Q2 {}\n",
        at([0.0; 3]),
        at([-7.0, 3.0, 0.0]),
        at([50.0, 0.0, 0.0])
    );
    let body = "G0 X1 Y2 Z3\nX9 Z-4";
    let by_points = ends(&format!("{plane}{body}"));
    let by_angles = ends(&format!("{PLANE}\n{body}"));
    assert_eq!(by_points.len(), 2);
    for (a, b) in by_points.iter().zip(&by_angles) {
        assert!((a - b).norm() < 1e-9, "{a} {b}");
    }
    let point = "G68.2 P2 Q1 X0 Y0 Z0";
    for (body, reason) in [
        (format!("{point}\nG0 X1"), "G68.2 P2 needs Q2"),
        (format!("{point}\nG53.1"), "G68.2 P2 needs Q2"),
        (
            format!("{point}\nG68.2 P2 Q2 X1 Y0 Z0\nG68.2 P2 Q3 X2 Y0 Z0"),
            "on a straight line",
        ),
        ("G68.2 P2 Q1 X0 Y0".to_owned(), "G68.2 P2 needs Z"),
        (
            "G68.2 P2 Q0 X0 Y0 Z0".to_owned(),
            "another origin is not possible",
        ),
        ("G68.2 P2 Q1 X0 Y0 Z0 I3".to_owned(), "by points, not by angles"),
    ] {
        assert!(wrong(&body).contains(reason), "{body}: {}", wrong(&body));
    }
}

#[test]
fn planes_end_and_do_not_mix_with_what_controllers_read_otherwise() {
    let to = ends(&format!("{PLANE}\nG69\nG0 X1 Y2 Z3"));
    assert_eq!(to, [Vector3::new(1.0, 2.0, 3.0)]);
    // Coordinate systems and local offsets of before lie below it.
    let below = ends("G52 X100\nG68.2 I90\nG0 X1 Y2 Z3");
    assert!(
        (below[0] - Vector3::new(98.0, 1.0, 3.0)).norm() < 1e-12,
        "{below:?}"
    );
    for (body, reason) in [
        ("G92 X0", "end it first by G69"),
        ("G10 L2 P1 X0", "end it first by G69"),
        ("G55", "end it first by G69"),
        ("G51.1 X0", "end it first by G69"),
        ("G68 X0 Y0 R9", "end it first by G69"),
        ("G68.2 X0", "end it first by G69"),
        ("CYCLE800()", "end it first by G69"),
        ("F9 G41.1 D1\nG1 X5 Y5", "do not lie in it"),
        ("F9\nG1 X5 RND=2\nY5", "do not lie in it"),
        ("F9\nG1 X5\nCT X9 Y4", "do not lie in it"),
        ("G28 X0 Y0", "in a tilted plane Z too"),
        ("G53.1 P1", "the shorter way"),
    ] {
        let body = format!("{PLANE}\n{body}");
        assert!(wrong(&body).contains(reason), "{body}: {}", wrong(&body));
    }
    for (body, reason) in [
        ("G53.1", "no tilted plane holds"),
        ("G68.2 P1 I9", "by three points (P2)"),
        ("G68.2 I9 Q123", "Q313"),
        ("G68.2 I9 R1", "leave it out"),
        ("G68.2 A9", "X, Y and Z only"),
        ("G91 G68.2 X1", "write it with G90"),
        ("TRANS X1\nG68.2 I9", "end them first by TRANS"),
        ("G68 X0 Y0 R9\nG68.2 I9", "end it first by G50.1, G100 or G69"),
    ] {
        assert!(wrong(body).contains(reason), "{body}: {}", wrong(body));
    }
}

#[test]
fn rotations_of_siemens_go_on_about_z_y_and_x() {
    let turned = about(2, 30.0) * about(1, -20.0) * about(0, 50.0);
    let own = Vector3::new(1.0, 2.0, 3.0);
    let near = |body: &str, expected: Vector3<f64>| {
        let to = ends(&format!("{body}\nG0 X1 Y2 Z3"));
        assert!(
            (to[0] - expected).norm() < 1e-9,
            "{body}: {} is not {expected}",
            to[0]
        );
    };
    near("ROT X50 Y-20 Z30", turned * own);
    near("ROT Z30\nAROT Y-20\nAROT X50", turned * own);
    near(
        "TRANS X5\nAROT Y-20 X50\nATRANS Z1",
        Vector3::x() * 5.0 + about(1, -20.0) * about(0, 50.0) * (own + Vector3::z()),
    );
    near("ROT X50\nTRANS X5", own + Vector3::x() * 5.0);
}

#[test]
fn cycle800_makes_planes_by_its_mode() {
    let own = Vector3::new(1.0, 2.0, 3.0);
    let near = |cycle: &str, expected: Vector3<f64>| {
        let to = ends(&format!("{cycle}\nG0 X1 Y2 Z3"));
        assert!(
            (to[0] - expected).norm() < 1e-9,
            "{cycle}: {} is not {expected}",
            to[0]
        );
    };
    let first = Vector3::new(10.0, 20.0, 30.0);
    let turned = about(0, 15.0) * about(1, 25.0) * about(2, 35.0);
    near(
        "CYCLE800(0,\"TC1\",0,57,10,20,30,15,25,35,0,0,0,0)",
        first + turned * own,
    );
    near(
        "CYCLE800(0,\"TC1\",0,57,10,20,30,15,25,35,1,0,0,0)",
        first + turned * (own + Vector3::x()),
    );
    let turned = about(2, 15.0) * about(1, 25.0) * about(0, 35.0);
    near("CYCLE800(0,\"\",0,27,0,0,0,15,25,35)", turned * own);
    near(
        "CYCLE800(0,\"\",0,64,0,0,0,15,25)",
        about(2, 15.0) * about(1, 25.0) * own,
    );
    // Inside the one before with what holds in it, or in place of both; TRANS goes back to the plane.
    let plane = "CYCLE800(0,\"\",0,57,0,0,0,90,0,0)\n";
    near(
        &format!("{plane}ATRANS X5\nCYCLE800(0,\"\",1,57,0,0,0,0,0,90)"),
        about(0, 90.0) * (Vector3::x() * 5.0 + about(2, 90.0) * own),
    );
    near(
        &format!("{plane}ATRANS X5\nCYCLE800(0,\"\",0,57,0,0,0,0,0,90)"),
        about(2, 90.0) * own,
    );
    near(
        &format!("{plane}TRANS X5\nTRANS X6"),
        about(0, 90.0) * (own + Vector3::x() * 6.0),
    );
    near(&format!("{plane}CYCLE800()"), own);
    near(&format!("{plane}CYCLE800(0,\"0\",0,57,0,0,0,0,0,0)"), own);
    // SAVE brings back the plane of before, and what TRANS goes back to.
    let saved = format!(
        "{plane}SUB1\nTRANS\nG0 X1 Y2 Z3\nM30\nPROC SUB1 SAVE\nCYCLE800(0,\"\",0,57,0,0,0,0,0,90)\nM17"
    );
    let to = ends(&saved);
    assert!((to[0] - about(0, 90.0) * own).norm() < 1e-9, "{}", to[0]);
    // An inch.
    near(
        "G20\nCYCLE800(0,\"\",0,57,1,0,0,0,0,0)\nG21",
        own + Vector3::x() * 25.4,
    );
    for (cycle, reason) in [
        ("CYCLE800(2,\"\",0,57,0,0,0,30,0,0)", "a retraction"),
        ("CYCLE800(0,\"\",0,192,0,0,0,30,0,0)", "one after the other"),
        ("CYCLE800(0,\"\",0,128,0,0,0,30,0,0)", "one after the other"),
        ("CYCLE800(0,\"\",100,57,0,0,0,30,0,0)", "_ST is 0"),
        ("CYCLE800(0,\"\",0,57,0,0,0,30,0,0,0,0,0,2)", "_DIR is -1 or 1"),
        ("CYCLE800(0,\"\",0,57,0,0,0,30", "bracket"),
        // The setup of these tests has no kinematics.
        (
            "CYCLE800(0,\"\",0,57,0,0,0,30,0,0,0,0,0,1)",
            "it needs the kinematics of a machine",
        ),
        (
            "CYCLE800(0,\"\",0,57,0,0,0,30,0,0)\nG68.2 I5",
            "end it first by CYCLE800()",
        ),
    ] {
        assert!(wrong(cycle).contains(reason), "{cycle}: {}", wrong(cycle));
    }
}

#[test]
fn what_says_nothing_new_is_no_motion_in_a_plane() {
    assert_eq!(
        motions(&format!("{PLANE}\nG0 X1 Y2 Z3\nX1\nG1 Z3 F9\nG91 X0\nG90 Y2")).len(),
        1
    );
}
