//! Predictions beside runs on simulated boards, streams, drives and servo loops included.

use super::*;
use crate::boards::overheard::Overheard;
use crate::boards::simulated::SimulatedBoards;
use crate::seam::Deviation;
use crate::weld::{Job, Names, Silent, Work, run as weld};
use shared::protocol::MotionSample;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

/// A shipped program both ways: by how much the prediction of the whole job, and of its motion, is off, as parts.
fn off(machine: &str, program: &str, seam: Option<&str>) -> [f64; 2] {
    let name = machine.strip_suffix(".toml").unwrap();
    let programs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../programs");
    let text = std::fs::read_to_string(programs.join(program)).unwrap();
    let machine = super::machine(machine);
    let predicted = ran(&machine, &text, 1.0);

    let program = interpret(&text, Options::default()).unwrap();
    let job = Job {
        machine: &machine,
        work: Work::Program(&program),
        part: None,
        speed_m_per_min: None,
        seam: seam.map(|seam| Rc::new(Deviation::read(&programs.join(seam)).unwrap())),
        seed: 1,
        names: Names {
            program: "job.ngc".into(),
            machine: "machine.toml".into(),
            seam: None,
            boards: "simulated".into(),
        },
    };
    // When the machine was on a path: first and last tick, and how many.
    let (mut ticks, mut on_path) = (None, 0);
    let mut boards = Overheard {
        boards: SimulatedBoards::new(name).unwrap(),
        hear: |_: &mut SimulatedBoards, sample: &MotionSample| {
            if sample.state.on_path() {
                let (first, _) = ticks.unwrap_or((sample.tick, 0));
                ticks = Some((first, sample.tick));
                on_path += 1;
            }
        },
    };
    let ended = weld(&mut boards, &job, &AtomicBool::new(false), &mut Silent).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    let (first, last) = ticks.unwrap();
    let seen = [f64::from(last - first + 1), f64::from(on_path)].map(|ticks| 1e-3 * ticks);
    println!(
        "{name}: {:.3} {:.3}, seen {seen:.3?}",
        predicted.duration_s, predicted.motion_s
    );
    [
        predicted.duration_s / seen[0] - 1.0,
        predicted.motion_s / seen[1] - 1.0,
    ]
}

#[track_caller]
fn assert_predicted(machine: &str, program: &str, seam: Option<&str>) {
    let [job, motion] = off(machine, program, seam);
    assert!(job.abs() < 0.005, "job: {:.3} %", 100.0 * job);
    assert!(motion.abs() < 0.001, "motion: {:.3} %", 100.0 * motion);
}

#[test]
fn a_weld_in_two_passes_with_a_dwell_takes_as_long_as_predicted() {
    assert_predicted("stir-gantry.toml", "stir-contour.ngc", None);
}

#[test]
fn a_weld_that_follows_a_seam_takes_as_long_as_predicted() {
    let seam = Some("t-seam-400-deviation.csv");
    assert_predicted("dual-beam-gantry.toml", "t-seam-400.ngc", seam);
}

#[test]
fn a_saddle_of_many_short_blocks_takes_as_long_as_predicted() {
    assert_predicted("pipe-welder.toml", "saddle-320-80.ngc", None);
}

#[test]
fn a_bead_takes_as_long_as_predicted() {
    assert_predicted("wire-arc.toml", "leaf.ngc", None);
}
