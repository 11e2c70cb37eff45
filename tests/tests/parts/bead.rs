//! The shipped leaf.

use super::*;

#[test]
fn the_shipped_leaf_stays_inside_the_window_and_on_the_nurbs() {
    let part = part_with("programs/leaf.toml", &[]);
    let report = welded(&machine("wire-arc"), &text("programs/leaf.ngc"), &part);
    assert_eq!(exceeded(&report), [""; 0], "{report}");
    assert_eq!(value(&report, "length_outside_window_percent"), 0.0, "{report}");
    assert!(value(&report, "speed_fluctuation_rms_percent") < 0.3, "{report}");
    assert!(value(&report, "speed_fluctuation_max_percent") < 4.0, "{report}");
    // The output filter of the planner takes most of it, in the sharpest corners.
    assert!(value(&report, "contour_error_max_mm") < 0.015, "{report}");
    assert!(
        (value(&report, "bead_length_mm") - 353.95).abs() < 0.1,
        "{report}"
    );
}

/// Where the window cannot be kept, the report says so, with the slowest place.
#[test]
fn corners_below_the_window_are_found_in_the_report() {
    let part = part_with("programs/leaf.toml", &[]);
    let mut slow = machine("wire-arc");
    slow.planning.path_jerk_mm_s3 = 250.0;
    let program = part.plan(&slow, "leaf").unwrap().program;
    let report = welded(&machine("wire-arc"), &program, &part);
    assert_eq!(exceeded(&report), ["length_outside_window_percent"], "{report}");
    assert!(
        (2.9..3.1).contains(&value(&report, "slowest_in_corners_mm_s")),
        "{report}"
    );
    // Friction turns with an axis: the slower the tip, the more it is felt.
    assert!(value(&report, "speed_fluctuation_rms_percent") < 0.6, "{report}");
    assert!(value(&report, "contour_error_max_mm") < 0.01, "{report}");
}
