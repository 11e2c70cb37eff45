//! `seamwright positioning`, as a person uses it.

use config::machine::MachineFile;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::tempdir;

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn positioning(machine: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .args(["positioning", "--boards", "simulated", "--machine"])
        .arg(machine)
        .args(more)
        .output()
        .expect("it runs")
}

#[track_caller]
fn said(output: &Output, code: i32) -> String {
    let said = [&output.stdout, &output.stderr].map(|said| String::from_utf8_lossy(said));
    assert_eq!(output.status.code(), Some(code), "{said:?}");
    said.concat()
}

#[track_caller]
fn assert_refused(output: &Output, because: &str) {
    let said = said(output, 1);
    assert!(said.contains(because), "{said}");
}

/// Values of the table of deviations of a motor along an axis, with the places they are of.
fn table(machine: &Path, motor: usize, axis: usize) -> Vec<(f64, f64)> {
    let machine = MachineFile::read(machine).expect("a machine file");
    let mut tables = machine.deviations.iter();
    let table = tables
        .find(|table| (usize::from(table.motor), usize::from(table.axis)) == (motor, axis))
        .expect("a table");
    let place = |k| table.from + table.step * f64::from(k);
    (0..)
        .map(place)
        .zip(table.values.iter().map(|value| f64::from(*value)))
        .collect()
}

/// Ranges of mean deviations that were told \[µm\].
fn ranges(said: &str) -> Vec<f64> {
    let rows = said.lines().filter(|line| line.contains("range of the mean M"));
    rows.map(|row| {
        row.split_whitespace()
            .nth(5)
            .and_then(|word| word.parse().ok())
            .expect(row)
    })
    .collect()
}

/// A deviation \[mm\] of X \[mm\].
type Deviation<'a> = &'a dyn Fn(f64) -> f64;

/// The gantry with gratings that are too long or too short, Y not square to X and not straight, and Z neither: its plant file.
fn crooked(folder: &Path) -> PathBuf {
    let mut text =
        std::fs::read_to_string(shipped("machines/dual-beam-gantry.plant.toml")).expect("it is there");
    for (motor, pitch) in [("X1", 10e-6), ("X2", -15e-6), ("Y", 8e-6)] {
        let table = format!("[motors.{motor}.grating]\n");
        assert!(text.contains(&table));
        text = text.replace(&table, &format!("{table}pitch_error = {pitch}\n"));
    }
    text += "[geometry.Y.X]\nslope = -2e-5\nwave = { amplitude = 0.004, period = 1600.0 }\n\
             [geometry.Z.X]\nslope = 3e-5\nwave = { amplitude = 0.01, period = 2500.0 }\n";
    let file = folder.join("crooked.plant.toml");
    std::fs::write(&file, text).expect("written");
    file
}

#[test]
fn scales_straightness_and_squareness_are_found_and_made_up_for() {
    let folder = tempdir().expect("a folder");
    let plant = crooked(folder.path());
    let machine = folder.path().join("machine.toml");
    let gantry = shipped("machines/dual-beam-gantry.toml");
    let [plant, output, report] = [&plant, &machine, &folder.path().join("report")]
        .map(|path| path.to_str().expect("a path").to_owned());
    let x = [
        "--axis",
        "X",
        "--of",
        "X1,X2,Y,Z",
        "--runs",
        "1",
        "--dwell",
        "0.5",
        "--plant",
        &plant,
    ];
    let first = positioning(&gantry, &[&x[..], &["-o", &output, "--report", &report]].concat());
    let before = ranges(&said(&first, 0));

    // By the plant file: X from its mark, the others as X goes.
    let mark = 20.0;
    let wave = |amplitude: f64, period: f64, x: f64| amplitude * (std::f64::consts::TAU * x / period).sin();
    let truth: [(usize, &str, Deviation); 4] = [
        (0, "X1", &|x| -10e-6 * x),
        (1, "X2", &|x| 15e-6 * x),
        (2, "Y", &|x| -2e-5 * x + wave(0.004, 1600.0, x)),
        (3, "Z", &|x| 3e-5 * x + wave(0.01, 2500.0, x)),
    ];
    for (motor, of, deviation) in truth {
        for (x, found) in table(&machine, motor, 0) {
            let expected = deviation(x) - deviation(mark);
            assert!(
                (found - expected).abs() < 0.001,
                "{of} at {x}: {found} {expected}"
            );
        }
        assert!(folder.path().join(format!("report/{of}-along-X.svg")).exists());
    }
    // What was written makes up for it: the machine is measured again, and what is left is added.
    let again = positioning(&machine, &[&x[..], &["-o", &output]].concat());
    let after = ranges(&said(&again, 0));
    assert_eq!((before.len(), after.len()), (4, 4));
    for (before, after) in before.iter().zip(&after) {
        println!("{before} µm before, {after} after");
        assert!(
            *before > 10.0 && *after < 1.0,
            "{before} µm before, {after} after"
        );
    }
    for (x, found) in table(&machine, 3, 0) {
        let expected = truth[3].2(x) - truth[3].2(mark);
        assert!((found - expected).abs() < 0.001, "again, {x}: {found} {expected}");
    }
    let comments = |file: &Path| {
        let text = std::fs::read_to_string(file).expect("it is there");
        text.lines().filter(|line| line.starts_with('#')).count()
    };
    assert_eq!(comments(&machine), comments(&gantry));

    // What it may be off.
    let y = [
        "--axis",
        "y",
        "--runs",
        "1",
        "--dwell",
        "0.5",
        "--targets",
        "5",
        "--plant",
        &plant,
    ];
    said(
        &positioning(&machine, &[&y[..], &["--within", "0.05"]].concat()),
        0,
    );
    let told = said(
        &positioning(&machine, &[&y[..], &["--within", "0.005"]].concat()),
        3,
    );
    assert!(told.contains("the axis was up to 0.0"), "{told}");
}

#[test]
fn what_an_interferometer_measured_is_read() {
    let folder = tempdir().expect("a folder");
    let machine = folder.path().join("machine.toml");
    let csv = folder.path().join("y.csv");
    let head = shipped("machines/ac-head.toml");
    let [output, measured] = [&machine, &csv].map(|path| path.to_str().expect("a path"));
    // There and back twice; the mark of Y is at 20.
    let run = "20,0.5\n520,3.5\n1020,7.5\n1020,6.5\n520,2.5\n20,-0.5\n";
    let read = |text: &str, more: &[&str]| {
        std::fs::write(&csv, text).expect("written");
        positioning(&head, &[&["--axis", "Y", "--measured", measured], more].concat())
    };
    let told = said(
        &read(&format!("target_mm,deviation_um\n{run}{run}"), &["-o", output]),
        0,
    );
    for row in [
        "reversal value B       1.00 µm",
        "repeatability R        1.00 µm",
        "range of the mean M    7.00 µm",
    ] {
        assert!(told.contains(row), "{told}");
    }
    let found = table(&machine, 2, 1);
    for ((place, value), expected) in found
        .into_iter()
        .zip([(20.0, 0.0), (520.0, 0.003), (1020.0, 0.007)])
    {
        assert!(
            place == expected.0 && (value - expected.1).abs() < 1e-6,
            "{place}: {value}"
        );
    }

    assert_refused(
        &read(&format!("target,deviation\n{run}"), &[]),
        "the header must be target_mm,deviation_um",
    );
    assert_refused(
        &read("target_mm,deviation_um\n20,0\n520,1\n1020,3\n", &[]),
        "was approached only from below",
    );
    assert_refused(
        &read("target_mm,deviation_um\n20,0\n20,0\n", &[]),
        "at least 2 are needed",
    );
    assert_refused(
        &read("target_mm,deviation_um\n20,zero\n", &[]),
        "\"zero\" is not a finite number",
    );
    assert_refused(
        &read(&format!("target_mm,deviation_um\n{run}"), &["--of", "X,Y"]),
        "is of one thing",
    );
    assert_refused(
        &read(
            &format!("target_mm,deviation_um\n{}", run.replace("7.5", "7500")),
            &["-o", output],
        ),
        "deviations.Y.Y",
    );
}

#[test]
fn what_cannot_be_tested_is_told() {
    let machine = shipped("machines/pipe-welder.toml");
    assert_refused(
        &positioning(&machine, &["--axis", "Y"]),
        "the machine has no axis Y; it has X, Z, B, C",
    );
    assert_refused(
        &positioning(&machine, &["--axis", "X", "--of", "X2"]),
        "the machine has no axis or motor X2; it has X1, Z, B, C",
    );
    for wrong in [
        ["--targets", "1"],
        ["--runs", "0"],
        ["--dwell", "0"],
        ["--within", "-1"],
    ] {
        let output = positioning(&machine, &[&["--axis", "X"][..], &wrong[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn every_axis_of_the_shipped_machines_is_tested() {
    for (machine, axes) in [
        ("dual-beam-gantry", "XYZABC"),
        ("pipe-welder", "XZBC"),
        ("ac-head", "XYZAC"),
        ("wire-arc", "XYZABC"),
        ("stir-gantry", "XYZBC"),
    ] {
        let machine = shipped(&format!("machines/{machine}.toml"));
        for axis in axes.chars() {
            let axis = axis.to_string();
            let told = positioning(
                &machine,
                &[
                    "--axis",
                    &axis,
                    "--targets",
                    "5",
                    "--runs",
                    "1",
                    "--within",
                    "0.005",
                ],
            );
            let told = said(&told, 0);
            assert!(told.contains("reversal value B"), "{axis}: {told}");
        }
    }
}
