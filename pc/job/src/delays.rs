//! How long measurements take.

use serde::Serialize;

/// Delays are told apart by this much \[µs\].
const STEP_US: u64 = 20;
/// Longer ones are counted together.
const LONGEST_US: u64 = 400_000;

/// Delays, by how often each occurred: of any number of them in the same memory.
#[derive(Clone, Debug)]
pub struct Delays {
    counts: Vec<u32>,
    worst_us: u64,
}

/// What delays come to \[ms\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DelayFigures {
    /// Half of them are shorter.
    pub median: f64,
    /// 99 % of them are shorter.
    pub percentile_99: f64,
    /// The longest.
    pub worst: f64,
}

impl Default for Delays {
    fn default() -> Self {
        Self {
            counts: vec![0; (LONGEST_US / STEP_US) as usize + 1],
            worst_us: 0,
        }
    }
}

impl Delays {
    /// Counts one.
    pub fn add(&mut self, delay_us: u64) {
        self.counts[(delay_us.min(LONGEST_US) / STEP_US) as usize] += 1;
        self.worst_us = self.worst_us.max(delay_us);
    }

    /// Median and 99th percentile, to 0.02 ms, and the longest; `None` of none.
    pub fn figures(&self) -> Option<DelayFigures> {
        Some(DelayFigures {
            median: self.percentile(50)?,
            percentile_99: self.percentile(99)?,
            worst: self.worst_us as f64 * 1e-3,
        })
    }

    /// What so many percent do not exceed \[ms\].
    fn percentile(&self, percent: u64) -> Option<f64> {
        let all: u64 = self.counts.iter().copied().map(u64::from).sum();
        let mut sum = 0;
        let step = self.counts.iter().position(|count| {
            sum += u64::from(*count);
            sum * 100 >= all * percent && all > 0
        })?;
        Some((step as u64 * STEP_US) as f64 * 1e-3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle_and_the_worst_is_exact() {
        let mut delays = Delays::default();
        assert_eq!(delays.figures(), None);
        for delay_us in [10_000, 10_050, 10_100, 12_345, 900_001] {
            delays.add(delay_us);
        }
        let figures = delays.figures().unwrap();
        assert_eq!(
            (figures.median, figures.percentile_99, figures.worst),
            (10.1, 400.0, 900.001)
        );
        for _ in 0..494 {
            delays.add(10_100);
        }
        assert_eq!(delays.figures().unwrap().percentile_99, 10.1);
    }
}
