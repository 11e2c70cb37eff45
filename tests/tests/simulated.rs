//! The shipped job and other seams on simulated boards: accuracy, the report's fields, the same bytes in every
//! run.

use report::Ended;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;
use system_tests::{assert_held_weld_goes_on, assert_on_seam, kinks, seam, shipped_seam, sines, slopes};
use world::Deviation;
use world::simulated::SimulatedBoards;

fn weld(seam: Deviation, speed_m_per_min: f64) -> Ended {
    system_tests::weld(&mut SimulatedBoards::default(), seam, speed_m_per_min)
}

/// Every file of the report, by name.
fn report_files(ended: &Ended, name: &str) -> BTreeMap<String, Vec<u8>> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    report::write(&folder, ended).expect("a report");
    let files = std::fs::read_dir(&folder).expect("the report's folder");
    files
        .map(|file| {
            let path = file.expect("a file").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read(&path).expect("a file of the report"))
        })
        .collect()
}

#[test]
fn the_shipped_job_stays_on_both_seams_at_5_and_9_m_per_min() {
    for speed in [5.0, 9.0] {
        assert_on_seam(&weld(shipped_seam(), speed), 0.03);
    }
}

#[test]
fn a_held_weld_goes_on_over_the_place() {
    for speed in [1.0, 5.0, 9.0] {
        assert_held_weld_goes_on(&mut SimulatedBoards::default(), speed);
    }
}

#[test]
fn sines_slopes_and_kinks_are_followed_from_1_to_9_m_per_min() {
    for speed in [1.0, 5.0, 9.0] {
        for deviation in [sines, slopes, kinks] {
            assert_on_seam(&weld(seam(deviation), speed), 0.05);
        }
    }
}

#[test]
fn two_runs_leave_the_same_bytes() {
    let first = report_files(&weld(shipped_seam(), 9.0), "first");
    let second = report_files(&weld(shipped_seam(), 9.0), "second");
    let names: Vec<&str> = first.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "following-error.svg",
            "log.csv",
            "report.json",
            "seam-deviation.svg",
            "speed.svg"
        ]
    );
    for (name, bytes) in &first {
        assert!(bytes == &second[name], "{name} differs");
    }
    let lines = first["log.csv"].split(|byte| *byte == b'\n').count();
    assert!(lines > 2600, "{lines} lines for a weld of 2.7 s");
}

#[test]
fn the_report_tells_every_figure() {
    let files = report_files(&weld(shipped_seam(), 5.0), "figures");
    let report: Value = serde_json::from_slice(&files["report.json"]).expect("JSON");
    let number = |path: &str| {
        let value = report.pointer(path).and_then(Value::as_f64);
        value.unwrap_or_else(|| panic!("{path} is no number in {report:#}"))
    };
    assert!((number("/speed_m_per_min") - 5.0).abs() < 1e-9);
    for slide in ["u1", "v1", "u2", "v2"] {
        let max = number(&format!("/max_deviation_mm/{slide}"));
        let rms = number(&format!("/rms_deviation_mm/{slide}"));
        assert!(0.0 < rms && rms < max, "{slide}: {rms} and {max}");
    }
    for motor in ["X1", "X2", "Y", "Z", "A", "B", "C"] {
        assert!(number(&format!("/max_following_error/{motor}")) > 0.0);
    }
    assert!(number("/max_contour_error_mm") > 0.0);
    assert!(number("/max_gantry_skew_um") > 0.0);
    assert_eq!(report["lost_ticks"]["motion"], 0);
    assert_eq!(report["lost_ticks"]["tracker"], 0);
    assert!(number("/clock_residual_us") >= 0.0);
    assert!(number("/duration_s") > 4.8);
    assert_eq!(report["faults"], Value::Array(Vec::new()));
}
