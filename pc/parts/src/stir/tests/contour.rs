//! The contour by itself, and parts that there cannot be.

use super::*;
use nalgebra::Vector3;

fn refusal(part: &Stir, machine: &MachineFile) -> String {
    plan(part, machine).unwrap_err().to_string()
}

/// Point and heading continue without a jump, also where the heading passes ±180°, and the heading is the
/// direction.
#[test]
fn the_heading_is_the_direction_and_never_jumps() {
    let spiral = part_along(
        "[300.0, 225.0]",
        r#"{ line_to = [290.0, 225.0] },
           { arc_to = [290.0, 265.0], centre = [290.0, 245.0], turn = "cw" },
           { arc_to = [330.0, 225.0], centre = [290.0, 225.0], turn = "cw" },
           { line_to = [330.0, 200.0] },
           { arc_to = [350.0, 200.0], centre = [340.0, 200.0], turn = "ccw" }"#,
    );
    let contour = Contour::build(spiral.start, &spiral.contour, 61.0).unwrap();
    let step = 0.01;
    let count = (contour.length() / step) as usize;
    for i in 0..count {
        let s = step * i as f64;
        let ((p, before), (q, after)) = (contour.at(s), contour.at(s + step));
        let way = q - p;
        let middle = (before + after) / 2.0;
        assert!((after - before).abs() < 1.1 * step / 10.0, "a jump at {s}");
        let off = shared::units::wrap(way.y.atan2(way.x) - middle);
        // Both places may be on arcs of different radii.
        assert!(off.abs() < 0.3 * step / 10.0, "{off} at {s}");
        assert!((p.z - 61.0).abs() < 1e-12);
    }
    let turned = contour.at(contour.length()).1 - contour.at(0.0).1;
    let expected = (-180.0 - 90.0 + 180.0_f64).to_radians();
    assert!((turned - expected).abs() < 1e-12, "{turned}");
}

#[test]
fn the_nearest_place_is_square_to_the_contour_and_on_the_right_branch() {
    let part = part_with("", "");
    let contour = Contour::build(part.start, &part.contour, 61.0).unwrap();
    for i in 0..=200 {
        let s = contour.length() * f64::from(i) / 200.0;
        let (place, heading) = contour.at(s);
        let aside = Vector3::new(-heading.sin(), heading.cos(), 0.0);
        for off in [-5.0, -0.01, 0.0, 3.0] {
            let point = place + aside * off + Vector3::z() * 0.1;
            let found = contour.nearest(&point, s + 1.0, 10.0);
            assert!((found - s).abs() < 1e-9, "{found} instead of {s}, {off} aside");
        }
    }
    // Beyond its ends there is nothing.
    assert_eq!(contour.nearest(&Vector3::new(240.0, 215.0, 61.0), 0.0, 10.0), 0.0);
    // At the start of a full circle, its end is as near.
    let part = circle(90.0, "ccw");
    let contour = Contour::build(part.start, &part.contour, 61.0).unwrap();
    let start = contour.at(0.0).0;
    assert!(contour.nearest(&start, 1.0, 10.0) < 1e-9);
    let end = contour.nearest(&start, contour.length() - 1.0, 10.0);
    assert!((end - contour.length()).abs() < 1e-9);
}

#[test]
fn segments_that_do_not_join_or_exist_are_named() {
    let machine = machine();
    let message = |old: &str, new: &str| refusal(&part_with(old, new), &machine);
    let corner = message("[298.0, 231.0]", "[298.0, 231.01]");
    assert!(
        corner.starts_with("segment 3 leaves the one before at a corner of 0.046°"),
        "{corner}"
    );
    let off = message("centre = [328.0, 191.0]", "centre = [328.1, 191.0]");
    assert!(
        off.starts_with("segment 4: radius mismatch: the start is 50.06"),
        "{off}"
    );
    let none = message("{ line_to = [260.0, 215.0] }", "{ line_to = [250.0, 215.0] }");
    assert!(none.starts_with("segment 1: zero length"), "{none}");
    for wrong in [
        "{ line_to = [260.0, 215.0], turn = \"cw\" }",
        "{ arc_to = [260.0, 215.0], turn = \"cw\" }",
        "{ centre = [260.0, 215.0] }",
    ] {
        let form = message("{ line_to = [260.0, 215.0] }", wrong);
        assert!(
            form.starts_with("segment 1 is neither a line nor an arc"),
            "{form}"
        );
    }
    let empty = refusal(&part_along("[1.0, 1.0]", ""), &machine);
    assert!(empty.starts_with("contour has no segments"), "{empty}");
    let plate = message(
        "plate_corner_mm = [150.0, 150.0",
        "plate_corner_mm = [150.0, 94.0",
    );
    assert!(
        plate.starts_with("segment 4 brings the tool, 8 mm wide, to 1.000 mm beyond"),
        "{plate}"
    );
    // An arc bulges beyond both of its ends.
    let bulge = part_along(
        "[630.0, 200.0]",
        r#"{ arc_to = [630.0, 240.0], centre = [630.0, 220.0], turn = "ccw" }"#,
    );
    let bulge = refusal(&bulge, &machine);
    assert!(bulge.contains("to 4.000 mm beyond the edge"), "{bulge}");
}

#[test]
fn what_the_machine_or_the_process_cannot_do_is_named() {
    let gantry = machine();
    let message = |old: &str, new: &str| refusal(&part_with(old, new), &gantry);
    assert_eq!(
        message("tilt_deg = 2.5", "tilt_deg = 10.5"),
        "tilt_deg is 10.5: axis B would have to stand at -10.5°, but its travel is -10.0…10.0°"
    );
    assert_eq!(
        message("tilt_deg = 2.5", "tilt_deg = -2.5"),
        "tilt_deg is -2.5, but must be 0 or more"
    );
    assert_eq!(
        message("depth_mm = 5.0", "depth_mm = 16.0"),
        "depth_mm is 16, but must be above 0 and less than the plate is thick"
    );
    assert!(message("= 600.0", "= 3600.0").contains("turns at 3000 r/min at most"));
    assert!(message("150.0, 50.0]", "150.0, 184.0]").contains("safe_height_mm of the machine is 200"));
    let travel = refusal(&circle(0.0, "ccw"), &gantry);
    assert!(
        travel.starts_with(
            "segment 1: from 90.000° at the start of the weld, axis C would have to go on to 450.000°, but its travel \
             is -180.0…180.0°"
        ),
        "{travel}"
    );
    let narrow = machine_with(
        "travel_min = -180.0\ntravel_max = 180.0",
        "travel_min = -100.0\ntravel_max = 100.0",
    );
    let heading = refusal(&circle(90.0, "ccw"), &narrow);
    assert!(
        heading.starts_with("segment 1: axis C cannot stand at 180.000°"),
        "{heading}"
    );
    let stops = machine_with("stays_on_at_rest = true", "stays_on_at_rest = false");
    assert!(refusal(&part_with("", ""), &stops).contains("stops between two motions"));
    let welder = MachineFile::read(&shipped("machines/pipe-welder.toml")).unwrap();
    assert!(refusal(&part_with("", ""), &welder).contains("needs kinematics.stir-gantry"));
}
