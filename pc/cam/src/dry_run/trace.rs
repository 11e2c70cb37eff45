//! Curves over time in constant memory: lowest and highest value of ever longer intervals.

use super::ROWS;
use shared::ticks::PATH_PERIOD_S;

/// Intervals of a curve: twice what a plot can show.
const BINS: usize = 4096;

/// Lowest and highest value of an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Lowest.
    pub low: f64,
    /// Highest.
    pub high: f64,
}

impl Bin {
    fn join(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// A curve of one value each millisecond.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Envelope {
    bins: Vec<Bin>,
    /// Ticks in a bin is two to this.
    doublings: u32,
    /// Ticks in the last bin.
    ticks: u64,
}

impl Envelope {
    /// The value of the next tick.
    pub fn push(&mut self, value: f64) {
        self.push_times(value, 1);
    }

    /// The same value for so many ticks, as a machine has that stands: the work does not grow with them.
    pub fn push_times(&mut self, value: f64, ticks: u64) {
        let value = Bin {
            low: value,
            high: value,
        };
        let mut left = ticks;
        while left > 0 {
            let full = 1 << self.doublings;
            match self.bins.last_mut() {
                Some(last) if self.ticks < full => {
                    let taken = left.min(full - self.ticks);
                    *last = last.join(value);
                    self.ticks += taken;
                    left -= taken;
                }
                _ => {
                    if self.bins.len() == BINS {
                        self.bins = self.bins.chunks(2).map(|two| two[0].join(two[1])).collect();
                        self.doublings += 1;
                    }
                    self.bins.push(value);
                    self.ticks = 1;
                    left -= 1;
                }
            }
        }
    }

    /// Length of an interval \[s\].
    pub fn step_s(&self) -> f64 {
        (1_u64 << self.doublings) as f64 * PATH_PERIOD_S
    }

    /// Middle of every interval \[s\], with its values.
    pub fn bins(&self) -> impl Iterator<Item = (f64, Bin)> {
        let step = self.step_s();
        let times = (0..).map(move |i| (f64::from(i) + 0.5) * step);
        times.zip(self.bins.iter().copied())
    }
}

/// Everything over time: speed, acceleration and jerk (mm or degrees).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Of the path and of each axis.
    pub rows: [[Envelope; 3]; ROWS],
    /// What the path may have there; 0 between paths.
    pub path_limits: [Envelope; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_that_stands_leaves_what_its_ticks_would() {
        let (mut at_once, mut each) = (Envelope::default(), Envelope::default());
        let stands = 3 * BINS as u64 + 77;
        for (value, ticks) in [(1.0, 5), (0.0, stands), (2.0, 1), (0.0, 1), (0.0, stands)] {
            at_once.push_times(value, ticks);
            (0..ticks).for_each(|_| each.push(value));
        }
        assert_eq!(at_once, each);
    }

    #[test]
    fn an_envelope_keeps_peaks_and_times_in_constant_memory() {
        let mut envelope = Envelope::default();
        let ticks = 10 * BINS as u32 + 123;
        for k in 0..ticks {
            envelope.push(if k == 23_460 { 9.0 } else { -f64::from(k % 2) });
        }
        assert!(envelope.bins.len() <= BINS);
        let end = envelope.bins().last().unwrap().0 + 0.5 * envelope.step_s();
        assert!((end - f64::from(ticks) * PATH_PERIOD_S).abs() <= envelope.step_s());
        let (time, peak) = envelope.bins().find(|(_, bin)| bin.high > 1.0).unwrap();
        assert_eq!(peak, Bin { low: -1.0, high: 9.0 });
        assert!((time - 23.460).abs() <= 0.5 * envelope.step_s());
        assert!(envelope.bins().all(|(_, bin)| bin.low >= -1.0));
    }
}
