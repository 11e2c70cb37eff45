//! Programs that are started at one of their lines.

use super::*;
use cam::path::FromLineError;
use shared::protocol::MotionSample;
use std::path::Path;

/// A part of a contour on the A/C head: three blocks with the beam on, with a turn in the middle, and one without.
const CUT: &str = "\
G43.4
G53 G0 X500 Y500 Z400 A10 C0
F3000
M67 E0 Q500
G0 X500 Y500 Z100 A10 C0
M62 P0
G1 X540
X580 A20 C30
F1500
X620
M63 P0
X640
M2";

fn shipped(name: &str) -> MachineFile {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../machines/{name}.toml"));
    MachineFile::read(&file).unwrap()
}

/// Runs `program` from `line`; the samples of the motion board, and how it ended.
fn started(machine: &MachineFile, text: &str, line: Option<u32>) -> (Ended, Vec<MotionSample>) {
    let program = interpret(text, Options::default()).unwrap();
    let mut samples = Vec::new();
    let kinematics = machine.motion.kinematics.name();
    let mut boards = TappedBoards {
        boards: &mut SimulatedBoards::new(kinematics).unwrap(),
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| samples.push(*sample),
    };
    let mut job = job(machine, &program, None);
    job.from_line = line;
    let ended = run(&mut boards, &job, &mut NoOperator).unwrap();
    (ended, samples)
}

fn refused(machine: &MachineFile, text: &str, line: u32) -> String {
    let program = interpret(text, Options::default()).unwrap();
    let mut job = job(machine, &program, machine.tracking.as_ref().map(|_| seam()));
    job.from_line = Some(line);
    let planner = Planner::build(machine).unwrap();
    let error = job.plan(&program, &planner, &machine.homed_axes()).unwrap_err();
    assert!(matches!(error, JobError::FromLine(_)), "{error}");
    error.to_string()
}

/// From the block on the rest is run as in the whole program: the same places at the same path lengths.
#[test]
fn the_rest_of_a_program_is_run_as_in_the_whole() {
    let machine = shipped("ac-head");
    let (whole, all) = started(&machine, CUT, None);
    assert!(whole.error.is_none(), "{:?}", whole.error);
    let feeds = |samples: &[MotionSample], id: u32| -> Vec<MotionSample> {
        let on = samples
            .iter()
            .filter(|s| s.path_id == id && s.state == State::Running);
        on.copied().collect()
    };
    let all = feeds(&all, 3);
    // Line 9 changes the feed only.
    for (line, start_s, ids) in [(8, 40.0, 4), (9, 80.0, 4), (10, 80.0, 4), (12, 120.0, 4)] {
        let (ended, samples) = started(&machine, CUT, Some(line));
        assert!(ended.error.is_none(), "line {line}: {:?}", ended.error);
        let rest = feeds(&samples, ids);
        let first = rest.first().unwrap();
        assert!((first.s_mm - start_s).abs() < 1e-6, "line {line}: {first:?}");
        let ends = [&rest, &all].map(|samples| samples.last().unwrap().s_mm);
        assert!((ends[0] - ends[1]).abs() < 1e-9, "line {line}: {ends:?}");
        // Beams are off on the way, and on from the start of the line if they were on there.
        let before = samples.iter().take_while(|s| s.path_id < ids);
        assert!(before.clone().all(|s| s.beams == [false; 2]), "line {line}");
        let on = rest.iter().find(|s| s.beams[0]);
        assert_eq!(on.is_some(), start_s < 120.0, "line {line}");
        assert!(on.is_none_or(|on| on.s_mm < start_s + 0.1), "line {line}: {on:?}");
        let steady = rest.iter().filter(|s| s.s_mm > start_s + 10.0);
        for sample in steady {
            let there = all.iter().min_by(|a, b| {
                let off = |s: &MotionSample| (s.s_mm - sample.s_mm).abs();
                off(a).total_cmp(&off(b))
            });
            let there = there.unwrap();
            let speed = speed_at(&all, sample.s_mm).unwrap_or(there.speed_mm_s);
            assert!((speed - sample.speed_mm_s).abs() < 0.5, "{there:?}, {sample:?}");
            let way = there.s_mm - sample.s_mm;
            for axis in 0..6 {
                let off = there.axes[axis] - sample.axes[axis];
                assert!(
                    off.abs() < 1.5 * way.abs() + 0.02,
                    "{axis}: {there:?}, {sample:?}"
                );
            }
        }
        assert!(ended.report.max_contour_error_mm.unwrap() < 0.05);
    }
}

/// Speed at a place between two samples, which the machine passes forwards.
fn speed_at(samples: &[MotionSample], s_mm: f64) -> Option<f64> {
    let around = |pair: &&[MotionSample]| pair[0].s_mm < s_mm && s_mm <= pair[1].s_mm;
    let [before, after] = samples.windows(2).find(around)? else {
        return None;
    };
    let share = (s_mm - before.s_mm) / (after.s_mm - before.s_mm);
    Some(before.speed_mm_s + share * (after.speed_mm_s - before.speed_mm_s))
}

/// Z goes away first, then the others go, then Z comes down: as in parking, backwards.
#[test]
fn the_machine_goes_to_a_line_away_from_the_work() {
    let machine = shipped("ac-head");
    let (_, samples) = started(&machine, CUT, Some(10));
    let approach: Vec<_> = samples.iter().filter(|s| (1..4).contains(&s.path_id)).collect();
    let park = machine.planning.park_axes();
    let homed = machine.homed_axes();
    for sample in approach {
        let [x, y, z, a, _, c] = sample.axes;
        match sample.path_id {
            1 => assert!(
                (x - homed[0]).abs() < 0.02 && (y - homed[1]).abs() < 0.02,
                "{sample:?}"
            ),
            2 => assert!((z - park[2]).abs() < 0.02, "{sample:?}"),
            _ => {
                let [a, c] = [a, c].map(f64::to_degrees);
                assert!((a - 20.0).abs() < 0.02 && (c - 30.0).abs() < 0.02, "{sample:?}");
            }
        }
    }
}

#[test]
fn a_spindle_runs_up_above_the_work_and_goes_down_at_a_feed() {
    let machine = shipped("stir-gantry");
    let program = "\
G43.4 G61
G0 X300 Y200 Z50 B-3 C0
M3 S600
G4 P2
F120
G1 Z20
X310
X340
G0 Z60
M5
M2";
    let (ended, samples) = started(&machine, program, Some(8));
    assert!(ended.error.is_none(), "{:?}", ended.error);
    let on = samples.iter().position(|s| s.beams[0]).unwrap();
    let park = machine.planning.park_axes();
    assert!((samples[on].axes[2] - park[2]).abs() < 0.02, "{:?}", samples[on]);
    // It has its time to run up, and then does not stop before M5.
    let down = samples[on..]
        .iter()
        .position(|s| s.axes[2] < park[2] - 0.1)
        .unwrap();
    assert!(down > 2000, "down after {down} ms");
    let begun = samples.iter().position(|s| s.path_id == 6).unwrap();
    assert!(samples[on..begun].iter().all(|s| s.beams[0]));
    // The program went to 50 mm by a rapid, and on at 120 mm/min.
    let slow = samples[..begun].iter().filter(|s| s.path_id == 5);
    let [fastest, highest] = slow.fold([0.0; 2], |[speed, z]: [f64; 2], s| {
        let height = s.axes[2] - samples[begun].axes[2];
        [speed.max(s.speed_mm_s), z.max(height)]
    });
    assert!((1.9..2.01).contains(&fastest), "{fastest} mm/s");
    assert!((highest - 30.0).abs() < 0.02, "{highest} mm");
    let first = &samples[begun];
    assert!((first.s_mm - 40.0).abs() < 1e-6, "{first:?}");
    assert!(!samples.last().unwrap().beams[0]);
}

/// What runs before the seam can be found, and what comes after it, can be started at; what is between cannot.
#[test]
fn a_tracked_weld_is_started_with_its_run_in_only() {
    assert_eq!(
        refused(&machine(), PROGRAM, 8),
        "line 8 follows the seam, which has to be found before: start from line 5, where tracking begins, or before it"
    );
    let program = interpret(PROGRAM, Options::default()).unwrap();
    // Without a beam all that feeds counts.
    for (line, length_mm) in [(3, 200.0), (12, 40.0)] {
        let machine = machine();
        let mut job = job(&machine, &program, Some(seam()));
        job.from_line = Some(line);
        let mut boards = SimulatedBoards::default();
        let ended = run(&mut boards, &job, &mut NoOperator).unwrap();
        assert!(ended.error.is_none(), "line {line}: {:?}", ended.error);
        let report = &ended.report;
        assert!((report.weld_length_mm - length_mm).abs() < 0.2, "line {line}");
        let max = seam_of(report).max_deviation_mm.u1;
        assert_eq!(max.is_some(), line == 3);
        assert!(max.is_none_or(|max| max < 0.02), "{max:?}");
    }
}

#[test]
fn lines_that_cannot_be_started_at_are_named() {
    let machine = shipped("ac-head");
    assert_eq!(
        refused(&machine, CUT, 13),
        "nothing moves in line 13 or after it; the last line that does is 12"
    );
    let nurbs = CUT.replace(
        "X580 A20 C30",
        "G5.2 X560 Y510 P1\nX580 Y510 P1\nX580 Y500 P1\nG5.3\nG1 X590",
    );
    for line in [9, 10] {
        assert_eq!(
            refused(&machine, &nurbs, line),
            format!(
                "line {line} is in the middle of the NURBS of line 8: start there, or after its G5.3 or last point"
            )
        );
    }
    let program = interpret(&nurbs, Options::default()).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let from = machine.homed_axes();
    let paths = || planner.program(&program, &from, None).unwrap();
    for line in [8, 11, 12] {
        let started = planner.from_line(&program, paths(), line, &from);
        assert!(started.is_ok(), "line {line}: {:?}", started.err());
    }
    // The whole program.
    let whole = planner.from_line(&program, paths(), 1, &from).unwrap();
    assert_eq!(format!("{whole:?}"), format!("{:?}", paths()));
    let nothing = planner.from_line(&program, paths(), u32::MAX, &from);
    assert!(
        matches!(nothing, Err(FromLineError::Nothing { last: 16, .. })),
        "{nothing:?}"
    );
}
