//! What the boards told during a job, by tick.

use shared::io::{AXES, MOTORS, SLIDES};
use shared::protocol::{MotionSample, TrackerSample};

/// All samples of a job.
#[derive(Clone, Debug, Default)]
pub struct Record {
    motion: Vec<MotionSample>,
    tracker: Vec<TrackerSample>,
}

/// Where the motors, or for want of a truth the axes, stand at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachinePosition {
    /// Of a simulated machine: true motor positions (mm, rad).
    Motors([f64; MOTORS]),
    /// Of a real one: axis positions by the gratings (mm, rad).
    Axes([f64; AXES]),
}

/// Longest gap between two samples that is bridged by a straight line \[µs\].
const LONGEST_GAP_US: u64 = 10_000;

impl Record {
    /// Takes samples of the motion board; they may come late or twice.
    pub fn add_motion(&mut self, samples: &[MotionSample]) {
        for sample in samples {
            insert(&mut self.motion, *sample, |s| s.tick);
        }
    }

    /// Takes samples of the tracker board; they may come late or twice.
    pub fn add_tracker(&mut self, samples: &[TrackerSample]) {
        for sample in samples {
            insert(&mut self.tracker, *sample, |s| s.tick);
        }
    }

    /// Samples of the motion board, by tick.
    pub fn motion(&self) -> &[MotionSample] {
        &self.motion
    }

    /// Samples of the tracker board, by tick.
    pub fn tracker(&self) -> &[TrackerSample] {
        &self.tracker
    }

    /// Ticks between the first and the last sample that are missing, motion and tracker.
    pub fn missing(&self) -> (u32, u32) {
        (
            missing(&self.motion, |s| s.tick),
            missing(&self.tracker, |s| s.tick),
        )
    }

    /// Where the machine stood at a time of the motion clock, on a straight line between two ticks, and the
    /// path it was on; `None` before and after the record, and in a gap.
    pub fn machine_at(&self, time_us: u64) -> Option<(MachinePosition, &MotionSample)> {
        let (before, after, ratio) = around(&self.motion, time_us, |s| s.time_us)?;
        let position = match (before.truth, after.truth) {
            (Some(a), Some(b)) => MachinePosition::Motors(between(&a, &b, ratio)),
            _ => MachinePosition::Axes(between(&before.axes, &after.axes, ratio)),
        };
        Some((position, before))
    }

    /// Where the slides stood at a time of the tracker clock: the truth, or what the encoders said if there
    /// is none \[mm\]; `None` before and after the record, and in a gap.
    pub fn slides_at(&self, time_us: u64) -> Option<[f64; SLIDES]> {
        let (before, after, ratio) = around(&self.tracker, time_us, |s| s.time_us)?;
        let slides = |s: &TrackerSample| s.truth_mm.unwrap_or(s.slides_mm);
        Some(between(&slides(before), &slides(after), ratio))
    }
}

/// Puts `sample` at its place; the first of two with the same tick stays.
fn insert<S>(samples: &mut Vec<S>, sample: S, tick: impl Fn(&S) -> u32) {
    if samples.last().is_none_or(|last| tick(last) < tick(&sample)) {
        samples.push(sample);
    } else if let Err(place) = samples.binary_search_by_key(&tick(&sample), &tick) {
        samples.insert(place, sample);
    }
}

fn missing<S>(samples: &[S], tick: impl Fn(&S) -> u32) -> u32 {
    match (samples.first(), samples.last()) {
        (Some(first), Some(last)) => tick(last) - tick(first) + 1 - samples.len() as u32,
        _ => 0,
    }
}

/// The samples before and after `time_us`, and how far it is from the first to the second (0…1).
fn around<S>(samples: &[S], time_us: u64, time: impl Fn(&S) -> u64) -> Option<(&S, &S, f64)> {
    let next = samples.partition_point(|s| time(s) <= time_us);
    let before = samples.get(next.checked_sub(1)?)?;
    if time(before) == time_us {
        return Some((before, before, 0.0));
    }
    let after = samples.get(next)?;
    let gap = time(after) - time(before);
    let ratio = (time_us - time(before)) as f64 / gap as f64;
    (gap <= LONGEST_GAP_US).then_some((before, after, ratio))
}

fn between<const N: usize>(a: &[f64; N], b: &[f64; N], ratio: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::state::{State, TrackerState};

    /// A tick of a motion board at rest in the origin.
    fn motion_sample(tick: u32) -> MotionSample {
        MotionSample {
            tick,
            time_us: u64::from(tick) * 1000,
            state: State::Running,
            path_id: 1,
            s_mm: 0.0,
            speed_mm_s: 0.0,
            beams: [true; 2],
            axes: [0.0; AXES],
            truth: Some([0.0; MOTORS]),
            following_error: [0.0; MOTORS],
            skew_mm: 0.0,
            load: None,
        }
    }

    /// A tick of a tracker board at rest.
    fn tracker_sample(tick: u32) -> TrackerSample {
        TrackerSample {
            tick,
            time_us: u64::from(tick) * 1000,
            state: TrackerState::Tracking,
            fault: None,
            slides_mm: [0.0; SLIDES],
            truth_mm: Some([0.0; SLIDES]),
            target_mm: [0.0; SLIDES],
            dac: [0; SLIDES],
        }
    }

    #[test]
    fn late_and_double_samples_find_their_place_and_gaps_are_counted() {
        let mut record = Record::default();
        for tick in [10, 11, 15, 13, 11, 12, 20] {
            record.add_motion(&[motion_sample(tick)]);
        }
        let ticks: Vec<u32> = record.motion().iter().map(|s| s.tick).collect();
        assert_eq!(ticks, [10, 11, 12, 13, 15, 20]);
        assert_eq!(record.missing(), (5, 0));
    }

    #[test]
    fn positions_between_ticks_lie_on_a_line_and_gaps_have_none() {
        let mut record = Record::default();
        for tick in [1, 2, 30] {
            let mut sample = motion_sample(tick);
            sample.truth = Some([f64::from(tick); MOTORS]);
            record.add_motion(&[sample]);
            let mut sample = tracker_sample(tick);
            sample.truth_mm = None;
            sample.slides_mm = [f64::from(tick) * 2.0; SLIDES];
            record.add_tracker(&[sample]);
        }
        assert_eq!(
            record.machine_at(1250).unwrap().0,
            MachinePosition::Motors([1.25; MOTORS])
        );
        assert_eq!(record.slides_at(1250), Some([2.5; SLIDES]));
        assert_eq!(record.slides_at(30_000), Some([60.0; SLIDES]));
        for outside in [999, 2001, 30_001] {
            assert!(record.machine_at(outside).is_none(), "{outside}");
        }
    }
}
