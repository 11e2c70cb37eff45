//! The limits of a part file decide about the exit code of `seamwright weld`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// A file of this test's own, with `text`.
fn scratch(name: &str, text: &str) -> PathBuf {
    let directory = std::env::temp_dir().join(format!("seamwright-verdict-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let path = directory.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// Exit code and standard error.
fn told(output: &Output) -> (Option<i32>, String) {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), text)
}

/// The shipped weld, judged by the shipped part with another limit of the deviation.
fn weld(deviation_mm: &str) -> Output {
    let part = std::fs::read_to_string(shipped("programs/t-seam-400.toml")).unwrap();
    let limit = "deviation_mm = 0.05";
    assert!(part.contains(limit));
    let part = part.replace(limit, &format!("deviation_mm = {deviation_mm}"));
    let name = format!("part-{}.toml", deviation_mm.replace('.', "-"));
    Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .arg("weld")
        .arg(shipped("programs/t-seam-400.ngc"))
        .arg("--machine")
        .arg(shipped("machines/dual-beam-gantry.toml"))
        .arg("--seam")
        .arg(shipped("programs/t-seam-400-deviation.csv"))
        .args(["--boards", "simulated", "--camera", "geometric", "--part"])
        .arg(scratch(&name, &part))
        .arg("--report")
        .arg(scratch("report", "").with_extension("dir"))
        .output()
        .unwrap()
}

#[test]
fn a_weld_beyond_the_limits_of_its_part_ends_with_exit_code_3() {
    let (code, text) = told(&weld("0.05"));
    assert_eq!(code, Some(0), "{text}");
    let (code, text) = told(&weld("0.001"));
    assert_eq!(code, Some(3), "{text}");
    let verdict = text.lines().last().unwrap_or_default();
    assert!(
        verdict
            .starts_with("seamwright: the weld is outside its limits: side 1, spot beside seam, across (U)")
            && verdict.contains("may be 0.0010 mm"),
        "{text}"
    );
}

#[test]
fn a_limit_that_makes_no_sense_is_refused_with_its_line() {
    for wrong in ["-0.05", "nan", "inf"] {
        let (code, text) = told(&weld(wrong));
        assert_eq!(code, Some(1), "{text}");
        assert!(
            text.contains("line 12") && text.contains("a limit must be a number of 0 or more"),
            "{text}"
        );
    }
}

/// The shipped weld at 9 m/min before the cameras `camera`, judged by the shipped part with `more` limits.
fn joint(camera: &str, more: &str, report: &str) -> Output {
    let part = std::fs::read_to_string(shipped("programs/t-seam-400.toml")).unwrap();
    let waves = "gap_mm = 0.12\ngap_wave_mm = 0.04\ngap_wave_length_mm = 90.0\n";
    let file = scratch(&format!("{report}-scene.toml"), waves);
    let scene = (camera == "images").then(|| [PathBuf::from("--scene"), file]);
    let scene = scene.into_iter().flatten();
    Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .arg("weld")
        .arg(shipped("programs/t-seam-400.ngc"))
        .arg("--machine")
        .arg(shipped("machines/dual-beam-gantry.toml"))
        .arg("--seam")
        .arg(shipped("programs/t-seam-400-deviation.csv"))
        .args([
            "--boards",
            "simulated",
            "--speed",
            "9",
            "--camera",
            camera,
            "--part",
        ])
        .arg(scratch(&format!("{report}.toml"), &format!("{part}\n{more}\n")))
        .args(scene)
        .arg("--report")
        .arg(scratch(report, "").with_extension("dir"))
        .output()
        .unwrap()
}

/// The gap is widest, 0.16 mm, at s = 22.5 mm of side 1 and every 90 mm from there, and 0.3 · 90 mm before of side 2.
#[test]
fn a_gap_beyond_the_limits_of_its_part_ends_with_exit_code_3_and_its_place() {
    let (code, text) = told(&joint(
        "images",
        "gap_width_mm = [0.05, 0.15]\nhi_lo_mm = 0.1",
        "wide",
    ));
    assert_eq!(code, Some(3), "{text}");
    let verdict = text.lines().last().unwrap_or_default();
    let widest = |side: usize| {
        let (_, after) = verdict
            .split_once(&format!("side {side}, gap of the joint, widest "))
            .unwrap();
        let mut words = after.split_whitespace();
        let width: f64 = words.next().unwrap().parse().unwrap();
        let at: f64 = words.nth(4).unwrap().parse().unwrap();
        (width, at)
    };
    for (side, from) in [(1, 22.5), (2, 22.5 - 27.0)] {
        let (width, at) = widest(side);
        assert!((width - 0.16).abs() < 0.005, "{verdict}");
        // As flat as the wave is there, a micrometre is 3 mm.
        let beside = (at - from + 45.0).rem_euclid(90.0) - 45.0;
        assert!(beside.abs() < 6.0, "{beside} mm beside: {verdict}");
    }
    assert!(verdict.contains("(may be 0.1500 mm)"), "{verdict}");
    for absent in ["narrowest", "hi-lo", "not judged"] {
        assert!(!text.contains(absent), "{text}");
    }
    let report = scratch("wide", "").with_extension("dir");
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(report.join("report.json")).unwrap()).unwrap();
    let mean = json["joint"][0]["gap_width"]["mean_mm"].as_f64().unwrap();
    assert!((mean - 0.12).abs() < 0.005, "{mean}");
    assert!(report.join("joint.svg").is_file() && report.join("joint.csv").is_file());
}

#[test]
fn limits_of_the_joint_that_no_picture_tells_of_are_named_and_keep_nobody_from_going_on() {
    let (code, text) = told(&joint("geometric", "gap_width_mm = [0.0, 0.15]", "blind"));
    assert_eq!(code, Some(0), "{text}");
    for side in [1, 2] {
        let wanted = format!("seamwright: not judged: side {side}, gap_width_mm: no picture showed a gap");
        assert!(text.contains(&wanted), "{text}");
    }
    let report = scratch("blind", "").with_extension("dir");
    let json = std::fs::read_to_string(report.join("report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json["joint"][0]["gap_width"].is_null());
    assert_eq!(json["not_judged"].as_array().map(Vec::len), Some(2));
    assert!(!report.join("joint.svg").exists());
}

#[test]
fn limits_of_a_gap_are_in_their_order_and_refused_with_their_line() {
    for wrong in [
        "gap_width_mm = [0.2, 0.1]",
        "gap_width_mm = [-0.1, 0.1]",
        "gap_width_mm = [0.1, inf]",
    ] {
        let (code, text) = told(&joint("geometric", wrong, "wrong"));
        assert_eq!(code, Some(1), "{text}");
        assert!(
            text.contains("the smaller one first") && text.contains("line 22"),
            "{text}"
        );
    }
}

/// Before anything is taught, and once.
#[test]
fn a_feed_that_no_drive_allows_is_refused_before_a_panel_is_taught() {
    let part = std::fs::read_to_string(shipped("programs/panel.toml")).unwrap();
    let part = part.replacen("speed_m_min = 2.0", "speed_m_min = 12.0", 1);
    let output = Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .arg("weld")
        .arg(scratch("panel.toml", &part))
        .arg("--machine")
        .arg(shipped("machines/ac-head.toml"))
        .args(["--boards", "simulated", "--report"])
        .arg(scratch("report", "").with_extension("panel"))
        .output()
        .unwrap();
    let (code, text) = told(&output);
    assert_eq!(code, Some(1), "{text}");
    assert!(!text.contains("teaching"), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(
        text.contains("speed_m_min is 12, and may be 2.8") && text.contains("guide point"),
        "{text}"
    );
}
