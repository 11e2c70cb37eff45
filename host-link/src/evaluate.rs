//! How well it went, tick by tick: the true tool against the programmed path, and the true spots against the
//! true seams.

use crate::along::Along;
use crate::part::RunSample;
use crate::path::{Course, PlannedPath, Programmed};
use crate::record::Record;
use crate::report::Load;
use crate::seam::OVERHANG_MM;
use crate::welded::SpeedShares;
use crate::world::{Machine, TrueSeams};
use nalgebra::Vector3;
use shared::io::{MOTORS, SIDES, SLIDES};
use shared::motion::{PATH_PERIOD_S, State};
use shared::protocol::MotionSample;
use std::collections::BTreeMap;

/// The place nearest to the tip is known this well \[mm\].
const NEAREST: f64 = 1e-9;
/// Steps of the search for it.
const STEPS: usize = 50;
/// The true speed is that of the way over so many ticks before and after, 8 ms in all: a grating of 0.1 µm then makes
/// less than 0.02 mm/s of noise.
const HALF: usize = 4;
/// Slow processes are looked at over at least so much before and after \[mm\]: what is shorter does not show in a seam,
/// and a drive that sticks for a micrometre is no change of speed.
pub(crate) const HALF_MM: f64 = 0.05;

/// A tick of the motion board on a path that works: one of G1, or with a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkTick {
    /// Path tick.
    pub tick: u32,
    /// Number of the path.
    pub path_id: u32,
    /// Place of the path nearest to the true tip; where that is not known, the programmed one \[mm\].
    pub s_mm: f64,
    /// Programmed position as a length through all such paths: see [`Along`] \[mm\].
    pub along_mm: f64,
    /// Path speed, as the motion board planned it \[mm/s\].
    pub speed_mm_s: f64,
    /// Programmed feed at that place \[mm/s\].
    pub feed_mm_s: f64,
    /// True speed of the tip \[mm/s\]; `None` in a gap of the telemetry.
    pub true_speed_mm_s: Option<f64>,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Slides at that time (the truth if there is one) \[mm\]; `None` in a gap of the telemetry.
    pub slides_mm: Option<[f64; SLIDES]>,
    /// Spot minus seam, u1 v1 u2 v2, in the plane through the spot perpendicular to T \[mm\].
    pub deviation_mm: [Option<f64>; SLIDES],
    /// Distance of the tip from the programmed path \[mm\].
    pub contour_error_mm: Option<f64>,
    /// Largest |following error| of each motor in the tick (mm, rad).
    pub following_error: [f32; MOTORS],
}

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

/// The seams that were followed.
#[derive(Clone, Copy)]
pub struct Followed<'a> {
    /// As they really are.
    pub seams: &'a TrueSeams,
    /// How far the tracker's clock is ahead of the motion board's \[µs\].
    pub tracker_ahead_us: i64,
}

/// Evaluates a record of a job that ran `paths`, by their numbers.
pub fn evaluate(
    record: &Record,
    machine: &Machine,
    paths: &BTreeMap<u32, PlannedPath>,
    followed: Option<Followed>,
) -> Evaluation {
    let followed = followed.filter(|followed| !followed.seams.is_empty());
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
pub fn run_samples(record: &Record, machine: &Machine, paths: &BTreeMap<u32, PlannedPath>) -> Vec<RunSample> {
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

/// A path that works.
struct Work {
    path: Course,
    programmed: Programmed,
    /// `along_mm` at its beginning.
    along_mm: f64,
}

fn working(paths: &BTreeMap<u32, PlannedPath>, along: &Along) -> BTreeMap<u32, Work> {
    let work = |(id, path): (&u32, &PlannedPath)| {
        let work = Work {
            path: path.path(),
            programmed: path.programmed(),
            along_mm: along.at(*id, 0.0)?,
        };
        Some((*id, work))
    };
    paths.iter().filter_map(work).collect()
}

/// Gives each tick the true speed, from where the tips were before and after it on the same path.
fn add_true_speeds(ticks: &mut [WorkTick], tips: &[Option<Vector3<f64>>]) {
    // Way from the beginning, and ticks without a known tip; a path goes on from tick to tick.
    let (mut way, mut unknown) = (vec![0.0; ticks.len()], vec![0_u32; ticks.len()]);
    let mut path = vec![0..0; ticks.len()];
    for i in 1..ticks.len() {
        let step = tips[i]
            .zip(tips[i - 1])
            .map(|(tip, before)| (tip - before).norm());
        way[i] = way[i - 1] + step.unwrap_or(0.0);
        unknown[i] = unknown[i - 1] + u32::from(step.is_none());
    }
    let mut start = 0;
    for chunk in ticks.chunk_by(|a, b| a.path_id == b.path_id) {
        let end = start + chunk.len();
        path[start..end].fill(start..end);
        start = end;
    }
    for i in 0..ticks.len() {
        let slow = HALF_MM / (ticks[i].feed_mm_s * PATH_PERIOD_S);
        let half = HALF.max(if slow.is_finite() { slow.ceil() as usize } else { 0 });
        let from = i.saturating_sub(half).max(path[i].start);
        let to = (i + half).min(path[i].end - 1);
        let time = f64::from(ticks[to].tick - ticks[from].tick) * PATH_PERIOD_S;
        let known = unknown[to] == unknown[from] && time > 0.0;
        ticks[i].true_speed_mm_s = known.then_some((way[to] - way[from]) / time);
    }
}

fn work_tick(
    sample: &MotionSample,
    record: &Record,
    machine: &Machine,
    work: &Work,
    followed: Option<Followed>,
) -> (WorkTick, Option<Vector3<f64>>) {
    let pose = record
        .machine_at(sample.time_us)
        .map(|(position, _)| machine.pose(&position));
    let slides_mm =
        followed.and_then(|f| record.slides_at(sample.time_us.checked_add_signed(f.tracker_ahead_us)?));
    let mut deviation_mm = [None; SLIDES];
    if let (Some(pose), Some(slides), Some(followed)) = (pose, slides_mm, followed) {
        let seams = followed.seams;
        for side in 0..SIDES {
            let facing = seams.facing(side, &seams.heads().spot(&pose, side), 0.0);
            let facing = facing.filter(|(seam, crossing)| seam.exists_at(crossing.s, OVERHANG_MM));
            if let Some((_, crossing)) = facing {
                deviation_mm[2 * side] = Some(slides[2 * side] - crossing.u);
                deviation_mm[2 * side + 1] = Some(slides[2 * side + 1] - crossing.v);
            }
        }
    }
    let tip = pose.map(|pose| pose.position);
    let nearest = tip.and_then(|tip| nearest(&work.path, &tip, sample.s_mm));
    let tick = WorkTick {
        tick: sample.tick,
        path_id: sample.path_id,
        s_mm: nearest.map_or(sample.s_mm, |nearest| nearest.s_mm),
        along_mm: work.along_mm + sample.s_mm,
        speed_mm_s: sample.speed_mm_s,
        feed_mm_s: work.programmed.feed_at(sample.s_mm),
        true_speed_mm_s: None,
        beams: sample.beams,
        slides_mm,
        deviation_mm,
        contour_error_mm: nearest.map(|nearest| nearest.distance_mm),
        following_error: sample.following_error,
    };
    (tick, tip)
}

/// A place of a path.
#[derive(Clone, Copy, Debug)]
struct Nearest {
    s_mm: f64,
    distance_mm: f64,
}

/// The place of `path` nearest to `tip`, searched from path position `s` on \[mm\]. Beyond its ends a path has no
/// points.
fn nearest(path: &Course, tip: &Vector3<f64>, s: f64) -> Option<Nearest> {
    let (start, end) = (path.start_s()?, path.end_s()?);
    let mut s = s.clamp(start, end);
    // Outside of a corner the search goes to and fro between its sides.
    let (mut damped, mut last) = (1.0, 0.0);
    let mut nearest = Nearest {
        s_mm: s,
        distance_mm: f64::INFINITY,
    };
    for _ in 0..STEPS {
        let point = path.at(s)?;
        let place = |channels: &[f64]| Vector3::from_column_slice(&channels[..3]);
        let (apart, slope) = (tip - place(&point.value), place(&point.first));
        let here = Nearest {
            s_mm: s,
            distance_mm: apart.norm(),
        };
        if here.distance_mm < nearest.distance_mm {
            nearest = here;
        }
        let mut step = damped * apart.dot(&slope) / slope.norm_squared();
        if step * last < 0.0 {
            damped *= 0.5;
            step *= 0.5;
        }
        last = step;
        let next = (s + step).clamp(start, end);
        if next.is_nan() || (next - s).abs() < NEAREST {
            return Some(here);
        }
        s = next;
    }
    (damped < 1.0).then_some(nearest)
}

/// Largest value and root mean square.
#[derive(Clone, Copy, Debug, Default)]
struct Peak {
    count: u32,
    max: f64,
    sum_of_squares: f64,
}

impl Peak {
    fn add(&mut self, value: Option<f64>) {
        if let Some(value) = value {
            self.count += 1;
            self.max = self.max.max(value.abs());
            self.sum_of_squares += value * value;
        }
    }

    fn max(&self) -> Option<f64> {
        (self.count > 0).then_some(self.max)
    }

    fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum_of_squares / f64::from(self.count)).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::Motion;
    use crate::record::MachinePosition;
    use crate::record::tests::{motion_sample, tracker_sample};
    use crate::world::machine::tests::machine;
    use crate::world::seams::tests::{bent_path, heads, wavy_seam};
    use shared::protocol::{PathAction, PathEvent};
    use shared::trajectory::{PathSpace, SpeedLimits};

    /// A seam tick's machine: axes that hold the pose of the path at s, and slides that sit on the seam.
    fn follow(record: &mut Record, tick: u32, s: f64, off: [f64; SLIDES], tracker_ahead_us: u64) {
        let (machine, seam) = (machine(), wavy_seam());
        let (pose, _) = seam.planned(s).unwrap();
        let axes = machine.inverse(&pose);
        let mut sample = motion_sample(tick);
        sample.path_id = 7;
        sample.s_mm = s;
        sample.truth = Some([axes[0], axes[0], axes[1], axes[2], axes[3], axes[4], axes[5]]);
        sample.following_error[2] = 0.001 * tick as f32;
        sample.skew_mm = 0.01;
        record.add_motion(&[sample]);

        let mut slides = off;
        for side in 0..SIDES {
            let pose = machine.pose(&MachinePosition::Axes(axes));
            let crossing = seam.crossing(side, &heads().spot(&pose, side), 0.0).unwrap();
            slides[2 * side] += crossing.u;
            slides[2 * side + 1] += crossing.v;
        }
        let mut sample = tracker_sample(tick);
        sample.time_us += tracker_ahead_us;
        sample.truth_mm = Some(slides);
        sample.slides_mm = [99.0; SLIDES];
        record.add_tracker(&[sample]);
    }

    fn job(off: [f64; SLIDES], tracker_ahead_us: u64) -> Record {
        let mut record = Record::default();
        for tick in 1..=50 {
            follow(
                &mut record,
                tick,
                150.0 + 0.1 * f64::from(tick),
                off,
                tracker_ahead_us,
            );
        }
        record
    }

    fn evaluated(record: &Record, tracker_ahead_us: i64) -> Evaluation {
        let seams = TrueSeams::of([wavy_seam()]);
        let followed = Followed {
            seams: &seams,
            tracker_ahead_us,
        };
        evaluate(
            record,
            &machine(),
            &BTreeMap::from([(7, planned())]),
            Some(followed),
        )
    }

    /// The bent path, with a beam from 100 mm on.
    fn planned() -> PlannedPath {
        let knots = (0..=100).map(|k| {
            let s_mm = 5.0 * f64::from(k);
            let point = bent_path().at(s_mm).unwrap();
            shared::protocol::Knot {
                s_mm,
                value: point.value,
                slope: point.first,
            }
        });
        PlannedPath {
            motion: Motion::Feed,
            space: PathSpace::Tool,
            dwell_before_s: 0.0,
            corner_deg: None,
            knots: knots.collect(),
            lines: vec![],
            events: vec![PathEvent {
                s_mm: 100.0,
                action: PathAction::Beam { side: 0, on: true },
            }],
            steps: Vec::new(),
            limits: SpeedLimits {
                velocity: 100.0,
                acceleration: 500.0,
                jerk: 10_000.0,
            },
            bound: None,
            speed_error: 0.0,
            start_s: 0.0,
            start_actions: Vec::new(),
            blocks: None,
        }
    }

    #[test]
    fn spots_on_the_seam_have_no_deviation_and_a_tip_on_the_path_no_contour_error() {
        let result = evaluated(&job([0.0; 4], 0), 0);
        assert_eq!((result.weld_ticks, result.unknown_ticks), (50, 0));
        assert!((result.weld_length_mm - 4.9).abs() < 1e-9);
        for max in result.max_deviation_mm {
            assert!(max.unwrap() < 1e-8, "{max:?}");
        }
        assert!(result.max_contour_error_mm.unwrap() < 1e-8);
        assert!((result.max_following_error[2] - 0.05).abs() < 1e-6);
        assert!((result.max_skew_mm - 0.01).abs() < 1e-6);
    }

    #[test]
    fn deviation_is_spot_minus_seam_of_each_slide() {
        let off = [0.03, -0.02, 0.01, 0.04];
        let result = evaluated(&job(off, 0), 0);
        for (i, off) in off.into_iter().enumerate() {
            assert!((result.ticks[20].deviation_mm[i].unwrap() - off).abs() < 1e-8);
            assert!((result.max_deviation_mm[i].unwrap() - off.abs()).abs() < 1e-8);
            assert!((result.rms_deviation_mm[i].unwrap() - off.abs()).abs() < 1e-8);
        }
    }

    #[test]
    fn the_clocks_of_the_boards_may_differ() {
        let result = evaluated(&job([0.0; 4], 5_000_000), 5_000_000);
        assert!(result.max_deviation_mm[0].unwrap() < 1e-8);
        let wrong = evaluated(&job([0.0; 4], 5_000_000), 0);
        assert_eq!((wrong.unknown_ticks, wrong.max_deviation_mm), (50, [None; 4]));
    }

    #[test]
    fn a_side_counts_only_with_its_beam_on() {
        let mut record = Record::default();
        for sample in job([0.03; 4], 0).motion() {
            let mut sample = *sample;
            sample.beams = [true, false];
            record.add_motion(&[sample]);
        }
        record.add_tracker(job([0.03; 4], 0).tracker());
        let result = evaluated(&record, 0);
        assert!(result.max_deviation_mm[0].is_some() && result.max_deviation_mm[1].is_some());
        assert_eq!(result.max_deviation_mm[2..], [None, None]);
        assert!(result.ticks[0].deviation_mm[2].is_some(), "but it is in the log");
    }

    #[test]
    fn without_a_tracker_there_is_still_the_path() {
        let mut record = Record::default();
        for sample in job([0.0; 4], 0).motion() {
            record.add_motion(&[*sample]);
        }
        let paths = BTreeMap::from([(7, planned())]);
        let result = evaluate(&record, &machine(), &paths, None);
        assert_eq!((result.weld_ticks, result.unknown_ticks), (50, 0));
        assert_eq!(result.max_deviation_mm, [None; SLIDES]);
        assert!(result.max_contour_error_mm.unwrap() < 1e-8);
        assert!(
            (result.ticks[0].along_mm - 50.1).abs() < 1e-9,
            "{}",
            result.ticks[0].along_mm
        );
        assert!((result.motion_s - 0.050).abs() < 1e-9);
        let samples = run_samples(&record, &machine(), &paths);
        assert_eq!((samples.len(), samples[9].path_id), (50, 7));
        let (pose, _) = wavy_seam().planned(samples[9].s_mm).unwrap();
        assert!((samples[9].pose.position - pose.position).norm() < 1e-8);
        assert!(run_samples(&record, &machine(), &BTreeMap::new()).is_empty());
    }

    #[test]
    fn without_beams_every_tick_of_a_feed_counts() {
        let mut record = Record::default();
        for sample in job([0.0; 4], 0).motion() {
            let mut sample = *sample;
            sample.beams = [false; SIDES];
            record.add_motion(&[sample]);
        }
        let mut path = planned();
        path.events.clear();
        let result = evaluate(&record, &machine(), &BTreeMap::from([(7, path)]), None);
        assert_eq!(result.weld_ticks, 50);
        assert!(result.max_contour_error_mm.unwrap() < 1e-8);
        assert!((result.ticks[0].along_mm - 150.1).abs() < 1e-9);
    }

    #[test]
    fn contour_error_is_the_distance_from_the_nearest_place_of_the_path() {
        let (path, seam) = (Course::Knots(bent_path()), wavy_seam());
        let (pose, _) = seam.planned(200.0).unwrap();
        let slope = path.at(200.0).unwrap().first;
        let along = Vector3::new(slope[0], slope[1], slope[2]).normalize();
        let across = along.cross(&Vector3::z()).normalize();
        let tip = pose.position + across * 0.03 + along.cross(&across) * 0.04;
        let error = nearest(&path, &tip, 203.0).unwrap().distance_mm;
        assert!((error - 0.05).abs() < 1e-6, "{error}");
        let (end, _) = seam.planned(500.0).unwrap();
        let slope = path.at(500.0).unwrap().first;
        let beyond = end.position + Vector3::new(slope[0], slope[1], slope[2]).normalize() * 0.07;
        let error = nearest(&path, &beyond, 500.0).unwrap().distance_mm;
        assert!((error - 0.07).abs() < 1e-6, "{error}");
    }
}
