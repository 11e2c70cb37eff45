//! CPU load of the motion board: what its ticks took, on any path.

use serde::Serialize;
use shared::protocol::BoardLoad;
use shared::ticks::{PATH_PERIOD_S, SERVO_PERIOD_S};
use std::collections::BTreeMap;
use std::fmt;

/// Execution times of the ticks, and the clock they are counted by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Load {
    /// Cycles of the processor in a microsecond; on an emulated board instructions.
    pub cycles_per_us: u16,
    /// Of the path ticks: interpolation, kinematics, filter.
    pub path_tick: ExecutionTimes,
    /// Of the longest servo tick in each ms, on an emulated board without the simulated machine.
    pub servo_tick: ExecutionTimes,
    /// Of the turns of planning, one after each path tick.
    pub planning: ExecutionTimes,
    /// Turns that had not ended at the next path tick: their plans came later, which costs time only.
    pub planning_missed: u32,
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

/// Loads of many ticks, by how often each time was seen: they lie within a few periods, however many ticks there are.
#[derive(Default)]
pub(super) struct Loads {
    cycles_per_us: Option<u16>,
    path_ticks: BTreeMap<u32, u64>,
    servo_ticks: BTreeMap<u32, u64>,
    turns: BTreeMap<u32, u64>,
    /// Turns missed, at the first and the last tick.
    missed: Option<[u32; 2]>,
}

impl Loads {
    pub(super) fn add(&mut self, told: &BoardLoad) {
        self.cycles_per_us.get_or_insert(told.cycles_per_us);
        *self.path_ticks.entry(told.path_tick).or_default() += 1;
        *self.servo_ticks.entry(told.servo_tick).or_default() += 1;
        *self.turns.entry(told.planning).or_default() += 1;
        self.missed.get_or_insert([told.planning_missed; 2])[1] = told.planning_missed;
    }

    /// `None` if no tick told its load.
    pub(super) fn all(&self) -> Option<Load> {
        let cycles_per_us = self.cycles_per_us?;
        let times = |period_s: f64, counts| {
            let period = period_s * 1e6 * f64::from(cycles_per_us);
            ExecutionTimes::of(counts, period as u32)
        };
        Some(Load {
            cycles_per_us,
            path_tick: times(PATH_PERIOD_S, &self.path_ticks),
            servo_tick: times(SERVO_PERIOD_S, &self.servo_ticks),
            planning: times(PATH_PERIOD_S, &self.turns),
            planning_missed: self.missed.map_or(0, |[first, last]| last.wrapping_sub(first)),
        })
    }
}

impl ExecutionTimes {
    /// Of at least one tick, by its cycles.
    fn of(counts: &BTreeMap<u32, u64>, period: u32) -> Self {
        let ticks: u64 = counts.values().sum();
        let sum: u64 = counts
            .iter()
            .map(|(cycles, ticks)| u64::from(*cycles) * ticks)
            .sum();
        // All but the longest hundredth.
        let most = (ticks - 1) * 99 / 100;
        let mut seen = 0;
        let percentile = counts.iter().find(|(_, ticks)| {
            seen += **ticks;
            seen > most
        });
        let cycles = |found: Option<(&u32, &u64)>| found.map_or(0, |(cycles, _)| *cycles);
        Self {
            mean: (sum / ticks) as u32,
            percentile_99: cycles(percentile),
            worst: cycles(counts.last_key_value()),
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
            planning: 20_000,
            planning_missed: 7 + n / 500,
        });
        let mut loads = Loads::default();
        assert_eq!(loads.all(), None);
        ticks.for_each(|tick| loads.add(&tick));
        let load = loads.all().unwrap();
        let expected = ExecutionTimes {
            mean: 5005,
            percentile_99: 9900,
            worst: 10_000,
            period: 125_000,
        };
        assert_eq!(load.path_tick, expected);
        assert_eq!((load.servo_tick.worst, load.servo_tick.period), (5000, 31_250));
        assert_eq!((load.planning.worst, load.planning.period), (20_000, 125_000));
        assert_eq!(load.planning_missed, 2);
        let words = " 10000 cycles at worst (8.0 % of 125000), 9900 in 99 %, 5005 mean";
        assert_eq!(load.path_tick.to_string(), words);
    }
}
