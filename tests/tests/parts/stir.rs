//! Friction-stir welds.

use super::*;

#[test]
fn the_shipped_weld_keeps_its_limits_on_simulated_boards() {
    let part = part_with("programs/stir-contour.toml", &[]);
    let report = welded(&machine("stir-gantry"), &text("programs/stir-contour.ngc"), &part);
    assert_eq!(exceeded(&report), [""; 0], "{report}");
    // Far below what is published, as gratings close the loops.
    assert!(value(&report, "max_heading_error_deg") < 0.004, "{report}");
    // Where the first arc begins: Y has stood since homing, and static friction holds it until the loop pushes.
    assert!(value(&report, "max_contour_distance_mm") < 0.0015, "{report}");
    for key in ["mae_x_mm", "mae_y_mm"] {
        assert!(value(&report, key) < 0.002, "{report}");
    }
    assert!((2.5..2.7).contains(&value(&report, "preheat_s")), "{report}");
}

/// A full circle that C cannot turn through at once: the pin is lifted and plunged again at the same place.
#[test]
fn a_weld_in_two_passes_keeps_its_limits_on_simulated_boards() {
    let file = shipped("programs/stir-contour.toml");
    let text = text("programs/stir-contour.toml");
    let (head, _) = text.split_once("start =").unwrap();
    let text = format!(
        "{head}rewind = true\nstart = [430.0, 225.0]\n\
         contour = [{{ arc_to = [430.0, 225.0], centre = [400.0, 225.0], turn = \"ccw\" }}]\n"
    );
    let part = PartFile::parse(&file, &text).unwrap();
    let machine = machine("stir-gantry");
    let program = part.plan(&machine, "circle").unwrap().program;
    let report = welded(&machine, &program, &part);
    assert_eq!(exceeded(&report), [""; 0], "{report}");
    // Both passes start on the arc: the slides stick for the first 5 µm, and C is that much ahead of the tip.
    assert!(value(&report, "max_contour_distance_mm") < 0.005, "{report}");
    assert!(value(&report, "preheat_s") > 2.5, "{report}");
}
