//! What the boards told during a job, by tick.
//!
//! While the job runs a [`Record`] has the newest samples in memory, and a thread puts those before them into a
//! [spool](crate::spool). After its end [`Recorded`] has all of them.

mod recorded;
mod series;
#[cfg(test)]
mod tests;

pub use recorded::{RecordError, Recorded, SlidePositions};

use crate::spool::Spooling;
use series::{Sample, Series};
use shared::io::{AXES, MOTORS};
use shared::protocol::{MotionSample, TrackerSample};
use std::collections::VecDeque;

/// The samples of a job that runs.
#[derive(Debug)]
pub struct Record {
    motion: Series<MotionSample>,
    tracker: Series<TrackerSample>,
    spooling: Spooling,
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
    /// An empty one.
    pub fn new(spooling: Spooling) -> Self {
        Self {
            motion: Series::new(spooling.clone()),
            tracker: Series::new(spooling.clone()),
            spooling,
        }
    }

    /// Takes samples of the motion board; they may come late or twice.
    pub fn add_motion(&mut self, samples: &[MotionSample]) {
        samples.iter().for_each(|sample| self.motion.add(*sample));
    }

    /// Takes samples of the tracker board; they may come late or twice.
    pub fn add_tracker(&mut self, samples: &[TrackerSample]) {
        samples.iter().for_each(|sample| self.tracker.add(*sample));
    }

    /// Samples of the motion board by tick, those of the last 20 s at least.
    pub fn motion(&self) -> &VecDeque<MotionSample> {
        self.motion.newest()
    }

    /// Samples of the tracker board by tick, those of the last 20 s at least.
    pub fn tracker(&self) -> &VecDeque<TrackerSample> {
        self.tracker.newest()
    }

    /// Where the machine stood at a time of the motion clock, on a straight line between two ticks, and the
    /// path it was on; `None` before and after the [newest](Self::motion) samples, and in a gap.
    pub fn machine_at(&self, time_us: u64) -> Option<(MachinePosition, &MotionSample)> {
        let (before, after, ratio) = around(self.motion(), time_us)?;
        Some((MachinePosition::between(before, after, ratio), before))
    }

    /// Where the axes were at a time of the motion clock by what the board measured, also of a simulated machine (mm, rad); `None`
    /// as in [`Record::machine_at`].
    pub fn axes_at(&self, time_us: u64) -> Option<[f64; AXES]> {
        let (before, after, ratio) = around(self.motion(), time_us)?;
        Some(between(&before.axes, &after.axes, ratio))
    }

    /// All samples, once the job has ended.
    pub fn finish(self) -> Recorded {
        Recorded::new(self.motion.finish(), self.tracker.finish(), self.spooling)
    }
}

impl Default for Record {
    fn default() -> Self {
        Self::new(Spooling::default())
    }
}

impl MachinePosition {
    /// At the tick of a sample.
    pub fn of(sample: &MotionSample) -> Self {
        Self::between(sample, sample, 0.0)
    }

    fn between(before: &MotionSample, after: &MotionSample, ratio: f64) -> Self {
        match (before.truth, after.truth) {
            (Some(a), Some(b)) => Self::Motors(between(&a, &b, ratio)),
            _ => Self::Axes(between(&before.axes, &after.axes, ratio)),
        }
    }
}

/// The samples before and after `time_us`, and how far it is from the first to the second (0…1).
fn around<S: Sample>(samples: &VecDeque<S>, time_us: u64) -> Option<(&S, &S, f64)> {
    let next = samples.partition_point(|s| s.time_us() <= time_us);
    let before = samples.get(next.checked_sub(1)?)?;
    let (after, ratio) = towards(before, samples.get(next), time_us)?;
    Some((before, after, ratio))
}

/// The one of `before` and `after` that a straight line to `time_us` leads to, and how far along (0…1); `None` in a gap.
fn towards<'a, S: Sample>(before: &'a S, after: Option<&'a S>, time_us: u64) -> Option<(&'a S, f64)> {
    if before.time_us() == time_us {
        return Some((before, 0.0));
    }
    let after = after?;
    let gap = after.time_us() - before.time_us();
    let ratio = time_us.checked_sub(before.time_us())? as f64 / gap as f64;
    (gap <= LONGEST_GAP_US).then_some((after, ratio))
}

fn between<const N: usize>(a: &[f64; N], b: &[f64; N], ratio: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * ratio)
}
