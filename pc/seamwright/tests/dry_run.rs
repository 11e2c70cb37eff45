//! `seamwright dry-run` as a program: what it prints and writes, and what it refuses.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PROGRAM: &str = "programs/stir-contour.ngc";
const MACHINE: &str = "machines/stir-gantry.toml";

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn dry_run(program: &Path, machine: &str, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_seamwright"));
    command
        .arg("dry-run")
        .arg(program)
        .arg("--machine")
        .arg(shipped(machine));
    command.args(more).output().expect("seamwright runs")
}

/// What is said of a run that is refused with `code`.
#[track_caller]
fn refusal(program: &Path, machine: &str, more: &[&str], code: i32) -> String {
    let output = dry_run(program, machine, more);
    let said = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{said}");
    said
}

#[track_caller]
fn assert_says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
}

#[test]
fn figures_are_printed_and_written() {
    let directory = scratch("dry-run");
    let report = directory.to_str().expect("text");
    let output = dry_run(
        &shipped(PROGRAM),
        MACHINE,
        &["--override", "2", "--report", report],
    );
    let said = String::from_utf8(output.stdout).expect("text");
    assert_eq!(output.status.code(), Some(0), "{said}");
    let parts = [
        "stir-contour.ngc on ",
        " at 200 % feed",
        "parking",
        "Highest",
        "the job",
        "report in",
    ];
    assert_says(&said, &parts);
    for file in ["dry-run.json", "dry-run-path.svg", "dry-run-axes.svg"] {
        assert!(directory.join(file).is_file(), "{file}");
    }
}

#[test]
fn check_tells_the_same_time() {
    let mut check = Command::new(env!("CARGO_BIN_EXE_seamwright"));
    check.arg("check").arg(shipped(PROGRAM));
    let output = check
        .arg("--machine")
        .arg(shipped(MACHINE))
        .output()
        .expect("seamwright runs");
    let checked = String::from_utf8(output.stdout).expect("text");
    let ran = dry_run(&shipped(PROGRAM), MACHINE, &[]);
    let ran = String::from_utf8(ran.stdout).expect("text");
    let number = |text: &str, start: &str| {
        let line = text.lines().find(|line| line.trim_start().starts_with(start));
        let words = line
            .expect(text)
            .trim_start()
            .strip_prefix(start)
            .map(str::split_whitespace);
        words
            .and_then(|mut words| words.next().map(str::to_owned))
            .expect(text)
    };
    assert_eq!(number(&checked, "total"), number(&ran, "the job"));
}

/// A feed is the most: check and dry run say where it cannot be kept. Beside a part file it must be kept with a beam on.
#[test]
fn where_a_feed_cannot_be_kept_is_told_and_refused_where_a_part_asks_for_it() {
    let text = "G43.4\nG64 P0.05\nG0 X600 Y400 Z100 A0 C0\nM67 E0 Q500\nF12000\nM62 P0\nG1 X700\nG3 X710 Y410 J10\nM63 P0\nG1 Y500\nG1 X600\nM2\n";
    let program = scratch("fast.ngc");
    std::fs::write(&program, text).expect("a program");
    let path = program.to_str().expect("text");
    let machine = "machines/ac-head.toml";
    let ran = dry_run(&program, machine, &[]);
    assert_eq!(ran.status.code(), Some(0));
    let mut check = Command::new(env!("CARGO_BIN_EXE_seamwright"));
    check.args(["check", path, "--machine"]).arg(shipped(machine));
    let checked = check.output().expect("seamwright runs");
    for output in [ran, checked] {
        let said = String::from_utf8(output.stdout).expect("text");
        let parts = [
            "line 8, column 4: the feed of 12000 mm/min is too high, the acceleration of ",
            "the machine slows down where it must",
            "slows down in lines 7–",
            "from 12.0 m/min to ",
            "(line 8), by the jerk of Y",
            ", by the corner of 90.0°",
        ];
        assert_says(&said, &parts);
    }
    let part = scratch("fast.toml");
    std::fs::copy(shipped("programs/panel.toml"), &part).expect("a part file");
    let said = refusal(&program, machine, &[], 1);
    let refused = [
        "fast.ngc",
        "line 8, column 4",
        "12000 mm/min is too high",
        "must be constant with the beam on",
    ];
    assert_says(&said, &refused);
    let again = String::from_utf8(check.output().expect("seamwright runs").stderr).expect("text");
    assert_eq!(said, again);
    let welded = Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .args(["weld", path, "--boards", "simulated", "--report"])
        .arg(scratch("fast"))
        .arg("--machine")
        .arg(shipped(machine))
        .args(["--from-line", "10"])
        .output();
    let welded = String::from_utf8(welded.expect("seamwright runs").stderr).expect("text");
    assert_says(&welded, &refused[1..]);
    std::fs::remove_file(&part).expect("the part file");
}

#[test]
fn a_missing_file_is_named() {
    let none = scratch("none.ngc");
    let said = refusal(&none, MACHINE, &[], 1);
    assert_says(&said, &["cannot read program", "none.ngc", "No such file"]);
    let said = refusal(&shipped(PROGRAM), "machines/none.toml", &[], 1);
    assert_says(&said, &["cannot read machine file", "none.toml", "No such file"]);
}

#[test]
fn overrides_and_speeds_that_lead_nowhere_are_refused() {
    for wrong in ["0", "-1", "2.01", "NaN", "inf", "fast"] {
        let said = refusal(&shipped(PROGRAM), MACHINE, &["--override", wrong], 2);
        assert_says(&said, &["--override", wrong, "above 0 and up to 2"]);
    }
    let said = refusal(&shipped(PROGRAM), MACHINE, &["--speed", "0"], 2);
    assert_says(&said, &["--speed", "above 0"]);
    // Of a path with one feed, but faster than the machine.
    let said = refusal(&shipped(PROGRAM), MACHINE, &["--speed", "40"], 1);
    assert_says(&said, &["stir-contour.ngc", "40000 mm/min is too high", "allows"]);
}

#[test]
fn a_program_of_another_machine_is_refused_with_its_line() {
    let said = refusal(&shipped("programs/saddle-320-80.ngc"), MACHINE, &[], 1);
    assert_says(&said, &["saddle-320-80.ngc", "line "]);
}
