//! How well it went: the truth of the spots against the truth of the seams, tick by tick.

use crate::record::Record;
use crate::seam::OVERHANG_MM;
use crate::world::{Machine, TrueSeam};
use shared::io::{MOTORS, SIDES, SLIDES};
use shared::motion::State;
use shared::protocol::MotionSample;
use std::collections::BTreeMap;

/// A tick of the motion board on a path with a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamTick {
    /// Path tick.
    pub tick: u32,
    /// Distance from where the first beam goes on \[mm\].
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
    /// Every tick on a path with a seam.
    pub ticks: Vec<SeamTick>,
    /// Ticks with a beam on.
    pub weld_ticks: u32,
    /// Length of path between them \[mm\].
    pub weld_length_mm: f64,
    /// Of these, ticks whose deviation is not known, since telemetry is missing or the seam ended.
    pub unknown_ticks: u32,
    /// Largest |deviation| with the beam of that side on \[mm\].
    pub max_deviation_mm: [Option<f64>; SLIDES],
    /// Root mean square of the same \[mm\].
    pub rms_deviation_mm: [Option<f64>; SLIDES],
    /// Largest distance of the tip from the programmed path with a beam on \[mm\].
    pub max_contour_error_mm: Option<f64>,
    /// Largest |following error| of each motor on any path (mm, rad).
    pub max_following_error: [f64; MOTORS],
    /// Largest skew of the gantry on any path \[mm\].
    pub max_skew_mm: f64,
}

/// Evaluates a record. `seams` are the paths with a seam, by number; `tracker_ahead_us` is how far the
/// tracker's clock is ahead of the motion board's.
pub fn evaluate(
    record: &Record,
    machine: &Machine,
    seams: &BTreeMap<u32, TrueSeam>,
    tracker_ahead_us: i64,
) -> Evaluation {
    let mut result = Evaluation::default();
    let mut deviation = [Peak::default(); SLIDES];
    let mut contour = Peak::default();
    let mut welded_to: Option<&MotionSample> = None;
    let on_path = |s: &&MotionSample| matches!(s.state, State::Running | State::Holding | State::Stopping);
    for sample in record.motion().iter().filter(on_path) {
        for (max, seen) in result.max_following_error.iter_mut().zip(sample.following_error) {
            *max = max.max(f64::from(seen));
        }
        result.max_skew_mm = result.max_skew_mm.max(f64::from(sample.skew_mm));
        let Some(seam) = seams.get(&sample.path_id) else {
            continue;
        };
        let tick = seam_tick(sample, record, machine, seam, tracker_ahead_us);
        if !sample.beams.contains(&true) {
            welded_to = None;
        } else {
            let from = welded_to.filter(|before| before.path_id == sample.path_id);
            result.weld_length_mm += from.map_or(0.0, |before| sample.s_mm - before.s_mm);
            welded_to = Some(sample);
            result.weld_ticks += 1;
            let unknown = (0..SLIDES).any(|i| sample.beams[i / 2] && tick.deviation_mm[i].is_none());
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
    result
}

fn seam_tick(
    sample: &MotionSample,
    record: &Record,
    machine: &Machine,
    seam: &TrueSeam,
    tracker_ahead_us: i64,
) -> SeamTick {
    let (deviation_mm, contour_error_mm, slides_mm) = match record.machine_at(sample.time_us) {
        None => ([None; SLIDES], None, None),
        Some((position, _)) => {
            let pose = machine.pose(&position);
            let slides = sample
                .time_us
                .checked_add_signed(tracker_ahead_us)
                .and_then(|time| record.slides_at(time));
            let mut deviation = [None; SLIDES];
            for side in 0..SIDES {
                let frame = machine.spot(&pose, side);
                let crossing = seam.crossing(machine, side, &frame, 0.0, sample.s_mm);
                if let (Some(slides), Some(crossing)) = (slides, crossing)
                    && seam.exists_at(crossing.s, OVERHANG_MM)
                {
                    deviation[2 * side] = Some(slides[2 * side] - crossing.u);
                    deviation[2 * side + 1] = Some(slides[2 * side + 1] - crossing.v);
                }
            }
            let contour = seam.contour_error(&pose.position, sample.s_mm);
            (deviation, contour, slides)
        }
    };
    SeamTick {
        tick: sample.tick,
        along_mm: sample.s_mm - seam.start_s(),
        speed_mm_s: sample.speed_mm_s,
        beams: sample.beams,
        slides_mm,
        deviation_mm,
        contour_error_mm,
        following_error: sample.following_error,
    }
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
    use crate::world::truth::tests::{machine, wavy_seam};

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
            let crossing = seam
                .crossing(&machine, side, &machine.spot(&pose, side), 0.0, s)
                .unwrap();
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
        let seams = BTreeMap::from([(7, wavy_seam())]);
        evaluate(record, &machine(), &seams, tracker_ahead_us)
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
}
