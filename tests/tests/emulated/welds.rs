//! Jobs that come to their end.

use crate::pair::{Pair, assert_served};
use host_link::boards::simulated::SimulatedBoards;
use host_link::seam::Deviation;
use system_tests::{
    assert_held_weld_goes_on, assert_on_seam, deviations, seam, shipped_seam, short_lines, sines, weld,
};

/// Welds along `seam` on emulated and on simulated boards: no spot leaves its seam, and both agree.
fn assert_welds(name: &str, seam: &Deviation, speed_m_per_min: f64) {
    let mut pair = Pair::boot(name);
    let ended = weld(&mut pair.connect(), seam.clone(), speed_m_per_min);
    assert_on_seam(&ended, 0.05);
    assert_served(&ended.report);
    let figures = ended.report.seam.as_ref().expect("a tracker");
    assert_eq!(figures.measurements.given_up, 0);
    let simulated = weld(&mut SimulatedBoards::default(), seam.clone(), speed_m_per_min);
    let both = deviations(&ended.report)
        .into_iter()
        .zip(deviations(&simulated.report));
    for (emulated, simulated) in both {
        assert!(
            (emulated - simulated).abs() < 0.01,
            "{emulated} and {simulated} mm"
        );
    }
    pair.assert_off();
}

#[test]
fn the_shipped_job_at_5_m_per_min() {
    assert_welds("weld-5", &shipped_seam(), 5.0);
}

#[test]
fn the_shipped_job_at_9_m_per_min() {
    assert_welds("weld-9", &shipped_seam(), 9.0);
}

#[test]
fn a_held_weld_goes_on_over_the_place() {
    let mut pair = Pair::boot("hold");
    let ended = assert_held_weld_goes_on(&mut pair.connect(), 5.0);
    assert_served(&ended.report);
    pair.assert_off();
}

#[test]
fn sines_of_1_mm_at_9_m_per_min() {
    assert_welds("weld-sines", &seam(sines), 9.0);
}

#[test]
fn short_lines_at_6_m_per_min() {
    let mut pair = Pair::boot("short-lines");
    let ended = short_lines(&mut pair.connect());
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_served(&ended.report);
    let contour = ended.report.max_contour_error_mm.expect("no gap");
    assert!(contour < 0.05, "{contour} mm");
    pair.assert_off();
}
