//! What a run truly was, tick by tick: the true tool against the programmed path, and the true spots against the
//! true seams.

mod load;
mod nearest;
mod peak;
mod speeds;
mod tick;
mod welded;

pub use load::{ExecutionTimes, Load};
pub use tick::WorkTick;
pub use welded::{SpeedShares, Welded};

use cam::along::Along;
use cam::path::PlannedPath;
use host_link::geometry::MachineGeometry;
use host_link::record::Record;
use nalgebra::Vector3;
use peak::Peak;
use shared::geometry::Pose;
use shared::io::{AXES, MOTORS, SIDES, SLIDES};
use shared::protocol::MotionSample;
use shared::state::State;
use shared::ticks::PATH_PERIOD_S;
use speeds::add_true_speeds;
use std::collections::BTreeMap;
use tick::{work_tick, working};

/// Figures of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// Every tick on a path that works.
    pub ticks: Vec<WorkTick>,
    /// Ticks with a beam on; all of them if no beam ever was.
    pub weld_ticks: u32,
    /// Length of path between them \[mm\].
    pub weld_length_mm: f64,
    /// Whether the true seams are known, and deviations with them.
    pub seams_known: bool,
    /// Speeds with a beam on, beside the feed; `None` without beams.
    pub speed: Option<SpeedShares>,
    /// Of these, ticks whose deviation is not known, since telemetry is missing or the seam ended.
    pub unknown_ticks: u32,
    /// Largest |deviation| with the beam of that side on \[mm\].
    pub max_deviation_mm: [Option<f64>; SLIDES],
    /// Root mean square of the same \[mm\].
    pub rms_deviation_mm: [Option<f64>; SLIDES],
    /// Largest distance of the tip from the programmed path in the ticks of `weld_ticks` \[mm\].
    pub max_contour_error_mm: Option<f64>,
    /// Largest |following error| of each motor on any path (mm, rad).
    pub max_following_error: [f64; MOTORS],
    /// Largest skew of the gantry on any path \[mm\].
    pub max_skew_mm: f64,
    /// Time on the paths by the motion board's clock \[s\].
    pub motion_s: f64,
    /// What the ticks on the paths took, if the board has a processor of its own.
    pub load: Option<Load>,
}

/// Where the seams truly are: known to whoever simulates them, or measured afterwards.
pub trait SeamTruth {
    /// U and V at which the slides of `side` put the spot on its seam when the tool is at `pose` \[mm\]; `None` where
    /// there is no seam.
    fn on_seam(&self, side: usize, pose: &Pose) -> Option<[f64; 2]>;
}

/// The seams that were followed.
#[derive(Clone, Copy)]
pub struct Followed<'a> {
    /// As they really are.
    pub seams: &'a dyn SeamTruth,
    /// How far the tracker's clock is ahead of the motion board's \[µs\].
    pub tracker_ahead_us: i64,
}

/// The machine at one tick of the motion board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSample {
    /// Time on the motion board's clock \[µs\].
    pub time_us: u64,
    /// Number of the path.
    pub path_id: u32,
    /// Programmed position on it \[mm\].
    pub s_mm: f64,
    /// Programmed speed along it \[mm/s\].
    pub speed_mm_s: f64,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Where the axes truly stood (mm, rad); by the gratings on a real machine.
    pub axes: [f64; AXES],
    /// Where the tool truly was, in the frame of the work.
    pub pose: Pose,
}

/// Evaluates a record of a job that ran `paths`, by their numbers, beside the seams that it `followed`, where they are known.
pub fn evaluate(
    record: &Record,
    machine: &MachineGeometry,
    paths: &BTreeMap<u32, PlannedPath>,
    followed: Option<Followed>,
) -> Evaluation {
    let along = Along::of(paths);
    let working = working(paths, &along);
    let mut tips: Vec<Option<Vector3<f64>>> = Vec::new();
    let any_beam = on_paths(record).any(|s| working.contains_key(&s.path_id) && s.beams.contains(&true));
    let mut result = Evaluation {
        seams_known: followed.is_some(),
        ..Evaluation::default()
    };
    let mut deviation = [Peak::default(); SLIDES];
    let mut contour = Peak::default();
    let mut welded_to: Option<&MotionSample> = None;
    let mut before: Option<&MotionSample> = None;
    for sample in on_paths(record) {
        for (max, seen) in result.max_following_error.iter_mut().zip(sample.following_error) {
            *max = max.max(f64::from(seen));
        }
        result.max_skew_mm = result.max_skew_mm.max(f64::from(sample.skew_mm));
        // The first sample of a path is told a tick after its beginning.
        let before_here = before.filter(|before| before.path_id == sample.path_id);
        result.motion_s += before_here.map_or(PATH_PERIOD_S, |before| {
            (sample.time_us - before.time_us) as f64 * 1e-6
        });
        before = Some(sample);
        let Some(work) = working.get(&sample.path_id) else {
            continue;
        };
        let (tick, tip) = work_tick(sample, record, machine, work, followed);
        tips.push(tip);
        if any_beam && !sample.beams.contains(&true) {
            welded_to = None;
        } else {
            let from = welded_to.filter(|before| before.path_id == sample.path_id);
            result.weld_length_mm += from.map_or(0.0, |before| sample.s_mm - before.s_mm);
            welded_to = Some(sample);
            result.weld_ticks += 1;
            let unseen = |i: usize| sample.beams[i / 2] && tick.deviation_mm[i].is_none();
            let unknown = tick.contour_error_mm.is_none() || followed.is_some() && (0..SLIDES).any(unseen);
            result.unknown_ticks += u32::from(unknown);
            contour.add(tick.contour_error_mm);
        }
        for (i, peak) in deviation.iter_mut().enumerate() {
            if sample.beams[i / 2] {
                peak.add(tick.deviation_mm[i]);
            }
        }
        result.ticks.push(tick);
    }
    add_true_speeds(&mut result.ticks, &tips);
    result.max_deviation_mm = deviation.map(|peak| peak.max());
    result.rms_deviation_mm = deviation.map(|peak| peak.rms());
    result.max_contour_error_mm = contour.max();
    result.load = Load::of(on_paths(record).filter_map(|sample| sample.load));
    result
}

/// The machine at every tick on one of `paths`.
pub fn run_samples(
    record: &Record,
    machine: &MachineGeometry,
    paths: &BTreeMap<u32, PlannedPath>,
) -> Vec<RunSample> {
    on_paths(record)
        .filter(|sample| paths.contains_key(&sample.path_id))
        .filter_map(|sample| {
            let (position, _) = record.machine_at(sample.time_us)?;
            let axes = machine.axes(&position);
            Some(RunSample {
                time_us: sample.time_us,
                path_id: sample.path_id,
                s_mm: sample.s_mm,
                speed_mm_s: sample.speed_mm_s,
                beams: sample.beams,
                axes,
                pose: machine.kinematics().forward(&axes),
            })
        })
        .collect()
}

fn on_paths(record: &Record) -> impl Iterator<Item = &MotionSample> {
    let on_path = |s: &&MotionSample| matches!(s.state, State::Running | State::Holding | State::Stopping);
    record.motion().iter().filter(on_path)
}
