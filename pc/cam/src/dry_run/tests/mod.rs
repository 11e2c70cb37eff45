mod arcs;
mod slowed;
mod standing;

use super::*;
use nc::{Motion, Options, interpret};
use std::path::Path;

/// What programs begin with.
const BEGIN: &str = "G21 G17 G90 G94 G40 G54 G64\nG43.4\n";

fn machine(name: &str) -> MachineFile {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../machines")
        .join(name);
    MachineFile::read(&file).unwrap()
}

fn ran(machine: &MachineFile, program: &str, factor: f64) -> DryRun {
    let program = interpret(program, Options::default()).unwrap();
    let planner = Planner::build(machine).unwrap();
    let paths = planner.program(&program, &machine.homed_axes(), None).unwrap();
    run(machine, &planner, &paths, factor).unwrap()
}

/// A program of the friction-stir gantry: two rapids, a feed of two lines, a dwell, a feed.
fn program() -> String {
    format!("{BEGIN}G0 X100 Y100 Z200 B0 C0\nG0 Z120\nF600\nG1 X160\nG1 X200\nG4 P1.5\nF1200\nG1 Y140\nM2\n")
}

#[test]
fn times_are_those_of_trapezoids_and_what_the_jerk_takes() {
    let machine = machine("stir-gantry.toml");
    let ran = ran(&machine, &program(), 1.0);
    let kinds: Vec<_> = ran.paths.iter().map(|path| (path.motion, path.lines)).collect();
    let feeds = [(Motion::Feed, (6, 7)), (Motion::Feed, (10, 10))];
    assert_eq!(kinds[2..4], feeds);
    let acceleration = machine.planning.path_acceleration_mm_s2;
    for (path, [length, feed]) in ran.paths[2..4].iter().zip([[100.0, 10.0], [40.0, 20.0]]) {
        assert!((path.length_mm - length).abs() < 1e-9);
        let trapezoid = length / feed + feed / acceleration;
        let late = path.duration_s - trapezoid;
        assert!((0.0..0.35).contains(&late), "{late} s");
        assert!((path.highest.path[0].share() - 1.0).abs() < 1e-6);
        assert_eq!(path.ruled[0].row, PATH);
        assert!(path.ruled[0].quantity == 0 && path.ruled[0].part > 0.5);
    }
    // The dwell, and what the PC takes.
    let between = ran.duration_s - ran.motion_s;
    assert!(
        (1.5..1.5 + 0.03 * ran.paths.len() as f64).contains(&between),
        "{between} s"
    );
    let stop = ran.longest_stop.unwrap();
    assert!(
        stop.after_line == 7 && (1.5..1.9).contains(&stop.duration_s),
        "{stop:?}"
    );
    assert!(ran.paths.last().unwrap().parking);
    let length: f64 = ran.paths.iter().map(|path| path.length_mm).sum();
    assert_eq!(ran.length_mm, length);
}

#[test]
fn no_limit_is_exceeded_and_the_largest_values_are_told_with_their_lines() {
    let text = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs/stir-contour.ngc"),
    );
    let machine = machine("stir-gantry.toml");
    let ran = ran(&machine, &text.unwrap(), 1.0);
    assert_eq!(ran.highest.above().count(), 0, "{ran}");
    let rows = ran.highest.rows();
    // No A: the machine has none.
    assert!(!ran.fitted[3] && rows[4].iter().all(|peak| peak.highest == 0.0));
    for (row, name) in [(1, "X"), (2, "Y"), (3, "Z"), (5, "B")] {
        // Rapids use their part of the limits.
        let share = rows[row][0].share();
        assert!((0.4..0.51).contains(&share), "{name}: {share}");
    }
    let table = ran.to_string();
    for words in [
        "rests for 2.50 s",
        "21–25",
        "feed 100 %",
        "mm/s³",
        "longest stop",
        "park position",
    ] {
        assert!(table.contains(words), "{words}: {table}");
    }
}

#[test]
fn the_override_stretches_feeds_and_is_kept_by_the_limits() {
    let machine = machine("stir-gantry.toml");
    let ran = |factor| ran(&machine, &program(), factor);
    let [half, whole, double] = [0.5, 1.0, 2.0].map(ran);
    let feed = |ran: &DryRun| ran.paths[2].duration_s;
    assert!((feed(&half) - 20.0).abs() < 0.4, "{}", feed(&half));
    assert!((feed(&double) - 5.0).abs() < 0.8, "{}", feed(&double));
    for ran in [&half, &whole, &double] {
        assert_eq!(ran.highest.above().count(), 0, "{ran}");
        // Dwells are not stretched.
        assert!((1.5..1.9).contains(&ran.longest_stop.unwrap().duration_s));
    }
    let speed = double.paths[2].highest.path[0];
    assert!((speed.highest - 20.0).abs() < 1e-3 && (speed.limit - 20.0).abs() < 1e-9);
}

#[test]
fn the_trace_ends_with_the_job_and_shows_its_peaks() {
    let machine = machine("stir-gantry.toml");
    let ran = ran(&machine, &program(), 1.0);
    for row in 0..ROWS {
        for quantity in 0..3 {
            let envelope = &ran.trace.rows[row][quantity];
            let (end, _) = envelope.bins().last().unwrap();
            assert!((end - ran.duration_s).abs() <= envelope.step_s());
            let highest = envelope.bins().map(|(_, bin)| bin.high.max(-bin.low));
            let highest = highest.fold(0.0, f64::max);
            assert_eq!(highest, ran.highest.rows()[row][quantity].highest);
        }
    }
}

/// 60 days: beyond 32 bits of milliseconds.
#[test]
fn dwells_are_summed_however_long_they_are() {
    let machine = machine("stir-gantry.toml");
    let dwells = "G4 P86400\n".repeat(60);
    let program = program().replace("G4 P1.5\n", &dwells);
    let ran = ran(&machine, &program, 1.0);
    let between = ran.duration_s - ran.motion_s;
    assert!((between - 60.0 * 86_400.0).abs() < 1.0, "{between} s");
}
