//! How far the spots are beside their seams, along the work, in bounded memory.
//!
//! On a real machine nobody knows the true seam: this is what the tracker board goes by, the place of the seam in its map minus
//! that of the slide by its encoder, at the same tick.

use serde::{Deserialize, Serialize};
use shared::io::{SIDES, SLIDES};
use shared::protocol::TrackerSample;
use shared::state::TrackerState;

/// Length of a bin at first \[mm\].
const FINEST_MM: f64 = 0.2;
/// Bins that are kept; beyond, two become one.
const BINS: usize = 2048;

/// Extremes of each slide's deviation within a bin \[mm\]: U1 V1 U2 V2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Least.
    pub least: [f64; SLIDES],
    /// Largest.
    pub largest: [f64; SLIDES],
}

impl Bin {
    /// Nothing seen.
    const EMPTY: Self = Self {
        least: [f64::INFINITY; SLIDES],
        largest: [f64::NEG_INFINITY; SLIDES],
    };

    fn add(&mut self, other: &Self) {
        for slide in 0..SLIDES {
            self.least[slide] = self.least[slide].min(other.least[slide]);
            self.largest[slide] = self.largest[slide].max(other.largest[slide]);
        }
    }

    /// Largest |deviation| of any slide \[mm\]; `None` where no beam was on.
    pub fn worst_mm(&self) -> Option<f64> {
        let ends = self.least.iter().chain(&self.largest);
        ends.filter(|value| value.is_finite())
            .map(|value| value.abs())
            .reduce(f64::max)
    }
}

impl SentBin {
    #[allow(clippy::cast_possible_truncation, reason = "it is drawn")]
    fn of(bin: &Bin) -> Self {
        Self {
            least: bin.least.map(|value| value as f32),
            largest: bin.largest.map(|value| value as f32),
        }
    }

    fn bin(&self) -> Bin {
        Bin {
            least: self.least.map(f64::from),
            largest: self.largest.map(f64::from),
        }
    }
}

/// Deviations with the beam of their side on, by the length along the work.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviations {
    step_mm: f64,
    bins: Vec<Bin>,
    newest: [Option<f64>; SLIDES],
    worst: [Option<f64>; SLIDES],
}

/// Deviations that have changed, for who has the others already.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Changed {
    step_mm: f64,
    /// Bins that differ, by their number. All that there are, where the step is another.
    bins: Vec<(u32, SentBin)>,
    newest: [Option<f64>; SLIDES],
    worst: [Option<f64>; SLIDES],
}

/// A bin, to 24 bits of each value: of 1 mm, that is 0.06 nm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SentBin {
    least: [f32; SLIDES],
    largest: [f32; SLIDES],
}

impl Default for Deviations {
    fn default() -> Self {
        Self {
            step_mm: FINEST_MM,
            bins: Vec::new(),
            newest: [None; SLIDES],
            worst: [None; SLIDES],
        }
    }
}

impl Deviations {
    /// Takes a tick of the tracker board at `along_mm` with these `beams` on. Before the first beam there is nothing to judge.
    pub(super) fn tick(&mut self, along_mm: f64, beams: [bool; SIDES], sample: &TrackerSample) {
        if sample.state == TrackerState::Tracking {
            let deviation = |slide: usize| sample.slides_mm[slide] - sample.target_mm[slide];
            self.add(
                along_mm,
                std::array::from_fn(|slide| beams[slide / 2].then(|| deviation(slide))),
            );
        }
    }

    /// Takes deviations of U1 V1 U2 V2 at `along_mm` \[mm\], of the slides whose beam is on.
    pub fn add(&mut self, along_mm: f64, deviations: [Option<f64>; SLIDES]) {
        if along_mm < 0.0 || deviations.iter().all(Option::is_none) {
            return;
        }
        let mut seen = Bin::EMPTY;
        for (slide, deviation) in deviations.into_iter().enumerate() {
            if let Some(deviation) = deviation {
                (seen.least[slide], seen.largest[slide]) = (deviation, deviation);
                self.newest[slide] = Some(deviation);
                let worst = self.worst[slide].unwrap_or(0.0);
                self.worst[slide] = Some(worst.max(deviation.abs()));
            }
        }
        let mut index = (along_mm / self.step_mm) as usize;
        while index >= BINS {
            self.coarsen();
            index = (along_mm / self.step_mm) as usize;
        }
        if index >= self.bins.len() {
            self.bins.resize(index + 1, Bin::EMPTY);
        }
        self.bins[index].add(&seen);
    }

    fn coarsen(&mut self) {
        self.step_mm *= 2.0;
        let pairs = self.bins.chunks(2).map(|pair| {
            let mut sum = pair[0];
            pair.iter().for_each(|bin| sum.add(bin));
            sum
        });
        self.bins = pairs.collect();
    }

    /// What has changed since `before`, if anything has.
    pub fn since(&self, before: &Self) -> Option<Changed> {
        let is_same_step = self.step_mm.total_cmp(&before.step_mm).is_eq();
        let known = if is_same_step { &before.bins[..] } else { &[] };
        let numbered = (0..).zip(&self.bins);
        let differs = |(index, bin): &(u32, &Bin)| known.get(*index as usize) != Some(bin);
        let changed = Changed {
            step_mm: self.step_mm,
            bins: numbered
                .filter(differs)
                .map(|(index, bin)| (index, SentBin::of(bin)))
                .collect(),
            newest: self.newest,
            worst: self.worst,
        };
        (self != before).then_some(changed)
    }

    /// Takes what has changed; bins beyond those that are kept are none.
    pub fn follow(&mut self, changed: &Changed) {
        if self.step_mm.total_cmp(&changed.step_mm).is_ne() {
            (self.step_mm, self.bins) = (changed.step_mm, Vec::new());
        }
        for (index, bin) in &changed.bins {
            let index = *index as usize;
            if index < BINS {
                if index >= self.bins.len() {
                    self.bins.resize(index + 1, Bin::EMPTY);
                }
                self.bins[index] = bin.bin();
            }
        }
        (self.newest, self.worst) = (changed.newest, changed.worst);
    }

    /// All bins with the middle of each \[mm\].
    pub fn bins(&self) -> impl Iterator<Item = (f64, &Bin)> {
        let middle = |index: usize| (index as f64 + 0.5) * self.step_mm;
        self.bins
            .iter()
            .enumerate()
            .map(move |(index, bin)| (middle(index), bin))
    }

    /// Largest |deviation| from `begin_mm` to `end_mm` \[mm\]; `None` where no beam was on.
    pub fn worst_between(&self, begin_mm: f64, end_mm: f64) -> Option<f64> {
        let index = |along_mm: f64| (along_mm.max(0.0) / self.step_mm) as usize;
        let end = (index(end_mm) + 1).min(self.bins.len());
        let bins = self.bins.get(index(begin_mm)..end)?;
        bins.iter().filter_map(Bin::worst_mm).reduce(f64::max)
    }

    /// The latest of each slide \[mm\].
    pub fn newest(&self) -> [Option<f64>; SLIDES] {
        self.newest
    }

    /// Largest |deviation| of each slide so far \[mm\].
    pub fn worst(&self) -> [Option<f64>; SLIDES] {
        self.worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(u1: f64) -> TrackerSample {
        TrackerSample {
            tick: 0,
            time_us: 0,
            state: TrackerState::Tracking,
            fault: None,
            slides_mm: [10.0 + u1, 2.0, -3.0, 4.0],
            truth_mm: None,
            target_mm: [10.0, 2.0, -3.0, 4.0],
            dac: [0; SLIDES],
        }
    }

    #[test]
    fn a_long_weld_keeps_its_peaks_in_bounded_memory() {
        let mut seen = Deviations::default();
        for mm in 0..100_000 {
            let peak = if mm == 43_210 { -0.04 } else { 0.001 };
            seen.tick(f64::from(mm) + 0.05, [true, false], &sample(peak));
        }
        assert!(seen.bins.len() <= BINS);
        assert!((seen.worst_between(43_210.0, 43_210.0).unwrap() - 0.04).abs() < 1e-9);
        assert!((seen.worst_between(50_000.0, 50_000.0).unwrap() - 0.001).abs() < 1e-9);
        assert!((seen.worst()[0].unwrap() - 0.04).abs() < 1e-9);
        let (at, _) = seen.bins().find(|(_, bin)| bin.least[0] < -0.03).unwrap();
        assert!((at - 43_210.0).abs() <= seen.step_mm);
    }

    #[test]
    fn only_the_side_whose_beam_is_on_is_judged_and_only_while_it_tracks() {
        let mut seen = Deviations::default();
        seen.tick(1.0, [false, true], &sample(0.5));
        assert_eq!(seen.worst()[0], None);
        assert_eq!(seen.worst()[2], Some(0.0));
        let idle = TrackerSample {
            state: TrackerState::Ready,
            ..sample(0.5)
        };
        seen.tick(2.0, [true, true], &idle);
        seen.tick(-1.0, [true, true], &sample(0.5));
        assert_eq!(seen.worst()[0], None);
        assert_eq!(seen.worst_between(2.0, 2.0), None);
    }
}
