//! `seamwright commission` on simulated boards, as a person uses it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::tempdir;

/// A drawn machine whose loops swing with the shipped gains.
const RINGS: &str = "draw:usual:1";
/// One whose drive of A is connected the wrong way round.
const REVERSED: &str = "draw:bad:3002";

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn seamwright(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .args(arguments)
        .args(["--boards", "simulated"])
        .output()
        .expect("it runs")
}

fn commission(machine: &Path, more: &[&str]) -> Output {
    let machine = machine.to_str().expect("a path");
    seamwright(&[&["commission", "--machine", machine], more].concat())
}

fn weld(machine: &Path, report: &Path) -> Output {
    weld_on(RINGS, machine, report)
}

fn weld_on(plant: &str, machine: &Path, report: &Path) -> Output {
    let (program, seam) = (
        shipped("programs/t-seam-400.ngc"),
        shipped("programs/t-seam-400-deviation.csv"),
    );
    let [machine, program, seam, report] =
        [machine, &program, &seam, report].map(|path| path.to_str().expect("a path"));
    seamwright(&[
        "weld",
        program,
        "--machine",
        machine,
        "--seam",
        seam,
        "--report",
        report,
        "--plant",
        plant,
        "--camera",
        "geometric",
    ])
}

#[track_caller]
fn assert_refused(output: &Output, because: &str) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_ne!(output.status.code(), Some(0), "{said}");
    assert!(said.contains(because), "{said}");
}

#[test]
fn every_motor_of_the_other_shipped_machines_is_commissioned() {
    for machine in ["ac-head", "pipe-welder", "stir-gantry", "wire-arc"] {
        let told = commission(&shipped(&format!("machines/{machine}.toml")), &[]);
        let said = String::from_utf8_lossy(&told.stderr);
        assert_eq!(told.status.code(), Some(0), "{machine}: {said}");
    }
}

#[test]
fn a_motor_that_swings_while_it_is_measured_is_measured_again_in_slower_loops() {
    let folder = tempdir().expect("a folder");
    let output = folder.path().join("machine.toml");
    let into = output.to_str().expect("a path");
    let told = commission(
        &shipped("machines/stir-gantry.toml"),
        &["--plant", "draw:usual:1225", "--motors", "X1", "-o", into],
    );
    let said = String::from_utf8_lossy(&told.stdout);
    assert_eq!(told.status.code(), Some(0), "{said}");
    assert!(said.contains("measured again, in slower loops: X1\n"), "{said}");
    let after = std::fs::read_to_string(&output).expect("it is there");
    assert!(after.contains("# commissioned; was 332.6"), "{after}");
}

#[test]
fn a_machine_whose_loops_swing_welds_when_it_is_commissioned() {
    let folder = tempdir().expect("a folder");
    let machine = folder.path().join("machine.toml");
    std::fs::copy(shipped("machines/dual-beam-gantry.toml"), &machine).expect("copied");
    std::fs::copy(
        shipped("machines/dual-beam-gantry.plant.toml"),
        folder.path().join("machine.plant.toml"),
    )
    .expect("copied");
    let report = folder.path().join("report");
    assert_ne!(
        weld(&machine, &report).status.code(),
        Some(0),
        "it welds as it is"
    );

    // What was measured, and nothing written, where no file is named.
    let before = std::fs::read_to_string(&machine).expect("it is there");
    let plots = folder.path().join("plots");
    let into = plots.to_str().expect("a path");
    let told = commission(&machine, &["--plant", RINGS, "--motors", "B", "--report", into]);
    let said = String::from_utf8_lossy(&told.stdout);
    assert_eq!(told.status.code(), Some(0), "{said}");
    assert!(said.contains("before  kp  120.0 1/s  gain margin  -"), "{said}");
    let plot = std::fs::read_to_string(plots.join("B.svg")).expect("a plot");
    let gain_margin = |row: &str| {
        let row = said.lines().find(|line| line.trim_start().starts_with(row));
        let told = row.and_then(|row| row.split_once("gain margin"));
        let (margin, _) = told.and_then(|(_, told)| told.split_once("dB")).expect(&said);
        margin.trim().to_owned()
    };
    let margins = format!(
        "gain margin {} dB, now {} dB",
        gain_margin("before"),
        gain_margin("now")
    );
    for shown in ["Speed for a command", "Coherence", &margins, "100 Hz"] {
        assert!(plot.contains(shown), "{shown}");
    }
    assert_eq!(std::fs::read_to_string(&machine).expect("it is there"), before);

    let output = machine.to_str().expect("a path");
    let commissioned = commission(&machine, &["--plant", RINGS, "-o", output]);
    let said = String::from_utf8_lossy(&commissioned.stdout);
    assert_eq!(commissioned.status.code(), Some(0), "{said}");
    let after = std::fs::read_to_string(&machine).expect("it is there");
    assert!(after.contains("# commissioned; was 120.0"), "{after}");
    assert!(after.contains("friction = { coulomb = "), "{after}");
    assert_eq!(
        after.lines().filter(|line| line.starts_with('#')).count(),
        before.lines().filter(|line| line.starts_with('#')).count(),
    );
    let ended = weld(&machine, &report);
    let said = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(0), "{said}");

    let plot = folder.path().join("circle.svg");
    let plot = plot.to_str().expect("a path");
    let round = circle(&machine, &["--plant", RINGS, "--within", "0.02", "-o", plot]);
    let said = String::from_utf8_lossy(&round.stdout);
    assert_eq!(round.status.code(), Some(0), "{said}");
    assert!(said.contains("circular deviation G(b)"), "{said}");
    assert!(Path::new(plot).metadata().expect("a plot").len() > 10_000);
    let narrow = circle(
        &machine,
        &["--plant", RINGS, "--within", "0.0001", "--speed", "1"],
    );
    assert_eq!(narrow.status.code(), Some(3), "{narrow:?}");
}

#[test]
fn a_machine_that_resonates_at_80_or_40_hz_welds_when_it_is_commissioned() {
    let folder = tempdir().expect("a folder");
    let plant =
        std::fs::read_to_string(shipped("machines/dual-beam-gantry.plant.toml")).expect("it is there");
    let (before, of_y) = plant.split_once("[motors.Y.mechanics]\n").expect("a table");
    for hz in [80, 40] {
        let [file, machine, report] =
            ["plant.toml", "machine.toml", "report"].map(|name| folder.path().join(format!("{hz}-{name}")));
        let mode = format!(
            "modes = [{{ frequency_hz = {hz}.0, damping = 0.05, motor = 0.25, grating = -1.0, tool = -1.0 }}]"
        );
        std::fs::write(&file, format!("{before}[motors.Y.mechanics]\n{mode}\n{of_y}")).expect("written");
        let (plant, output) = (file.to_str().expect("a path"), machine.to_str().expect("a path"));
        let gantry = shipped("machines/dual-beam-gantry.toml");
        let told = commission(&gantry, &["--plant", plant, "--motors", "Y", "-o", output]);
        let said = String::from_utf8_lossy(&told.stdout);
        assert_eq!(told.status.code(), Some(0), "{said}");
        assert!(said.contains("notch at "), "{said}");
        let ended = weld_on(plant, &machine, &report);
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(0), "{said}");
    }
}

/// Shaken at one end only, a beam as stiff as that answered as if it had play.
#[test]
fn a_gantry_with_a_stiff_beam_welds_when_it_is_commissioned() {
    let folder = tempdir().expect("a folder");
    let [plant, machine, report] =
        ["beam.plant.toml", "machine.toml", "report"].map(|name| folder.path().join(name));
    let shipped_plant =
        std::fs::read_to_string(shipped("machines/dual-beam-gantry.plant.toml")).expect("a plant");
    let beam = "[beam]\nyaw_hz = 40.0\ndamping = 0.03\nshare = 0.2\n";
    std::fs::write(&plant, format!("{shipped_plant}\n{beam}")).expect("it is written");
    let [wired, into] = [&plant, &machine].map(|path| path.to_str().expect("a path"));
    let told = commission(
        &shipped("machines/dual-beam-gantry.toml"),
        &["--plant", wired, "--motors", "X1,X2", "-o", into],
    );
    assert_eq!(
        told.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&told.stderr)
    );
    let welded = weld_on(wired, &machine, &report);
    let said = String::from_utf8_lossy(&welded.stderr);
    assert_eq!(welded.status.code(), Some(0), "{said}");
}

#[test]
fn a_drive_that_is_connected_the_wrong_way_round_is_named() {
    let folder = tempdir().expect("a folder");
    let output = folder.path().join("machine.toml");
    let machine = shipped("machines/dual-beam-gantry.toml");
    let told = commission(
        &machine,
        &["--plant", REVERSED, "-o", output.to_str().expect("a path")],
    );
    let said = String::from_utf8_lossy(&told.stdout);
    assert_eq!(told.status.code(), Some(1), "{said}");
    assert!(
        said.contains("A: reversed: its grating moves against its command"),
        "{said}"
    );
    assert!(!output.exists());
}

fn circle(machine: &Path, more: &[&str]) -> Output {
    let machine = machine.to_str().expect("a path");
    seamwright(&[&["circle", "--machine", machine], more].concat())
}

#[test]
fn a_circle_that_cannot_be_made_is_told() {
    let machine = shipped("machines/pipe-welder.toml");
    assert_refused(&circle(&machine, &["--plane", "yz"]), "the machine has no axis Y");
    let machine = shipped("machines/dual-beam-gantry.toml");
    assert_refused(
        &circle(&machine, &["--radius", "2000"]),
        "does not fit into the travel of",
    );
    assert_refused(
        &circle(&machine, &["--radius", "-1"]),
        "must be a number of mm above 0",
    );
}

#[test]
fn what_cannot_be_commissioned_is_told() {
    let machine = shipped("machines/pipe-welder.toml");
    assert_refused(
        &commission(&machine, &["--motors", "Y"]),
        "--motors: the machine has no motor Y; it has X1, Z, B, C",
    );
    assert_refused(
        &commission(&machine, &["--motors", ""]),
        "--motors: the machine has no motor ;",
    );
    assert_refused(&commission(Path::new("none.toml"), &[]), "none.toml");
    let folder = tempdir().expect("a folder");
    let nowhere = folder.path().join("none/machine.toml");
    assert_refused(
        &commission(
            &machine,
            &["--motors", "Z", "-o", nowhere.to_str().expect("a path")],
        ),
        "cannot write",
    );
}
