//! CPU load of the motion board: what its ticks took, on any path.

use serde::Serialize;
use shared::protocol::BoardLoad;
use shared::ticks::{PATH_PERIOD_S, SERVO_PERIOD_S};
use std::fmt;

/// Execution times of the ticks, and the clock they are counted by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Load {
    /// Cycles of the processor in a microsecond; on an emulated board instructions.
    pub cycles_per_us: u16,
    /// Of the path ticks: a share of planning, interpolation, kinematics.
    pub path_tick: ExecutionTimes,
    /// Of the longest servo tick in each ms, on an emulated board with its share of the simulated machine.
    pub servo_tick: ExecutionTimes,
}

/// Execution times of one kind of tick, without what interrupted it \[cycles\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ExecutionTimes {
    /// Mean.
    pub mean: u32,
    /// Not exceeded in 99 % of the ticks.
    pub percentile_99: u32,
    /// Worst case.
    pub worst: u32,
    /// Cycles between two ticks.
    pub period: u32,
}

impl Load {
    /// Of the ticks that told theirs; `None` if none did.
    pub fn of(told: impl IntoIterator<Item = BoardLoad>) -> Option<Self> {
        let told: Vec<BoardLoad> = told.into_iter().collect();
        let cycles_per_us = told.first()?.cycles_per_us;
        let times = |period_s: f64, of: fn(&BoardLoad) -> u32| {
            let period = period_s * 1e6 * f64::from(cycles_per_us);
            ExecutionTimes::of(told.iter().map(of).collect(), period as u32)
        };
        Some(Self {
            cycles_per_us,
            path_tick: times(PATH_PERIOD_S, |load| load.path_tick),
            servo_tick: times(SERVO_PERIOD_S, |load| load.servo_tick),
        })
    }
}

impl ExecutionTimes {
    /// Of at least one tick.
    fn of(mut cycles: Vec<u32>, period: u32) -> Self {
        cycles.sort_unstable();
        let sum: u64 = cycles.iter().copied().map(u64::from).sum();
        Self {
            mean: (sum / cycles.len() as u64) as u32,
            percentile_99: cycles[(cycles.len() - 1) * 99 / 100],
            worst: cycles[cycles.len() - 1],
            period,
        }
    }
}

impl fmt::Display for ExecutionTimes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            mean,
            percentile_99,
            worst,
            period,
        } = *self;
        let share = 100.0 * f64::from(worst) / f64::from(period);
        write!(
            f,
            "{worst:6} cycles at worst ({share:.1} % of {period}), {percentile_99} in 99 %, {mean} mean"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_all_ticks_that_told_theirs() {
        let ticks = (1..=1000).map(|n| BoardLoad {
            cycles_per_us: 125,
            path_tick: 10 * (1001 - n),
            servo_tick: 5000,
        });
        let load = Load::of(ticks).unwrap();
        let expected = ExecutionTimes {
            mean: 5005,
            percentile_99: 9900,
            worst: 10_000,
            period: 125_000,
        };
        assert_eq!(load.path_tick, expected);
        assert_eq!((load.servo_tick.worst, load.servo_tick.period), (5000, 31_250));
        let words = " 10000 cycles at worst (8.0 % of 125000), 9900 in 99 %, 5005 mean";
        assert_eq!(load.path_tick.to_string(), words);
        assert_eq!(Load::of([]), None);
    }
}
