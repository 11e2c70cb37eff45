//! What moves nothing: a job that is refused, and a first look at the boards.

use crate::pair::{Pair, scratch, told};
use emulator::{PROGRAM_VARIABLES, SESSION_VARIABLE, bound_to_parent};
use plant_file::DEFAULT_MACHINE;
use std::fs;
use std::process::Output;
use system_tests::{MACHINE, PROGRAM, seam_file, shipped};

/// Beyond the travel of V2 in the middle of the weld.
fn far(s: f64) -> [f64; 4] {
    [0.0, 0.0, 0.0, 13.0 - (s - 200.0).abs() / 20.0]
}

#[test]
fn a_refused_job_leaves_the_drives_off() {
    let name = "refused";
    let pair = Pair::boot(name, DEFAULT_MACHINE);
    let seam = scratch(name).join("far.csv");
    fs::write(&seam, seam_file(far)).expect("the scratch folder is writable");
    let mut weld = bound_to_parent(told(PROGRAM_VARIABLES[0]));
    weld.args([
        "weld",
        "--boards",
        "emulated",
        "--camera",
        "geometric",
        "--machine",
    ])
    .arg(shipped(MACHINE))
    .arg("--seam")
    .arg(&seam)
    .arg("--report")
    .arg(scratch(name).join("report"))
    .arg(shipped(PROGRAM))
    .env(SESSION_VARIABLE, scratch(name).join("session.toml"));
    let Output { status, stderr, .. } = weld.output().expect("seamwright");
    let said = String::from_utf8_lossy(&stderr);
    assert_eq!(status.code(), Some(1), "{said}");
    assert!(
        said.contains("V2") && said.contains("beyond its travel"),
        "{said}"
    );
    pair.assert_off();
}

/// Addresses at which the boards have their own ports.
const AT: &str = "127.0.71.11,127.0.71.12";

/// The boards' time is slower than the PC's clock on a busy computer, so their ticks are not judged.
#[test]
fn a_probe_without_hands_finds_both_boards_good() {
    let pair = Pair::boot_with("probe", DEFAULT_MACHINE, &["--at", AT]);
    let mut probe = bound_to_parent(told(PROGRAM_VARIABLES[0]));
    probe
        .args(["probe", AT, "--no-hands", "--machine"])
        .arg(shipped(MACHINE));
    let shown = probe.output().expect("seamwright").stdout;
    let shown = String::from_utf8_lossy(&shown);
    println!("{shown}");
    for board in ["motion board", "tracker board"] {
        let (_, steps) = shown.split_once(board).expect(board);
        for step in ["requests", "converters", "drives off"] {
            let line = steps.lines().find(|line| line.contains(step)).expect(step);
            assert!(line.trim_start().starts_with("good"), "{board}: {line}");
        }
    }
    pair.assert_off();
}
