//! `cargo xtask bench check`: what a check of a program of many short lines takes.

use crate::cargo::{cargo, root, run_command, target_directory};
use anyhow::{Context, Result, ensure};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Machine file, feed \[mm/min\], and words of rotary axes, if they turn.
const CASES: [(&str, f64, bool); 4] = [
    ("ac-head", 3000.0, false),
    ("ac-head", 3000.0, true),
    ("stir-gantry", 600.0, false),
    ("wire-arc", 1000.0, false),
];

/// Prints lines a second and peaks of memory of `lines` lines.
pub(super) fn run(lines: u64) -> Result<ExitCode> {
    run_command(
        cargo(&["build", "--release", "--package", "seamwright"])?,
        "cargo build",
    )?;
    let seamwright = target_directory()?.join("release/seamwright");
    let program = target_directory()?.join("short-lines.ngc");
    println!("| machine | lines | time [s] | lines/s | peak of memory [MB] |");
    println!("|---|---:|---:|---:|---:|");
    for (machine, feed, turns) in CASES {
        fs::write(&program, text(machine, feed, turns, lines))
            .with_context(|| format!("cannot write {}", program.display()))?;
        let (seconds, memory) = check(&seamwright, &program, machine)?;
        let rotary = if turns { ", A and C turn" } else { "" };
        let rate = lines as f64 / seconds;
        println!("| {machine}{rotary} | {lines} | {seconds:.2} | {rate:.0} | {memory:.1} |");
    }
    Ok(ExitCode::SUCCESS)
}

/// Lines of 0.1 to 0.5 mm on a wavy surface, in rows along X.
fn text(machine: &str, feed: f64, turns: bool, lines: u64) -> String {
    let begin = match machine {
        "ac-head" => [400.0, 400.0, 150.0],
        "stir-gantry" => [200.0, 300.0, 200.0],
        _ => [-200.0, -200.0, 100.0],
    };
    let (mut x, mut row, mut direction) = (0.0, 0_u32, 1.0);
    let mut random = 1_u64;
    let mut text = "G90 G21 G64 P0.02\n".to_owned();
    for line in 0..=lines {
        let y = 0.5 * f64::from(row % 800);
        let z = 6.0 * (x / 37.0_f64).sin() * (y / 53.0).cos() + 2.0 * ((x + y) / 17.0).sin();
        let [x0, y0, z0] = begin;
        let head = if line == 0 { "G0 " } else { "G1 " };
        let _ = write!(text, "{head}X{:.3} Y{:.3} Z{:.3}", x0 + x, y0 + y, z0 + z);
        if turns {
            let a = 10.0 + 8.0 * (x / 90.0).sin() * (y / 60.0).cos();
            let _ = write!(text, " A{a:.3} C{:.3}", 30.0 * (x / 150.0 + y / 70.0).sin());
        }
        if line == 1 {
            let _ = write!(text, " F{feed}");
        }
        text.push('\n');
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let next = x + direction * (0.1 + 0.4 * (random >> 40) as f64 / (1 << 24) as f64);
        if (0.0..=400.0).contains(&next) {
            x = next;
        } else {
            (direction, row) = (-direction, row + 1);
        }
    }
    text.push_str("M2\n");
    text
}

/// Seconds, and the peak of memory \[MB\].
fn check(seamwright: &Path, program: &Path, machine: &str) -> Result<(f64, f64)> {
    let machine = root().join(format!("machines/{machine}.toml"));
    let started = Instant::now();
    let mut child = Command::new(seamwright)
        .arg("check")
        .arg(program)
        .arg("--machine")
        .arg(machine)
        .stdout(Stdio::null())
        .spawn()
        .context("cannot run seamwright check")?;
    let mut peak = 0.0_f64;
    loop {
        peak = peak.max(resident(&child));
        if let Some(status) = child.try_wait()? {
            ensure!(status.success(), "seamwright check failed ({status})");
            return Ok((started.elapsed().as_secs_f64(), peak));
        }
        sleep(Duration::from_millis(2));
    }
}

/// Largest resident set so far \[MB\]; 0 where the system does not tell.
fn resident(child: &Child) -> f64 {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(0.0) / 1e3
}
