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
