//! How well it went, tick by tick: the true tool against the programmed path, and the true spots against the
//! true seams.

use crate::nc::Motion;
use crate::part::RunSample;
use crate::path::{Course, PlannedPath};
use crate::record::Record;
use crate::report::Load;
use crate::seam::OVERHANG_MM;
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

/// A tick of the motion board on a path that works: one of G1, or with a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkTick {
    /// Path tick.
    pub tick: u32,
    /// Distance from where the first beam goes on (without beams, from where the first such path begins), over
    /// all such paths \[mm\].
    pub along_mm: f64,
    /// Path speed \[mm/s\].
    pub speed_mm_s: f64,
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
    let working = working(paths);
    let any_beam = on_paths(record).any(|s| working.contains_key(&s.path_id) && s.beams.contains(&true));
    let mut result = Evaluation::default();
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
        let tick = work_tick(sample, record, machine, work, followed);
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
    /// `along_mm` at its beginning.
    along_mm: f64,
}

/// Whether a path is one that works: a feed, or with a beam.
pub fn works(path: &PlannedPath) -> bool {
    path.weld().is_some() || path.motion == Motion::Feed
}

fn working(paths: &BTreeMap<u32, PlannedPath>) -> BTreeMap<u32, Work> {
    let chosen = || paths.iter().filter(|(_, path)| works(path));
    // Up to the first beam it counts backwards.
    let mut before = 0.0;
    for (_, path) in chosen() {
        if let Some((start, _)) = path.weld() {
            before += start;
            break;
        }
        before += path.length_mm();
    }
    let any_beam = chosen().any(|(_, path)| path.weld().is_some());
    let mut along_mm = if any_beam { -before } else { 0.0 };
    chosen()
        .map(|(id, path)| {
            let work = Work {
                path: path.path(),
                along_mm,
            };
            along_mm += path.length_mm();
            (*id, work)
        })
        .collect()
}

fn work_tick(
    sample: &MotionSample,
    record: &Record,
    machine: &Machine,
    work: &Work,
    followed: Option<Followed>,
) -> WorkTick {
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
    WorkTick {
        tick: sample.tick,
        along_mm: work.along_mm + sample.s_mm,
        speed_mm_s: sample.speed_mm_s,
        beams: sample.beams,
        slides_mm,
        deviation_mm,
        contour_error_mm: pose.and_then(|pose| contour_error(&work.path, &pose.position, sample.s_mm)),
        following_error: sample.following_error,
    }
}

/// Distance of `tip` from `path`, searched from path position `s` on \[mm\]. Beyond its ends a path has no points.
fn contour_error(path: &Course, tip: &Vector3<f64>, s: f64) -> Option<f64> {
    let (start, end) = (path.start_s()?, path.end_s()?);
    let mut s = s.clamp(start, end);
    // Outside of a corner the search goes to and fro between its sides.
    let (mut damped, mut last, mut nearest) = (1.0, 0.0, f64::INFINITY);
    for _ in 0..STEPS {
        let point = path.at(s)?;
        let place = |channels: &[f64]| Vector3::from_column_slice(&channels[..3]);
        let (apart, slope) = (tip - place(&point.value), place(&point.first));
        nearest = nearest.min(apart.norm());
        let mut step = damped * apart.dot(&slope) / slope.norm_squared();
        if step * last < 0.0 {
            damped *= 0.5;
            step *= 0.5;
        }
        last = step;
        let next = (s + step).clamp(start, end);
        if next.is_nan() || (next - s).abs() < NEAREST {
            return Some(apart.norm());
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
        let error = contour_error(&path, &tip, 203.0).unwrap();
        assert!((error - 0.05).abs() < 1e-6, "{error}");
        let (end, _) = seam.planned(500.0).unwrap();
        let slope = path.at(500.0).unwrap().first;
        let beyond = end.position + Vector3::new(slope[0], slope[1], slope[2]).normalize() * 0.07;
        let error = contour_error(&path, &beyond, 500.0).unwrap();
        assert!((error - 0.07).abs() < 1e-6, "{error}");
    }
}
