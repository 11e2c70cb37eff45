//! Tilted planes on the shipped machines: the tool that turns to them, and arcs in them.

use super::directions::{REACHED, end};
use super::*;

#[test]
fn the_tool_turns_to_a_tilted_plane_with_its_tip_or_with_its_axes() {
    for (machine, start, _, [i, j, k]) in REACHED {
        let wanted = Vector3::new(i, j, k).normalize();
        // Euler's angles whose Z that is: about Z, and about X as it is then.
        let (about_z, about_x) = (i.atan2(-j).to_degrees(), wanted.z.acos().to_degrees());
        let plane = format!("G68.2 I{about_z} J{about_x}");
        let go = |code: &str| end(machine, &format!("G0 {start}\n{plane}\n{code}\nM2"));
        let (_, before) = end(machine, &format!("G0 {start}\nM2")).unwrap();
        let tip = |axes: &[f64; AXES]| planner_of(machine).kinematics().forward(&inner(axes)).position;
        for code in [
            "G53.6".to_owned(),
            format!("G69\nCYCLE800(0,\"\",10,27,0,0,0,{about_z},0,{about_x},0,0,0,1)"),
        ] {
            let (normal, axes) = go(&code).unwrap();
            assert!(
                normal.angle(&wanted) < 1e-6,
                "{machine}, {code}: {normal} is not {wanted}"
            );
            let off = (tip(&axes) - tip(&before)).norm();
            assert!(off < 1e-6, "{machine}, {code}: the tip went {off} mm");
        }
        match go("G53.1") {
            Ok((normal, axes)) => {
                assert!(
                    normal.angle(&wanted) < 1e-6,
                    "{machine}: {normal} is not {wanted}"
                );
                let stay = axes.iter().zip(&before).take(3);
                assert!(
                    stay.clone().all(|(own, before)| (own - before).abs() < 1e-9),
                    "{machine}: {axes:?}"
                );
            }
            Err(refused) => panic!("{machine}: {refused}"),
        }
    }
}

#[test]
fn the_tool_turns_to_a_tilted_plane_from_a_pole() {
    let wanted: Vector3<f64> = Vector3::new(-0.3, 0.1, 0.9).normalize();
    let plane = format!(
        "G68.2 I{} J{}",
        (-0.3f64).atan2(-0.1).to_degrees(),
        wanted.z.acos().to_degrees()
    );
    for code in ["G53.6", "G53.1"] {
        let text = format!("G0 X600 Y600 Z150 A0 C0\n{plane}\n{code}\nM2");
        let (normal, _) = end("ac-head", &text).unwrap();
        assert!(normal.angle(&wanted) < 1e-6, "{code}: {normal}");
    }
}

#[test]
fn arcs_in_a_tilted_plane_are_circles_in_it() {
    let plane = "G68.2 X1000 Y1000 Z100 I35 J-20 K10";
    let paths = plan(&format!(
        "{plane}\nG0 X0 Y0 Z0\nF600 G2 X20 I10\nG3 X0 R10\nCIP X20 Y0 Z20 I1=10 J1=-10 K1=10"
    ))
    .unwrap();
    let planner = planner();
    let place = |axes: &[f64; AXES]| planner.kinematics().forward(&inner(axes)).position;
    let seen = followed("dual-beam-gantry", &paths, 0.5);
    let feed: Vec<_> = seen.iter().filter(|(index, ..)| *index > 0).collect();
    // The axes of the plane, worked out by hand: Rz(35)·Rx(-20)·Rz(10).
    let ([s1, s2, s3], [c1, c2, c3]) = (
        [35f64, -20.0, 10.0].map(|deg| deg.to_radians().sin()),
        [35f64, -20.0, 10.0].map(|deg| deg.to_radians().cos()),
    );
    let x = Vector3::new(c1 * c3 - s1 * c2 * s3, s1 * c3 + c1 * c2 * s3, s2 * s3);
    let y = Vector3::new(-c1 * s3 - s1 * c2 * c3, -s1 * s3 + c1 * c2 * c3, s2 * c3);
    let z = x.cross(&y);
    let origin = Vector3::new(1000.0, 1000.0, 100.0);
    assert!((place(&feed[0].2) - origin).norm() < 1e-6);
    for (index, s, axes) in &feed {
        let own = place(axes) - origin;
        let [px, py, pz] = [x, y, z].map(|axis| axis.dot(&own));
        let off = match index {
            // Clockwise over Y, and counter-clockwise back the same way.
            1 | 2 => (px - 10.0).hypot(py) - 10.0 + pz.abs() + (-py).max(0.0),
            // Through three points of space, all as far from X10 Y5 Z10.
            _ => Vector3::new(px - 10.0, py - 5.0, pz - 10.0).norm() - 15.0,
        };
        assert!(off.abs() < 1e-5, "{off} at {s} mm: {px} {py} {pz}");
    }
    let last = place(&feed.last().expect("a path").2) - origin;
    let off = (last - (x * 20.0 + z * 20.0)).norm();
    assert!(off < 1e-6, "{off}");
}
