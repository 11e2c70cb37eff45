//! A job that is ended from outside: by a signal, or by an output that takes nothing. The machine is stopped and the report
//! is written whatever happens.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

/// A folder that is not there yet.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

/// A weld of half a second, a hundred seconds long for its machine.
fn weld(report: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_seamwright"));
    command
        .arg("weld")
        .arg(shipped("programs/leaf.ngc"))
        .arg("--machine")
        .arg(shipped("machines/wire-arc.toml"))
        .args(["--boards", "simulated", "--report"])
        .arg(report)
        .stdin(Stdio::null());
    command
}

fn outcome(report: &Path) -> String {
    let text = std::fs::read_to_string(report.join("report.json")).expect("a report is written");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    json["outcome"].as_str().expect("an outcome").to_owned()
}

/// Sends `signal` to the weld as soon as the beam is on, and again; what it said.
fn interrupt(weld: &mut Child, signal: &str) -> String {
    let mut said = String::new();
    let mut lines = BufReader::new(weld.stderr.take().expect("piped"));
    while lines.read_line(&mut said).expect("text") > 0 {
        if said.ends_with("welding\n") {
            break;
        }
    }
    for _ in 0..2 {
        let sent = Command::new("kill")
            .args(["-s", signal, &weld.id().to_string()])
            .status();
        assert!(sent.expect("kill runs").success());
    }
    lines.read_to_string(&mut said).expect("text");
    said
}

#[test]
fn a_signal_stops_the_machine_and_the_report_says_so() {
    for signal in ["INT", "TERM", "HUP"] {
        let report = scratch(&format!("signal-{signal}"));
        let mut child = weld(&report)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("seamwright runs");
        let said = interrupt(&mut child, signal);
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{signal}: {said}");
        assert!(said.contains("welding\nstopping\n"), "{signal}: {said}");
        assert!(
            said.ends_with("beams are off and the machine is at rest\n"),
            "{signal}: {said}"
        );
        assert_eq!(outcome(&report), "interrupted", "{signal}");
    }
}

#[test]
fn a_weld_goes_on_without_anybody_who_reads() {
    // Readers that have left, and a disk that is full: the result of the job is not lost, and that it could
    // not be printed is an error if it was not chosen.
    let full = || {
        File::options()
            .write(true)
            .open("/dev/full")
            .expect("a full device")
    };
    let gone = || {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        writer
    };
    let outputs: [(&str, Stdio, Stdio, i32); 4] = [
        ("stdout-gone", gone().into(), Stdio::null(), 0),
        ("stdout-full", full().into(), Stdio::null(), 1),
        ("stderr-gone", Stdio::null(), gone().into(), 0),
        ("stderr-full", Stdio::null(), full().into(), 0),
    ];
    for (name, stdout, stderr, code) in outputs {
        let report = scratch(name);
        let status = weld(&report).stdout(stdout).stderr(stderr).status();
        assert_eq!(status.expect("seamwright runs").code(), Some(code), "{name}");
        assert_eq!(outcome(&report), "finished", "{name}");
    }
}

#[test]
fn a_full_output_is_named() {
    let report = scratch("stdout-full-named");
    let full = File::options()
        .write(true)
        .open("/dev/full")
        .expect("a full device");
    let output = weld(&report).stdout(full).output().expect("seamwright runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("seamwright: cannot write to standard output: No space left"),
        "{said}"
    );
}

#[test]
fn a_report_that_cannot_be_written_is_an_error_once_the_machine_stands() {
    let report = scratch("no-place");
    // A folder where a file of the report belongs.
    std::fs::create_dir_all(report.join("report.json")).expect("a folder");
    let mut child = weld(&report)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("seamwright runs");
    let said = interrupt(&mut child, "TERM");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("welding\nstopping\n") && said.contains("the machine is at rest"),
        "{said}"
    );
    assert!(
        said.trim_end()
            .lines()
            .last()
            .is_some_and(|last| last.contains("report.json")),
        "{said}"
    );
    // What is known is reported all the same.
    assert!(String::from_utf8_lossy(&output.stdout).contains("stopped by the operator"));
}
