//! Signals of the boards' telemetry over time, the newest of them in bounded memory.

use shared::io::{AXES, MOTORS, SLIDES};
use shared::protocol::{MotionSample, TrackerSample};
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::collections::VecDeque;

/// What is kept of each board, unless less is asked for \[s\].
const KEPT_S: f64 = 30.0;
/// Ticks of a board in a second.
const TICKS_PER_S: f64 = 1000.0;

/// Part of a new relation of the clocks that counts, once a tick.
const SMOOTHING: f64 = 1e-3;

/// Unit of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// mm
    Mm,
    /// degrees
    Degrees,
    /// µm
    Um,
    /// millidegrees
    MilliDegrees,
    /// m/min
    MPerMin,
    /// % of full scale
    Percent,
    /// 0 or 1
    OnOff,
}

impl Unit {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Degrees => "°",
            Self::Um => "µm",
            Self::MilliDegrees => "m°",
            Self::MPerMin => "m/min",
            Self::Percent => "%",
            Self::OnOff => "",
        }
    }
}

/// Something that the telemetry tells every tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// Speed along the path.
    Speed,
    /// Position of an axis.
    Axis(usize),
    /// Largest |following error| of a motor since the tick before.
    FollowingError(usize),
    /// Skew of the gantry.
    Skew,
    /// A beam.
    Beam(usize),
    /// Power of a beam.
    Power(usize),
    /// Position of a slide.
    Slide(usize),
    /// A slide's distance from its target.
    SlideError(usize),
}

/// All signals, in the order in which they are offered.
pub const SIGNALS: [Signal; 2 + AXES + MOTORS + 4 + 2 * SLIDES] = {
    let mut all = [Signal::Speed; 2 + AXES + MOTORS + 4 + 2 * SLIDES];
    all[1] = Signal::Skew;
    let mut count = 2;
    let mut i = 0;
    while i < 2 {
        all[count] = Signal::Beam(i);
        all[count + 1] = Signal::Power(i);
        count += 2;
        i += 1;
    }
    i = 0;
    while i < SLIDES {
        all[count] = Signal::SlideError(i);
        all[count + SLIDES] = Signal::Slide(i);
        count += 1;
        i += 1;
    }
    count += SLIDES;
    i = 0;
    while i < MOTORS {
        all[count] = Signal::FollowingError(i);
        count += 1;
        i += 1;
    }
    i = 0;
    while i < AXES {
        all[count] = Signal::Axis(i);
        count += 1;
        i += 1;
    }
    all
};

impl Signal {
    /// Its unit.
    pub fn unit(self) -> Unit {
        match self {
            Self::Speed => Unit::MPerMin,
            Self::Axis(0..=2) | Self::Slide(_) => Unit::Mm,
            Self::Axis(_) => Unit::Degrees,
            Self::FollowingError(0..=3) | Self::Skew | Self::SlideError(_) => Unit::Um,
            Self::FollowingError(_) => Unit::MilliDegrees,
            Self::Beam(_) => Unit::OnOff,
            Self::Power(_) => Unit::Percent,
        }
    }

    fn of_motion(self, sample: &MotionSample) -> Option<f64> {
        Some(match self {
            Self::Speed => sample.speed_mm_s / MM_S_PER_M_MIN,
            Self::Axis(axis @ 0..=2) => sample.axes[axis],
            Self::Axis(axis) => sample.axes[axis] * DEG_PER_RAD,
            Self::FollowingError(motor @ 0..=3) => f64::from(sample.following_error[motor]) * 1e3,
            Self::FollowingError(motor) => f64::from(sample.following_error[motor]) * DEG_PER_RAD * 1e3,
            Self::Skew => f64::from(sample.skew_mm) * 1e3,
            Self::Beam(side) => f64::from(u8::from(sample.beams[side])),
            Self::Power(side) => f64::from(sample.levels[side]) * 100.0,
            Self::Slide(_) | Self::SlideError(_) => return None,
        })
    }

    fn of_tracker(self, sample: &TrackerSample) -> Option<f64> {
        match self {
            Self::Slide(slide) => Some(sample.slides_mm[slide]),
            Self::SlideError(slide) => Some((sample.slides_mm[slide] - sample.target_mm[slide]) * 1e3),
            _ => None,
        }
    }
}

/// The newest ticks of both boards.
#[derive(Clone, Debug)]
pub struct Signals {
    /// Ticks that are kept of each board.
    kept: usize,
    motion: VecDeque<MotionSample>,
    tracker: VecDeque<TrackerSample>,
    /// How far the tracker board's clock is ahead of the motion board's \[µs\].
    tracker_ahead_us: Option<f64>,
}

impl Default for Signals {
    fn default() -> Self {
        Self::keeping(KEPT_S)
    }
}

impl Signals {
    /// Keeps the newest `seconds` of each board.
    pub fn keeping(seconds: f64) -> Self {
        Self {
            kept: (seconds * TICKS_PER_S) as usize,
            motion: VecDeque::new(),
            tracker: VecDeque::new(),
            tracker_ahead_us: None,
        }
    }

    /// Takes a tick of the motion board.
    pub fn motion(&mut self, sample: &MotionSample) {
        keep(&mut self.motion, self.kept, *sample);
    }

    /// Takes a tick of the tracker board.
    pub fn tracker(&mut self, sample: &TrackerSample) {
        keep(&mut self.tracker, self.kept, *sample);
        if let Some(motion) = self.motion.back() {
            let ahead = sample.time_us as f64 - motion.time_us as f64;
            let known = *self.tracker_ahead_us.get_or_insert(ahead);
            self.tracker_ahead_us = Some(known + SMOOTHING * (ahead - known));
        }
    }

    /// How far the tracker board's clock is ahead of the motion board's \[µs\], as far as that is known.
    pub fn tracker_ahead_us(&self) -> Option<f64> {
        self.tracker_ahead_us
    }

    /// See [`Self::tracker_ahead_us`].
    pub fn set_tracker_ahead_us(&mut self, ahead_us: Option<f64>) {
        self.tracker_ahead_us = ahead_us;
    }

    /// The tracker board's time by the motion board's clock \[s\], to some milliseconds: by which of their ticks arrive together.
    /// Reports have the exact relation.
    fn motion_s(&self, tracker_us: u64) -> f64 {
        (tracker_us as f64 - self.tracker_ahead_us.unwrap_or(0.0)) * 1e-6
    }

    /// The tick of the motion board at which the tracker board's clock was `tracker_us`, or the one before.
    pub(super) fn motion_at(&self, tracker_us: u64) -> Option<&MotionSample> {
        let time_us = tracker_us as f64 - self.tracker_ahead_us?;
        let after = self
            .motion
            .partition_point(|sample| sample.time_us as f64 <= time_us);
        self.motion.get(after.checked_sub(1)?)
    }

    /// Times \[s\], by the motion board's clock, and values of the newest `window_s` of `signal`, oldest first: extremes
    /// of pieces, where there would be more than `most` of them.
    pub fn course(&self, signal: Signal, window_s: f64, most: usize) -> Vec<[f64; 2]> {
        match signal {
            Signal::Slide(_) | Signal::SlideError(_) => {
                let told = newest(&self.tracker, window_s, |sample| sample.time_us);
                let point = |s: &TrackerSample| Some([self.motion_s(s.time_us), signal.of_tracker(s)?]);
                extremes(told, most, point)
            }
            _ => {
                let told = newest(&self.motion, window_s, |sample| sample.time_us);
                let point = |s: &MotionSample| Some([s.time_us as f64 * 1e-6, signal.of_motion(s)?]);
                extremes(told, most, point)
            }
        }
    }

    /// The newest `window_s` of both boards, oldest first.
    pub fn newest(&self, window_s: f64) -> (Vec<MotionSample>, Vec<TrackerSample>) {
        (
            newest(&self.motion, window_s, |sample| sample.time_us)
                .copied()
                .collect(),
            newest(&self.tracker, window_s, |sample| sample.time_us)
                .copied()
                .collect(),
        )
    }

    /// Time of the newest tick of the motion board, by its clock \[s\].
    pub fn newest_s(&self) -> f64 {
        self.motion
            .back()
            .map_or(0.0, |newest| newest.time_us as f64 * 1e-6)
    }

    /// Whether nothing was told yet.
    pub fn is_empty(&self) -> bool {
        self.motion.is_empty()
    }
}

fn keep<T>(samples: &mut VecDeque<T>, most: usize, sample: T) {
    if samples.len() >= most {
        samples.pop_front();
    }
    samples.push_back(sample);
}

/// Samples of the newest `window_s`.
fn newest<T>(
    samples: &VecDeque<T>,
    window_s: f64,
    time_us: impl Fn(&T) -> u64,
) -> impl ExactSizeIterator<Item = &T> {
    let end = samples.back().map_or(0, &time_us);
    let begin = end.saturating_sub((window_s * 1e6) as u64);
    let first = samples.partition_point(|sample| time_us(sample) < begin);
    samples.range(first..)
}

/// The points of `samples` in their order; beyond `most` of them, of equal pieces the least and the largest.
fn extremes<'a, T: 'a>(
    samples: impl ExactSizeIterator<Item = &'a T>,
    most: usize,
    point: impl Fn(&T) -> Option<[f64; 2]>,
) -> Vec<[f64; 2]> {
    let count = samples.len();
    if count <= most {
        return samples.filter_map(point).collect();
    }
    let piece = count.div_ceil(most.div_ceil(2));
    let mut ends = Vec::with_capacity(2 * count.div_ceil(piece));
    let mut points = samples.filter_map(point);
    while let Some(first) = points.next() {
        let (mut least, mut largest) = (first, first);
        for point in points.by_ref().take(piece - 1) {
            if point[1] < least[1] {
                least = point;
            }
            if point[1] >= largest[1] {
                largest = point;
            }
        }
        ends.extend(if least[0] <= largest[0] {
            [least, largest]
        } else {
            [largest, least]
        });
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_signal_is_offered_once() {
        for (index, signal) in SIGNALS.iter().enumerate() {
            assert!(!SIGNALS[..index].contains(signal), "{signal:?}");
        }
        assert!(SIGNALS.contains(&Signal::FollowingError(MOTORS - 1)));
        assert!(SIGNALS.contains(&Signal::SlideError(SLIDES - 1)));
        assert!(SIGNALS.contains(&Signal::Axis(AXES - 1)));
    }

    #[test]
    fn a_course_of_few_points_keeps_its_peaks_where_they_were() {
        let mut all: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k), 0.0]).collect();
        (all[4321][1], all[777][1]) = (9.0, -5.0);
        let few = extremes(all.iter(), 100, |point| Some(*point));
        assert!(few.len() <= 102, "{}", few.len());
        assert!(few.contains(&[4321.0, 9.0]) && few.contains(&[777.0, -5.0]));
        assert!(few.is_sorted_by(|a, b| a[0] <= b[0]));
    }
}
