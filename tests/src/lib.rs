//! What whole-system runs share: the shipped jobs, other seams for them, and welds on any boards.

pub mod bad_input;
mod by_hand;
pub mod fuzz;
mod hold;
mod operator;
mod pictures;
pub mod plate;
mod prediction;
pub mod range;
mod references;
pub mod weld_data;
mod words;

pub use by_hand::{Deed, Hands, Rest, Then};
pub use hold::assert_held_weld_goes_on;
pub use operator::{NoOperator, Operator, Sleeper, TappedBoards, run};
pub use pictures::{
    assert_stops_in_the_dark, weld_before_a_sleeper, weld_commissioned, weld_disturbed, weld_disturbed_by,
    weld_through_pictures,
};
pub use references::RecordedBoards;
pub use words::{OperatedWeld, WeldOutcome, meddled};

use config::machine::MachineFile;
use host_link::boards::Boards;
use job::{Job, Names, Work};
use nc::{Options, Program, interpret};
use parts::PartFile;
use report::Ended;
use report::Report;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use world::Deviation;
use world::Surroundings;

/// The shipped program, relative to the root of the workspace.
pub const PROGRAM: &str = "programs/t-seam-400.ngc";
/// The shipped machine.
pub const MACHINE: &str = "machines/dual-beam-gantry.toml";
/// The same as it was commissioned on [`plant_file::COMMISSIONED`].
pub const COMMISSIONED_FILE: &str = "machines/commissioned/dual-beam-gantry.toml";
/// The shipped deviation of the seams.
pub const SEAM: &str = "programs/t-seam-400-deviation.csv";

/// A shipped file.
pub fn shipped(file: &str) -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().expect("the root of the workspace").join(file)
}

fn program() -> Program {
    let text = std::fs::read_to_string(shipped(PROGRAM)).expect("the shipped program");
    interpret(&text, Options::default()).expect("the shipped program")
}

/// How the shipped seams deviate.
pub fn shipped_seam() -> Deviation {
    Deviation::read(&shipped(SEAM)).expect("the shipped seam")
}

/// Deviation of u1, v1, u2, v2 over the weld \[mm\].
pub type SeamShape = fn(f64) -> [f64; 4];

/// A file with a deviation of u1, v1, u2, v2 over the whole weld \[mm\].
pub fn seam_file(deviation: impl Fn(f64) -> [f64; 4]) -> String {
    let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
    for half in 0..=820 {
        let s = f64::from(half) / 2.0;
        let [u1, v1, u2, v2] = deviation(s);
        text += &format!("{s},{u1},{v1},{u2},{v2}\n");
    }
    text
}

/// The same as a seam.
pub fn seam(deviation: impl Fn(f64) -> [f64; 4]) -> Deviation {
    Deviation::parse("seam.csv", &seam_file(deviation)).expect("a seam file")
}

/// Sines of 1 mm over 100 mm on every slide, each in a phase of its own.
pub fn sines(s: f64) -> [f64; 4] {
    std::array::from_fn(|slide| (TAU * (s / 100.0 + slide as f64 / 7.0)).sin())
}

/// Slopes of 5 % on every slide, up and down.
pub fn slopes(s: f64) -> [f64; 4] {
    let rise = 0.05 * (s - 200.0);
    [rise, -rise, -rise, rise]
}

/// Kinks of 2 %, one every 40 mm, back and forth between slopes of 1 % on every slide.
pub fn kinks(s: f64) -> [f64; 4] {
    std::array::from_fn(|slide| {
        let phase = (s + 10.0 * slide as f64).rem_euclid(80.0);
        0.01 * (phase - 40.0).abs()
    })
}

/// The shipped machine.
fn machine() -> MachineFile {
    MachineFile::read(&shipped(MACHINE)).expect("the shipped machine")
}

/// Welds the shipped program along `seam`; if nothing ends that early, it takes as long as predicted.
pub fn weld(boards: &mut dyn Boards, seam: Deviation, speed_m_per_min: f64) -> Ended {
    with_weld(seam, speed_m_per_min, |job| prediction::run(boards, job))
}

/// Goes along 500 lines of 0.5 mm on a wave while the head turns, at 6 m/min: most of what a planner can be asked for.
/// It takes as long as predicted.
pub fn short_lines(boards: &mut dyn Boards) -> Ended {
    let mut text = "G21 G17 G90 G94 G64 P0.05\nG43.4\nG0 X900 Y900 Z100 A0 B0 C0\nF6000\n".to_owned();
    for line in 1..=500 {
        let s = 0.5 * f64::from(line);
        let [y, z] = [900.0 + 5.0 * (s / 20.0).sin(), 100.0 + 2.0 * (s / 35.0).sin()];
        let [a, c] = [2.0 * (s / 50.0).sin(), 8.0 * (s / 60.0).sin()];
        text += &format!("G1 X{:.4} Y{y:.4} Z{z:.4} A{a:.4} B0 C{c:.4}\n", 900.0 + s);
    }
    text += "M2\n";
    let program = interpret(&text, Options::default()).expect("a program");
    with_job(&program, None, None, |job| prediction::run(boards, job))
}

/// Does something with the shipped program along `seam`.
fn with_weld<R>(seam: Deviation, speed_m_per_min: f64, act: impl FnOnce(&Job) -> R) -> R {
    with_job(&program(), Some(seam), Some(speed_m_per_min), act)
}

/// Does something with a program on the shipped machine.
fn with_job<R>(
    program: &Program,
    seam: Option<Deviation>,
    speed_m_per_min: Option<f64>,
    act: impl FnOnce(&Job) -> R,
) -> R {
    act(&job(&machine(), program, with_seam(seam), speed_m_per_min))
}

fn job<'a>(
    machine: &'a MachineFile,
    program: &'a Program,
    surroundings: Surroundings,
    speed_m_per_min: Option<f64>,
) -> Job<'a> {
    Job {
        machine,
        work: Work::Program(program),
        speed_m_per_min,
        from_line: None,
        part: None,
        spooling: Default::default(),
        names: Names {
            program: PROGRAM.into(),
            machine: MACHINE.into(),
            seam: surroundings.seam.as_ref().map(|_| "seam".into()),
            boards: "test".into(),
        },
        surroundings: surroundings.into(),
    }
}

/// Surroundings with nothing but a seam, which is seen by geometry.
fn with_seam(seam: Option<Deviation>) -> Surroundings {
    Surroundings {
        seam: seam.map(Arc::new),
        ..Surroundings::default()
    }
}

/// The machines without a tracker and their shipped jobs.
pub const JOBS: [(&str, &str); 4] = [
    ("pipe-welder", "programs/saddle-320-80.ngc"),
    ("ac-head", "programs/panel.toml"),
    ("wire-arc", "programs/leaf.ngc"),
    ("stir-gantry", "programs/stir-contour.ngc"),
];

/// Does the shipped `job` of `machine`, by its short names as in [`JOBS`]; a program takes as long as predicted.
pub fn weld_job(boards: &mut dyn Boards, machine: &str, job: &str) -> Ended {
    let file = shipped(&format!("machines/{machine}.toml"));
    let machine_file = MachineFile::read(&file).unwrap_or_else(|error| panic!("{error}"));
    let job_file = shipped(job);
    let text = std::fs::read_to_string(&job_file).expect("a shipped job");
    // A job that is a part has to be taught first.
    let program = (!job.ends_with(".toml"))
        .then(|| interpret(&text, Options::default()).unwrap_or_else(|error| panic!("{job}: {error}")));
    let part = PartFile::of_program(&job_file).unwrap_or_else(|error| panic!("{error}"));
    assert!(part.is_some(), "{job} is judged by nothing");
    let job = Job {
        machine: &machine_file,
        work: program.as_ref().map_or(Work::TeachAndMake, Work::Program),
        part: part.as_ref(),
        speed_m_per_min: None,
        from_line: None,
        surroundings: Surroundings::default().into(),
        spooling: Default::default(),
        names: Names {
            program: job.into(),
            machine: machine.into(),
            seam: None,
            boards: "test".into(),
        },
    };
    prediction::run(boards, &job)
}

/// Checks that a job came to its end, undisturbed and in its time, within the limits of its part.
///
/// # Panics
/// Where it is not so.
pub fn assert_within_limits(ended: &Ended) {
    let report = &ended.report;
    println!("{report}");
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert!(
        report.figures.iter().any(|figure| figure.limit.is_some()),
        "{report}"
    );
    let exceeded: Vec<_> = report.exceeded().map(|figure| figure.key).collect();
    assert!(exceeded.is_empty(), "{exceeded:?}\n{report}");
    assert_eq!(report.unwelded, [], "{report}");
    assert_eq!((report.lost_ticks.total(), report.telemetry_gaps.total()), (0, 0));
    assert_eq!(report.weld_ticks.unknown, 0, "{report}");
    let late = (report.motion_s - report.planned_motion_s).abs();
    assert!(
        late < 0.002 * report.planned_motion_s + 0.05,
        "{late} s\n{report}"
    );
}

/// Largest deviation of each slide \[mm\].
///
/// # Panics
/// Where it was not evaluated at every tick of the weld.
pub fn deviations(report: &Report) -> [f64; 4] {
    assert_eq!(report.weld_ticks.unknown, 0, "{report}");
    let max = report.seam.as_ref().expect("a tracker").max_deviation_mm;
    [max.u1, max.v1, max.u2, max.v2].map(|max| max.expect("a weld"))
}

/// Checks that a job came to its end, undisturbed, and that no spot was ever further than `limit_mm` from its
/// seam.
///
/// # Panics
/// Where it is not so.
pub fn assert_on_seam(ended: &Ended, limit_mm: f64) {
    assert_welded(ended, 400.0, limit_mm);
}

/// The same of a weld of another length than the seam's \[mm\].
fn assert_welded(ended: &Ended, length_mm: f64, limit_mm: f64) {
    let report = &ended.report;
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_eq!(report.faults, [""; 0]);
    assert_eq!(report.unwelded, [], "{report}");
    assert_eq!((report.lost_ticks.total(), report.telemetry_gaps.total()), (0, 0));
    assert!((report.weld_length_mm - length_mm).abs() < 0.5, "{report}");
    let deviations = deviations(report);
    println!("{:4} m/min: {deviations:.4?} mm", report.speed_m_per_min);
    assert!(deviations.iter().all(|max| *max <= limit_mm), "{report}");
}
