//! `seamwright pivots` on simulated boards, as a person uses it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::tempdir;

/// A head whose A axis is not under C, and a nozzle that is longer than believed.
const TRULY: &str = "[kinematics.ac-head]\no1_mm = [0.04, -0.03, -120.0]\no2_mm = [0.02, 0.05, -180.12]\n";

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn pivots(machine: &Path, more: &[&str]) -> Output {
    let machine = machine.to_str().expect("a path");
    Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .args(["pivots", "--machine", machine, "--boards", "simulated"])
        .args(more)
        .output()
        .expect("it runs")
}

#[track_caller]
fn ended(output: &Output, code: i32) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(code), "{out}{err}");
    (out, err)
}

#[test]
fn a_head_with_wrong_arms_is_measured_and_has_its_tip_in_place_then() {
    let folder = tempdir().expect("a folder");
    let [plant, found] = ["my.plant.toml", "machine.toml"].map(|name| folder.path().join(name));
    let text = std::fs::read_to_string(shipped("machines/ac-head.plant.toml")).expect("a plant");
    std::fs::write(&plant, format!("{text}\n{TRULY}")).expect("it is written");
    let [wired, into] = [&plant, &found].map(|path| path.to_str().expect("a path"));
    let (told, said) = ended(
        &pivots(
            &shipped("machines/ac-head.toml"),
            &["--plant", wired, "-o", into, "--within", "0.01"],
        ),
        3,
    );
    assert!(said.contains("and may be 0.01"), "{said}");
    assert!(
        told.contains("9 attitudes with the tip at 1500.0, 750.0 and 100.0 mm"),
        "{told}"
    );
    assert!(told.contains("-180.1200 mm, was -180.0000"), "{told}");
    let written = std::fs::read_to_string(&found).expect("it was written");
    let sum = written
        .lines()
        .filter(|line| line.starts_with("o1_mm") || line.starts_with("o2_mm"));
    assert_eq!(
        sum.collect::<Vec<_>>(),
        [
            "o1_mm = [0.03, -0.03, -120.0] # commissioned; was [0.0, 0.0, -120.0]",
            "o2_mm = [0.03, 0.05, -180.12] # commissioned; was [0.0, 0.0, -180.0]"
        ]
    );
    ended(&pivots(&found, &["--plant", wired, "--within", "0.002"]), 0);
}

#[test]
fn a_table_that_was_measured_is_read() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("dial.csv");
    let into = folder.path().join("machine.toml");
    let machine = shipped("machines/pipe-welder.toml");
    let measured = |text: &str| {
        std::fs::write(&file, text).expect("it is written");
        let [file, into] = [&file, &into].map(|path| path.to_str().expect("a path"));
        pivots(&machine, &["--measured", file, "-o", into])
    };
    let (_, said) = ended(&measured("x_mm,y_mm,z_mm\n0,0,0\n"), 1);
    assert!(
        said.contains("dial.csv has 1 rows, and the test has 5 attitudes: give the same --at"),
        "{said}"
    );
    let (_, said) = ended(&measured("x_mm,y_mm\n0,0\n"), 1);
    assert!(said.contains("dial.csv"), "{said}");
    assert!(!into.exists());

    // A work that lies elsewhere, 0.4 mm along x, is no arm.
    let (told, _) = ended(
        &measured(&format!("x_mm,y_mm,z_mm\n{}", "0.4,0,0\n".repeat(5))),
        0,
    );
    assert!(told.contains("60.0000 mm, was 60.0000"), "{told}");
    let written = std::fs::read_to_string(&into).expect("it was written");
    assert!(!written.contains("# commissioned; was"), "{written}");
}

#[test]
fn what_cannot_be_measured_is_told() {
    let machine = shipped("machines/ac-head.toml");
    let (_, said) = ended(&pivots(&machine, &["--at", "10,10"]), 1);
    assert!(said.contains("--at: give three numbers"), "{said}");
    let (_, said) = ended(&pivots(&machine, &["--at", "-900,10,10"]), 1);
    assert!(
        said.contains("of 9 attitudes the machine takes 0 with the tip at -900, 10 and 10 mm: choose another place (--at)"),
        "{said}"
    );
    let (_, said) = ended(&pivots(&machine, &["--swing", "0"]), 2);
    assert!(said.contains("from 1 to 180 degrees"), "{said}");
}
