//! Saddles by their dimensions: what is refused.

use super::*;

/// The shipped part with `key` set to `value`.
fn with(key: &str, value: &str) -> String {
    let lines = text();
    let lines = lines.lines().map(|line| match line.split_once('=') {
        Some((name, _)) if name.trim() == key => format!("{key} = {value}"),
        _ => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn refusal(text: &str) -> String {
    plan_text(text, &machine()).unwrap_err()
}

#[test]
fn dimensions_that_make_no_seam_are_refused_by_their_key() {
    let cases = [
        (
            "offset_mm",
            "200.0",
            "offset_mm: the pipes do not meet: the offset of 200 mm",
        ),
        (
            "angle_deg",
            "180.0",
            "angle_deg is 180, but must be above 0 and below 180",
        ),
        ("angle_deg", "1e-5", "angle_deg: parallel axes: the pipes are at"),
        (
            "main_diameter_mm",
            "-320.0",
            "main_diameter_mm is -320, but must be above 0",
        ),
        (
            "branch_diameter_mm",
            "nan",
            "branch_diameter_mm is NaN, but must be above 0",
        ),
        (
            "offset_mm",
            "inf",
            "offset_mm is inf, but must be a finite number",
        ),
        (
            "offset_mm",
            "-130.0",
            "branch_diameter_mm, offset_mm: the branch ends 170.00 mm beside the main axis, past or at",
        ),
        (
            "offset_mm",
            "120.0",
            "branch_diameter_mm, offset_mm: the branch ends 160.00 mm beside",
        ),
        ("overlap_mm", "-1.0", "overlap_mm is -1, but must be 0 or more"),
        ("start_deg", "nan", "start_deg is NaN"),
        (
            "speed_mm_s",
            "0.0",
            "speed_mm_s of pass 1 is 0, but must be above 0",
        ),
        ("power_w", "-5.0", "power_w of pass 1 is -5"),
        (
            "radial_mm",
            "-40.0",
            "radial_mm of pass 2 is -40, but must be a number, and not beyond",
        ),
        ("axial_mm", "nan", "axial_mm of pass 2 is NaN"),
    ];
    for (key, value, wanted) in cases {
        let error = refusal(&with(key, value));
        assert!(error.starts_with(wanted), "{key} = {value}: {error}");
        assert_eq!(error.lines().count(), 1);
    }
}

#[test]
fn a_missing_dimension_or_pass_is_named() {
    let without = text().replace("offset_mm = 10.0", "");
    let error = refusal(&without);
    assert!(
        error.starts_with("offset_mm is missing: give it, or teach points"),
        "{error}"
    );
    let start = text().find("# Root.").unwrap();
    let error = refusal(&format!("{}\npasses = []\n", &text()[..start]));
    assert!(error.starts_with("no passes: add [[saddle.passes]]"), "{error}");
}
