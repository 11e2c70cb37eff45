//! A machine drawn at random is commissioned on emulated boards, and welds with what was found: a quarter of an hour of its time, so it
//! is run by `cargo xtask test --extended` only.

use crate::pair::{Pair, scratch};
use emulator::bound_to_parent;
use plant_file::{DEFAULT_MACHINE, PlantChoice};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};
use system_tests::{MACHINE, PROGRAM, SEAM, shipped};

/// Nothing was made with this one.
const DRAWN: &str = "draw:usual:9101";
/// Longest wait for one command, on a host that does much else \[s\].
const PATIENCE: Duration = Duration::from_secs(3600);
const POLL: Duration = Duration::from_millis(100);
/// What commissioning promises of each loop.
const LEAST_GAIN_MARGIN_DB: f64 = 6.0;
const LEAST_PHASE_MARGIN_DEG: f64 = 45.0;
const MOST_SENSITIVITY: f64 = 2.0;
/// Farthest that margins of a motor may be from those found on simulated boards, where its noise comes at other times: as much as
/// what is found may be off the truth each time (docs/commissioning.md).
const OFF_DB: f64 = 3.0;
const OFF_DEG: f64 = 16.0;

/// A motor as `seamwright commission` tells it.
#[derive(Debug)]
struct Told {
    name: String,
    gain_margin_db: f64,
    phase_margin_deg: f64,
    sensitivity: f64,
}

/// The number between two pieces of a line.
fn between(line: &str, before: &str, behind: &str) -> f64 {
    let number = line
        .split_once(before)
        .and_then(|(_, rest)| rest.split_once(behind));
    let (number, _) = number.unwrap_or_else(|| panic!("no {before:?} in {line:?}"));
    number.trim().parse().unwrap_or_else(|_| panic!("{line:?}"))
}

/// The motors with their margins now.
fn told(said: &str) -> Vec<Told> {
    let mut motors = Vec::new();
    let mut name = "";
    for line in said.lines() {
        if let Some((motor, _)) = line.split_once(": drive gain") {
            name = motor;
        } else if line.trim_start().starts_with("now ") {
            motors.push(Told {
                name: name.to_owned(),
                gain_margin_db: between(line, "gain margin", "dB"),
                phase_margin_deg: between(line, "phase margin", "°"),
                sensitivity: between(line, "sensitivity", ","),
            });
        }
    }
    motors
}

/// Runs `seamwright` to its end, which has to be a good one; what it printed, and how long it took.
#[track_caller]
fn run(mut command: Command, log: &Path) -> (String, Duration) {
    let file = |name: &str| log.with_extension(name);
    let begun = Instant::now();
    let mut child = command
        .stdin(Stdio::null())
        .stdout(File::create(file("out")).expect("a folder to write to"))
        .stderr(File::create(file("err")).expect("a folder to write to"))
        .spawn()
        .expect("a program that can be run");
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child") {
            break Some(status);
        }
        if begun.elapsed() > PATIENCE {
            break None;
        }
        thread::sleep(POLL);
    };
    if status.is_none() {
        let _ = child.kill();
        let _ = child.wait();
    }
    let [said, wrong] = ["out", "err"].map(|name| fs::read_to_string(file(name)).expect("what it said"));
    let code = status.and_then(|status| status.code());
    assert_eq!(code, Some(0), "{}\n{said}\n{wrong}", log.display());
    (said, begun.elapsed())
}

#[test]
#[ignore = "6 minutes and more: run by cargo xtask test --extended"]
fn a_drawn_machine_is_commissioned_and_welds_within_its_limits() {
    let plant: PlantChoice = DRAWN.parse().expect("a machine");
    let mut pair = Pair::for_jobs_on(&plant, "commissioned", DEFAULT_MACHINE);
    let folder = scratch("commissioned-files");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder to write to");
    let on = |boards: &str| {
        let machine = folder.join(format!("{boards}.toml"));
        let mut command = match boards {
            "emulated" => pair.program(["commission"]),
            _ => {
                let mut command = bound_to_parent(crate::pair::program(emulator::PROGRAM_VARIABLES[0]));
                command.args(["commission", "--boards", boards]);
                command
            }
        };
        command
            .args(["--plant", DRAWN, "--machine"])
            .arg(shipped(MACHINE));
        command.arg("-o").arg(&machine);
        let (said, took) = run(command, &folder.join(boards));
        println!(
            "commissioned on {boards} boards in {:.0} s\n{said}",
            took.as_secs_f64()
        );
        (machine, told(&said))
    };
    let (machine, emulated) = on("emulated");
    let (_, simulated) = on("simulated");
    assert_eq!(emulated.len(), 7, "{emulated:?}");
    for (here, there) in emulated.iter().zip(&simulated) {
        assert_eq!(here.name, there.name);
        // As they are printed.
        assert!(
            here.gain_margin_db >= LEAST_GAIN_MARGIN_DB
                && here.phase_margin_deg >= LEAST_PHASE_MARGIN_DEG
                && here.sensitivity <= MOST_SENSITIVITY,
            "{here:?}"
        );
        // Beyond 12 dB they are as good, and not known well.
        let off_db = here.gain_margin_db.min(12.0) - there.gain_margin_db.min(12.0);
        let off_deg = here.phase_margin_deg - there.phase_margin_deg;
        assert!(
            off_db.abs() <= OFF_DB && off_deg.abs() <= OFF_DEG,
            "{here:?} {there:?}"
        );
    }

    let mut check = bound_to_parent(crate::pair::program(emulator::PROGRAM_VARIABLES[0]));
    check
        .arg("check")
        .arg(shipped(PROGRAM))
        .arg("--machine")
        .arg(&machine);
    check.arg("--seam").arg(shipped(SEAM)).args(["--speed", "9"]);
    run(check, &folder.join("check"));

    let report = folder.join("report");
    let mut weld = pair.program(["weld", "--camera", "geometric", "--speed", "9", "--plant", DRAWN]);
    weld.arg(shipped(PROGRAM)).arg("--machine").arg(&machine);
    weld.arg("--seam").arg(shipped(SEAM)).arg("--report").arg(&report);
    let (said, _) = run(weld, &folder.join("weld"));
    println!("{said}");
    let json = fs::read_to_string(report.join("report.json")).expect("a report");
    let json: serde_json::Value = serde_json::from_str(&json).expect("of JSON");
    assert_eq!(json["outcome"], "finished");
    let lost = json["lost_ticks"].as_object().expect("of both boards");
    assert!(lost.values().all(|lost| lost == 0), "{lost:?}");
    pair.assert_off();
}
