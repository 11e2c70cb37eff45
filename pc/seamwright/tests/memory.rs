//! A program of any length takes the same memory, from its text to the elements that a board is given.

#![cfg(target_os = "linux")]

use cam::path::Planner;
use config::machine::MachineFile;
use nc::{Options, interpret_file};
use std::f64::consts::TAU;
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;

/// Memory that the process has had so far, at most \[kB\].
fn most() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("the system tells it");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next());
    number
        .and_then(|number| number.parse().ok())
        .expect("a number of kB")
}

/// A program of `count` blocks of about 0.3 mm, with an output and an arc now and then.
fn write(count: u32) -> File {
    let mut text = BufWriter::new(tempfile::tempfile().expect("a file"));
    writeln!(
        text,
        "G43.4 G64 P0.02\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\nG1 F600 X650"
    )
    .expect("written");
    for i in 1..=count {
        let phi = TAU * f64::from(i % 1000) / 1000.0;
        let (x, y) = (600.0 + 50.0 * phi.cos(), 500.0 + 50.0 * phi.sin());
        match i % 100 {
            0 => writeln!(text, "M67 E0 Q{}", i % 600),
            50 => writeln!(text, "G3 X{x:.4} Y{y:.4} R50"),
            _ => writeln!(text, "G1 X{x:.4} Y{y:.4}"),
        }
        .expect("written");
    }
    writeln!(text, "G1 X600 Y500\nM2").expect("written");
    let mut file = text.into_inner().expect("written");
    file.rewind().expect("a file");
    file
}

/// Reads, checks and gives a program; how many elements and events that made.
fn run(count: u32) -> (u64, u64) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines");
    let machine = MachineFile::read(&folder.join("stir-gantry.toml")).expect("a machine");
    let planner = Planner::build(&machine).expect("sound");
    let program = interpret_file(write(count), Options::default()).expect("a program");
    let from = machine.planning.park_axes();
    let paths = planner
        .program(&program, &from, None)
        .expect("within the machine");
    let (mut elements, mut events) = (0, 0);
    for leg in paths[2].legs() {
        elements += 1;
        events += leg.expect("as it was").events.len() as u64;
    }
    let summary = paths[2].blocks.as_ref().expect("followed exactly").summary();
    assert_eq!(summary.elements, elements);
    // What the board is given is as long, has the same events, and is held for some hundred blocks at a time.
    let (mut length, mut given) = (0.0, 0);
    for leg in paths[2].given_legs() {
        let leg = leg.expect("as it was");
        length += leg.element.length;
        given += leg.events.len() as u64;
    }
    assert_eq!(given, events);
    assert!((length - summary.length_mm).abs() < 1e-6);
    (elements, events)
}

#[test]
fn memory_does_not_grow_with_the_program() {
    // Once, so that all code and tables are there.
    run(5_000);
    let before = most();
    let count = 200_000;
    let (elements, events) = run(count);
    assert_eq!(
        (elements, events),
        (u64::from(count - count / 100 + 2), u64::from(count / 100))
    );
    let grown = most() - before;
    assert!(grown < 1000, "{grown} kB more, {before} kB before");
}
