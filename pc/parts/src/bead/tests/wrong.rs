//! What cannot be a bead is said with its name and place.

use super::*;

fn error(part: &str) -> String {
    match plan(part, &machine()) {
        Ok(plan) => panic!("planned: {:?}", plan.notes),
        Err(error) => format!("{error:#}"),
    }
}

/// The quarter with one of its lines changed.
fn changed(from: &str, to: &str) -> String {
    assert!(QUARTER.contains(from), "{from}");
    error(&QUARTER.replace(from, to))
}

#[test]
fn a_wrong_nurbs_is_named_by_key_and_index() {
    for (from, to, wanted) in [
        (
            "knots = [0, 0, 0, 1, 1, 1]",
            "knots = [0, 0, 0.5, 0.2, 1, 1]",
            "[bead.nurbs], knots: knots decrease: knot 3",
        ),
        (
            "knots = [0, 0, 0, 1, 1, 1]",
            "knots = [0, 0, 0, 1, 1]",
            "[bead.nurbs], knots: knot count: 5 given",
        ),
        (
            "knots = [0, 0, 0, 1, 1, 1]",
            "knots = [0, 0, 0, 0, 1, 1]",
            "[bead.nurbs], knots: knot multiplicity: knot 0",
        ),
        (
            "0.7071067811865476, 1.0]",
            "-0.5, 1.0]",
            "[bead.nurbs], weights: weights: weight 1 is -0.5",
        ),
        (
            "0.7071067811865476, 1.0]",
            "0.5]",
            "[bead.nurbs], weights: weights: 2 given for 3",
        ),
        (
            "degree = 2",
            "degree = 3",
            "[bead.nurbs], control_points_mm: too few control points: 3 for degree 3",
        ),
        ("degree = 2", "degree = -2", "invalid value"),
        ("degree = 2", "degree = 2\ncolour = 3", "unknown field `colour`"),
        (
            "[30.0, 30.0, 0.0]",
            "[nan, 30.0, 0.0]",
            "[bead.nurbs], control_points_mm: control point 1 is not finite",
        ),
        (
            "[30.0, 30.0, 0.0]",
            "[30.0, 0.0, 0.0]",
            "no direction at parameter 0 near (30.000, 0.000, 0.000) mm",
        ),
    ] {
        let error = changed(from, to);
        assert!(error.contains(wanted), "{error}\nwanted: {wanted}");
    }
}

#[test]
fn a_kink_is_named_with_its_place() {
    let kinked = "\
[bead]
lead_mm = 5.0
power_w = 1500.0
[bead.nurbs]
degree = 1
control_points_mm = [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [20.0, 15.0, 0.0]]
knots = [0, 0, 1, 2, 2]
";
    let error = error(kinked);
    assert!(
        error.contains("a kink of 90.0° at parameter 1 near (20.000, 0.000, 0.000) mm"),
        "{error}"
    );
}

#[test]
fn a_part_says_what_is_missing_or_out_of_range() {
    let nurbs = QUARTER.find("[bead.nurbs]").unwrap();
    assert!(error(&QUARTER[..nurbs]).contains("give either nurbs_file or the table"));
    for (from, to, wanted) in [
        (
            "lead_mm = 5.0",
            "lead_mm = 5.0\nnurbs_file = \"leaf.json\"",
            "give either nurbs_file or the table",
        ),
        (
            "lead_mm = 5.0",
            "lead_mm = -1.0",
            "lead_mm is -1, but must be above 0",
        ),
        (
            "lead_mm = 5.0",
            "lead_mm = 0.5",
            "to reach 16.00 mm/s before the arc burns; lengthen it",
        ),
        (
            "lead_mm = 5.0",
            "lead_mm = 5.0\nlayers = 3",
            "layer_height_mm is 0, but must be above 0 where",
        ),
        (
            "lead_mm = 5.0",
            "lead_mm = 5.0\nlayers = 0",
            "layers is 0, but must be at least 1",
        ),
        (
            "power_w = 1500.0",
            "power_w = 0.0",
            "power_w is 0, but must be above 0",
        ),
        (
            "[4.0, 16.0]",
            "[16.0, 4.0]",
            "window_mm_s: the process window from 16 to 4 mm/s is empty",
        ),
        (
            "lead_mm = 5.0",
            "lead_mm = 5.0\nlayers = 80\nlayer_height_mm = 2.0",
            "safe_height_mm must be 10 mm above it",
        ),
        ("power_w = 1500.0", "power_w = 9000.0", "9000 W"),
        (
            "[30.0, 30.0, 0.0]",
            "[1000.0, 1000.0, 0.0]",
            "axis Y would have to go",
        ),
    ] {
        let error = changed(from, to);
        assert!(error.contains(wanted), "{error}\nwanted: {wanted}");
    }
    let long = leaf().replace("lead_mm = 3.0", "lead_mm = 300.0");
    assert!(
        error(&long).contains("but the closed bead is only 352.0"),
        "{}",
        error(&long)
    );
    let lost = leaf().replace("leaf.json", "lost.json");
    assert!(error(&lost).contains("cannot read") && error(&lost).contains("lost.json"));
    let not_json = leaf().replace("leaf.json", "leaf.toml");
    assert!(
        error(&not_json).contains("leaf.toml: expected value at line 1"),
        "{}",
        error(&not_json)
    );
}

/// A window is the part's, or the machine's, or there is none.
#[test]
fn without_a_process_window_there_is_no_speed() {
    let part = QUARTER.replace("window_mm_s = [4.0, 16.0]\n", "");
    let speed = |machine: &MachineFile| plan(&part, machine).map(|plan| plan.notes[3].clone());
    assert!(speed(&machine()).unwrap().contains("window of 4 to 16 mm/s"));
    let bare = MachineFile {
        process: None,
        ..machine()
    };
    assert!(speed(&bare).unwrap_err().to_string().contains("give window_mm_s"));
}

/// Waves of 0.3 mm for half a metre: no 512 points follow them.
#[test]
fn a_bead_of_too_many_points_is_refused_with_the_number() {
    let count = 700;
    let points: Vec<String> = (0..count)
        .map(|i| format!("[{}, {}, 0.0]", f64::from(i) * 0.7, 0.6 * f64::from(i % 2)))
        .collect();
    let knots: Vec<String> = (0..count + 4).map(|i| i.to_string()).collect();
    let part = format!(
        "[bead]\nlead_mm = 3.0\npower_w = 1500.0\n[bead.nurbs]\ndegree = 3\ncontrol_points_mm = [{}]\nknots = [{}]\n",
        points.join(", "),
        knots.join(", ")
    );
    let error = error(&part);
    assert!(
        error.contains("more than the 512 points") && error.contains("near ("),
        "{error}"
    );
}
