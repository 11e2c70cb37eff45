//! What a run truly was, tick by tick: the true tool against the programmed path, and the true spots against the
//! true seams.

mod joint;
mod load;
mod nearest;
mod peak;
mod samples;
mod speeds;
mod switching;
mod tick;
mod welded;

pub use joint::{
    JOINT_QUANTITIES, JointCourse, JointFigures, JointPoint, JointQuantity, JointSample, joint_course,
};
pub use load::{ExecutionTimes, Load};
pub use samples::{RecordedRun, RunSample, RunSamples};
pub use switching::Switching;
pub use tick::WorkTick;
pub use welded::{SpeedShares, Welded};

use cam::along::Along;
use cam::path::PlannedPath;
use host_link::geometry::MachineGeometry;
use host_link::record::Recorded;
use host_link::spool::Spool;
use load::Loads;
use peak::Peak;
use shared::geometry::Pose;
use shared::io::{MOTORS, SLIDES};
use shared::protocol::MotionSample;
use shared::ticks::PATH_PERIOD_S;
use speeds::TrueSpeeds;
use std::collections::BTreeMap;
use switching::Switchings;
use tick::{work_tick, working};

/// Figures of a job.
#[derive(Debug, Default, PartialEq)]
pub struct Evaluation {
    /// Every tick on a path that works.
    pub ticks: Spool<WorkTick>,
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
    /// The joint along both seams, as the cameras saw it; nothing without pictures.
    pub joint: JointCourse,
    /// How exactly gates and outputs were switched; `None` if nothing was in motion.
    pub switching: Option<Switching>,
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

/// Evaluates a record of a job that ran `paths`, by their numbers, beside the seams that it `followed`, where they are known.
pub fn evaluate(
    record: &Recorded,
    machine: &MachineGeometry,
    paths: &BTreeMap<u32, PlannedPath>,
    followed: Option<Followed>,
) -> Evaluation {
    let along = Along::of(paths);
    let working = working(paths, &along);
    let any_beam = on_paths(record).any(|s| working.contains_key(&s.path_id) && s.beams.contains(&true));
    let mut result = Evaluation {
        ticks: Spool::new(record.spooling().clone()),
        seams_known: followed.is_some(),
        ..Evaluation::default()
    };
    let mut deviation = [Peak::default(); SLIDES];
    let mut contour = Peak::default();
    let (mut speeds, mut loads) = (TrueSpeeds::default(), Loads::default());
    let mut slides = record.slides();
    let mut switchings = Switchings::new(paths);
    let mut welded_to: Option<MotionSample> = None;
    let mut before: Option<MotionSample> = None;
    for sample in on_paths(record) {
        sample.load.iter().for_each(|load| loads.add(load));
        switchings.add(&sample);
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
        let (tick, tip) = work_tick(&sample, &mut slides, machine, work, followed);
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
        speeds.push(tick, tip, &mut result.ticks);
    }
    speeds.end_path(&mut result.ticks);
    result.max_deviation_mm = deviation.map(|peak| peak.max());
    result.rms_deviation_mm = deviation.map(|peak| peak.rms());
    result.max_contour_error_mm = contour.max();
    result.load = loads.all();
    result.switching = switchings.all();
    result
}

fn on_paths(record: &Recorded) -> impl Iterator<Item = MotionSample> {
    record.motion().iter().filter(|sample| sample.state.on_path())
}
