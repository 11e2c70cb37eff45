//! The shipped saddle.

use super::*;

#[test]
fn the_shipped_job_stays_on_the_saddle_with_drives_and_gratings() {
    let part = part_with("programs/saddle-320-80.toml", &[]);
    let report = welded(
        &machine("pipe-welder"),
        &text("programs/saddle-320-80.ngc"),
        &part,
    );
    println!("{report}");
    assert_eq!(exceeded(&report), [""; 0], "{report}");
    let figures = &report.figures;
    assert_eq!(figures.len(), 7);
    // Once around and 5 mm on, twice.
    assert!((figures[4].value - 528.9).abs() < 0.2, "{:?}", figures[4]);
    assert!(figures[5].value < 0.1, "{:?}", figures[5]);
}
