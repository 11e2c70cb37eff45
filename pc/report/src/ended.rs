//! What came of a job: evaluated and judged.

use crate::unwelded::unwelded;
use crate::{
    BoardsUsed, ByMotor, JudgedBy, LogColumns, Measurements, Outcome, Report, SeamFigures, Truth, WeldTicks,
};
use cam::along::{Along, works};
use cam::dry_run::{self, DryRunError};
use cam::path::{PathError, PlannedPath};
use evaluate::{Evaluation, Followed, RecordedRun, SpeedShares, evaluate, joint_course};
use host_link::record::Recorded;
use job::{ByBoard, Job, JobError, RunRecord, Taught, TrackingRecord};
use parts::{Judgement, PartFile, Plot, Run, SeamLimits};
use shared::io::MOTOR_AXIS;
use shared::kinematics::AXIS_UNIT;
use shared::motion;
use shared::protocol::Identity;
use shared::state::TrackerFault;
use shared::units::MM_S_PER_M_MIN;

/// Part of the vibration limit above which people are warned.
const VIBRATION_WARNED: f64 = 0.5;

/// A job after its end.
#[derive(Debug)]
pub struct Ended {
    /// Why it ended early.
    pub error: Option<JobError>,
    /// Whether the machine moved along a path, so that there is something to report.
    pub began: bool,
    /// The report.
    pub report: Report,
    /// What it rests on.
    pub evaluation: Evaluation,
    /// Plots of the part's own.
    pub plots: Vec<Plot>,
    /// What was taught, as far as it came.
    pub taught: Taught,
    /// What the boards told.
    pub record: Recorded,
    /// Columns of its log.
    pub columns: LogColumns,
}

/// Evaluates what the boards told of `job`, and judges the run.
pub fn ended(job: &Job, mut run: RunRecord) -> Ended {
    let mut error = run.error.take();
    let paths = &run.paths;
    let truth = job.surroundings.truth();
    let known = truth.as_deref().zip(run.tracking.as_ref());
    let followed = known.map(|(seams, tracking)| Followed {
        seams,
        tracker_ahead_us: tracking.tracker_ahead_us,
    });
    let mut evaluation = evaluate(&run.record, &run.machine, paths, followed);
    evaluation.speed = SpeedShares::of(&evaluation.ticks, paths, &job.machine.motion.beams);
    if let Some(tracking) = &run.tracking {
        evaluation.joint = joint_course(&tracking.joint, paths, run.record.spooling());
    }
    let mut judgement = Judgement::default();
    let mut judged_by = None;
    match judge(&run, job, &evaluation, run.taught.part.as_ref().or(job.part)) {
        Ok((by, judged)) => (judged_by, judgement) = (by, judged),
        // What ended early is judged as far as it came, where that can be.
        Err(_) if error.is_some() => {}
        Err(reason) => error = Some(JobError::Judge(format!("{reason:#}"))),
    }
    let along = Along::of(paths);
    // A place of the path that was run last, as path length through all paths.
    let last = last_path(&run);
    let here = |s_mm: f64| last.and_then(|last| along.at(last, s_mm)).unwrap_or(s_mm);
    let mut error = error.map(|error| along_all_paths(error, &here));
    let planned_motion_s = dry_run::motion_s(job.machine, paths.values());
    // Here, as for all figures above, long programs are read again.
    if let Err(DryRunError::Path(lost @ PathError::Program(_))) = &planned_motion_s {
        error.get_or_insert(JobError::Judge(lost.to_string()));
    }
    let unwelded = unwelded(&run.record, job.machine, paths).unwrap_or_else(|lost| {
        error.get_or_insert(JobError::Judge(lost.to_string()));
        Vec::new()
    });
    // All figures above come of what was kept.
    let ticks = evaluation
        .ticks
        .check()
        .map_err(|lost| format!("the evaluated ticks are not complete: {lost}"));
    let joint = run
        .tracking
        .as_ref()
        .map_or(Ok(()), |tracking| tracking.joint.check());
    let joint = joint.and(evaluation.joint.points.check());
    let joint = joint.map_err(|lost| format!("what was seen of the joint is not complete: {lost}"));
    let told = run.record.check().map_err(|lost| lost.to_string());
    if let Err(lost) = told.and(ticks).and(joint) {
        error.get_or_insert(JobError::Judge(lost));
    }
    let outcome = match &error {
        None => Outcome::Finished,
        Some(JobError::Interrupted) => Outcome::Interrupted,
        Some(_) => Outcome::Failed,
    };
    let (motion_gaps, tracker_gaps) = run.record.missing();
    let motors = &job.machine.motion.motors;
    let following = |motor: usize| {
        let unit = AXIS_UNIT[MOTOR_AXIS[motor]];
        motors[motor]
            .as_ref()
            .map(|_| evaluation.max_following_error[motor] / unit)
    };
    let vibration_limit = |motor: usize| {
        let limit = motors[motor].as_ref().map(|motor| motor.vibration_limit);
        limit.filter(|limit| *limit > 0.0)
    };
    let working = paths.values().filter(|path| works(path));
    let longest = working.max_by(|a, b| a.length_mm().total_cmp(&b.length_mm()));
    let speed_mm_s = longest.map(|path| path.limits.velocity);
    let report = Report {
        outcome,
        program: job.names.program.clone(),
        machine: job.names.machine.clone(),
        part: job.part.map(|part| part.path().display().to_string()),
        judged_by,
        boards: BoardsUsed {
            choice: job.names.boards.clone(),
            motion: run.motion.as_ref().map(board_name).unwrap_or_default(),
            tracker: run
                .tracking
                .as_ref()
                .and_then(|tracking| tracking.identity.as_ref().map(board_name)),
        },
        truth: truth_of(&run),
        speed_m_per_min: speed_mm_s.unwrap_or(0.0) / MM_S_PER_M_MIN,
        weld_length_mm: evaluation.weld_length_mm,
        speed: evaluation.speed,
        max_contour_error_mm: evaluation.max_contour_error_mm,
        max_following_error: ByMotor(std::array::from_fn(following)),
        following_error_trip: ByMotor(std::array::from_fn(|motor| {
            motors[motor].as_ref().map(|motor| motor.following_error_base)
        })),
        vibration: ByMotor(std::array::from_fn(|motor| {
            motors[motor].as_ref().map(|_| f64::from(run.vibration[motor]))
        })),
        vibration_limit: ByMotor(std::array::from_fn(vibration_limit)),
        vibration_warned: ByMotor(std::array::from_fn(|motor| {
            let limit = motion::vibration_limit(motor, motors[motor].as_ref()?);
            Some(VIBRATION_WARNED * limit)
        })),
        max_gantry_skew_um: job
            .machine
            .motion
            .gantry
            .as_ref()
            .map(|_| evaluation.max_skew_mm * 1e3),
        weld_ticks: WeldTicks {
            recorded: evaluation.weld_ticks,
            unknown: evaluation.unknown_ticks,
        },
        lost_ticks: run.lost_ticks,
        switching: evaluation.switching,
        load: evaluation.load,
        telemetry_gaps: ByBoard {
            motion: motion_gaps,
            tracker: run.tracking.as_ref().map(|_| tracker_gaps),
        },
        dropped_datagrams: run.dropped_datagrams,
        seam: run
            .tracking
            .as_ref()
            .map(|tracking| seam_figures(tracking, job, &evaluation)),
        figures: judgement.figures,
        not_judged: judgement.not_judged,
        unwelded,
        planned_motion_s: planned_motion_s.unwrap_or(f64::NAN),
        motion_s: evaluation.motion_s,
        faults: faults(&run, error.as_ref(), &here),
        duration_s: run.duration.as_secs_f64(),
    };
    Ended {
        error,
        began: !paths.is_empty(),
        report,
        evaluation,
        plots: judgement.plots,
        taught: run.taught,
        record: run.record,
        columns: LogColumns::of(job.machine),
    }
}

/// Judges by the part; a seam that was followed without one, by what is shipped for those.
fn judge(
    record: &RunRecord,
    job: &Job,
    evaluation: &Evaluation,
    part: Option<&PartFile>,
) -> anyhow::Result<(Option<JudgedBy>, Judgement)> {
    let run = Run {
        machine: job.machine,
        kinematics: record.machine.kinematics(),
        paths: &record.paths,
        samples: &RecordedRun {
            record: &record.record,
            machine: &record.machine,
            paths: &record.paths,
        },
        evaluation,
    };
    if let Some(part) = part {
        return Ok((Some(JudgedBy::Part), part.judge(&run)?));
    }
    let welded = |path: &PlannedPath| path.weld().is_some() && path.programmed().tracked;
    if record.tracking.is_some() && record.paths.values().any(welded) {
        let judgement = SeamLimits::default().judge_all(&run);
        return Ok((Some(JudgedBy::ShippedSeamLimits), judgement));
    }
    Ok((None, Judgement::default()))
}

/// The error with its place as plots and log have it: path length through all paths.
fn along_all_paths(error: JobError, here: &impl Fn(f64) -> f64) -> JobError {
    match error {
        JobError::Tracker(fault) => JobError::Tracker(placed(fault, here)),
        JobError::Standstill { line, s_mm, seconds } => JobError::Standstill {
            line,
            s_mm: here(s_mm),
            seconds,
        },
        other => other,
    }
}

/// A fault of the tracker board with its place as plots and log have it.
fn placed(fault: TrackerFault, here: &impl Fn(f64) -> f64) -> TrackerFault {
    let mut fault = fault;
    if let TrackerFault::LostSeam { s_mm, .. }
    | TrackerFault::SeamNotSeen { s_mm, .. }
    | TrackerFault::BesideSeam { s_mm, .. } = &mut fault
    {
        *s_mm = here(f64::from(*s_mm)) as f32;
    }
    fault
}

/// Number of the path that was run last.
fn last_path(run: &RunRecord) -> Option<u32> {
    let on_paths = run.record.motion().iter().filter(|sample| sample.state.on_path());
    on_paths.last().map(|sample| sample.path_id)
}

fn board_name(identity: &Identity) -> String {
    format!("{} {}", identity.board, identity.firmware)
}

fn truth_of(run: &RunRecord) -> Truth {
    let tracker = run.tracking.as_ref().map(|tracking| &tracking.identity);
    let simulated = |identity: &Option<Identity>| {
        identity
            .as_ref()
            .is_some_and(|identity| identity.simulated_machine)
    };
    if simulated(&run.motion) && tracker.is_none_or(simulated) {
        Truth::SimulatedMachine
    } else {
        Truth::GratingsAndEncoders
    }
}

fn seam_figures(tracking: &TrackingRecord, job: &Job, evaluation: &Evaluation) -> SeamFigures {
    SeamFigures {
        seam: job.names.seam.clone(),
        max_deviation_mm: evaluation.max_deviation_mm.into(),
        rms_deviation_mm: evaluation.rms_deviation_mm.into(),
        joint: evaluation.joint.figures.map(Into::into),
        measurements: Measurements {
            accepted: tracking.status.accepted,
            rejected: tracking.status.rejected,
            too_old: tracking.status.too_old,
            given_up: tracking.given_up,
        },
        pictures: tracking.pictures,
        strobe_to_measurement_ms: tracking.delays,
        picture_to_measurement_ms: tracking.picture_delays,
        clock_residual_us: tracking.clock_residual_us,
        clock_difference_us: tracking.clock_difference_us,
        recentred: tracking.recentred.clone(),
    }
}

/// Why the job ended early, and the faults that the boards tell, each once.
fn faults(run: &RunRecord, error: Option<&JobError>, here: &impl Fn(f64) -> f64) -> Vec<String> {
    let mut faults: Vec<String> = error.iter().map(ToString::to_string).collect();
    let tracker = run.tracking.as_ref().and_then(|t| t.status.fault);
    let told = [
        run.motion_fault.map(|fault| fault.to_string()),
        tracker.map(|fault| placed(fault, here).to_string()),
    ];
    for fault in told.into_iter().flatten() {
        if !faults.iter().any(|known| known.contains(&fault)) {
            faults.push(fault);
        }
    }
    faults
}
