//! A first look at boards by `seamwright probe`, which is told their addresses.

use crate::model::Model;
use crate::pair::{Pair, program};
use emulator::{PROGRAM_VARIABLES, bound_to_parent};
use plant_file::DEFAULT_MACHINE;
use system_tests::{MACHINE, shipped};

/// Addresses at which the boards have their own ports.
const AT: &str = "127.0.71.11,127.0.71.12";

/// The boards' time is slower than the PC's clock on a busy computer, so their ticks are not judged.
#[test]
fn a_probe_without_hands_finds_both_boards_good() {
    let mut pair = Pair::of_model("probe", |folder| {
        Model::boot(folder, DEFAULT_MACHINE, &["--at", AT])
    });
    let mut probe = bound_to_parent(program(PROGRAM_VARIABLES[0]));
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
