//! What a dry run says of a job beside the run itself.

use crate::{NoOperator, RecordedBoards, TappedBoards};
use cam::dry_run;
use cam::dry_run::DryRun;
use cam::path::Planner;
use host_link::boards::Boards;
use job::{Job, Work};
use nc::Program;
use report::Ended;
use shared::protocol::MotionSample;
use shared::units::MM_S_PER_M_MIN;

/// How far the predicted duration of a job may be off, as a part of it, ...
const JOB: f64 = 0.005;
/// ... and that of its motion, without what lies between the paths.
const MOTION: f64 = 0.001;

/// Does a job. If nothing ends it early, references are those of a dry run that gets the elements at the same ticks, to the
/// bit; if it is one of a program, it takes as long as a dry run says.
///
/// # Panics
/// Where it does not.
pub fn run(boards: &mut dyn Boards, job: &Job) -> Ended {
    let mut seen = OnPaths::default();
    let mut recorded = RecordedBoards::new(boards);
    let ended = run_heard(&mut recorded, job, |_, sample| seen.on_sample(sample));
    let (same, touched) = recorded.paths();
    let late_s = 1e-3 * f64::from(recorded.late_ticks());
    println!(
        "{same} paths with the references of a dry run, {touched} with a hand in them; {late_s:.3} s as elements came late"
    );
    assert!(ended.error.is_some() || same > 0);
    if let (Work::Program(program), None) = (&job.work, &ended.error) {
        seen.assert_predicted(&dry_run(job, program));
    }
    ended
}

/// Does a job; `on_sample` gets every sample of the motion board, and may act.
pub fn run_heard(
    boards: &mut dyn Boards,
    job: &Job,
    on_sample: impl FnMut(&mut dyn Boards, &MotionSample),
) -> Ended {
    let mut tapped = TappedBoards { boards, on_sample };
    crate::run(&mut tapped, job, &mut NoOperator).unwrap_or_else(|error| panic!("{error}"))
}

/// What `seamwright dry-run` does.
fn dry_run(job: &Job, program: &Program) -> DryRun {
    let machine = job.machine;
    let speed = job.speed_m_per_min.map(|m_min| m_min * MM_S_PER_M_MIN);
    let planner = Planner::build(machine).unwrap_or_else(|error| panic!("{error}"));
    let paths = planner
        .program(program, &machine.homed_axes(), speed)
        .unwrap_or_else(|error| panic!("{error}"));
    dry_run::run(machine, &planner, &paths, 1.0).unwrap_or_else(|error| panic!("{error}"))
}

/// When the machine was on a path, in ticks of the motion board: the first one, the last one, and how many.
#[derive(Default)]
struct OnPaths {
    first: Option<u32>,
    last: u32,
    ticks: u32,
}

impl OnPaths {
    fn on_sample(&mut self, sample: &MotionSample) {
        if sample.state.on_path() {
            self.first.get_or_insert(sample.tick);
            self.last = sample.tick;
            self.ticks += 1;
        }
    }

    fn assert_predicted(&self, predicted: &DryRun) {
        let first = self.first.expect("a job with paths");
        let job = 1e-3 * f64::from(self.last - first + 1);
        let motion = 1e-3 * f64::from(self.ticks);
        println!(
            "predicted {:.3} s of it {:.3} s in motion, seen {job:.3} and {motion:.3} s",
            predicted.duration_s, predicted.motion_s
        );
        for (what, predicted, seen, limit) in [
            ("job", predicted.duration_s, job, JOB),
            ("motion", predicted.motion_s, motion, MOTION),
        ] {
            let off = predicted / seen - 1.0;
            assert!(
                off.abs() < limit,
                "{what}: {predicted} s, {:.3} % off",
                100.0 * off
            );
        }
    }
}
