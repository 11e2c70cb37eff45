//! Virtual time.

use std::fmt::{self, Display, Formatter};
use std::ops::{Add, Sub};

/// A time since power-up, or a duration, in picoseconds: 2⁶⁴ ps are 213 days.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Time(pub u64);

const PS_PER_SECOND: u128 = 1_000_000_000_000;

impl Time {
    /// Later than any board lives.
    pub const NEVER: Self = Self(u64::MAX);

    /// Nanoseconds.
    pub const fn ns(ns: u64) -> Self {
        Self(ns * 1000)
    }

    /// Microseconds.
    pub const fn us(us: u64) -> Self {
        Self::ns(us * 1000)
    }

    /// Milliseconds.
    pub const fn ms(ms: u64) -> Self {
        Self::us(ms * 1000)
    }

    /// What `periods` of a clock of `hz` take, rounded up; for ever without clock.
    pub fn periods(periods: u64, hz: u64) -> Self {
        match hz {
            0 => Self::NEVER,
            _ => Self(
                u64::try_from((u128::from(periods) * PS_PER_SECOND).div_ceil(u128::from(hz)))
                    .unwrap_or(u64::MAX),
            ),
        }
    }

    /// Whole periods of a clock of `hz` in this time.
    pub fn count(self, hz: u64) -> u64 {
        u64::try_from(u128::from(self.0) * u128::from(hz) / PS_PER_SECOND).unwrap_or(u64::MAX)
    }

    /// In seconds.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / PS_PER_SECOND as f64
    }

    /// In whole nanoseconds.
    pub fn as_ns(self) -> u64 {
        self.0 / 1000
    }
}

impl Add for Time {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

/// Never below zero.
impl Sub for Time {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Display for Time {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{:.6} ms", self.seconds() * 1e3)
    }
}

/// The clock of the core: counts cycles, and turns them into time at whatever frequency it has.
#[derive(Clone, Copy, Debug)]
pub struct CoreClock {
    /// Cycles since power-up.
    pub cycles: u64,
    hz: u64,
    /// Cycles and time at the last change of the frequency.
    since: (u64, Time),
}

impl CoreClock {
    /// A clock of `hz` at time `now`.
    pub fn new(hz: u64, now: Time) -> Self {
        Self {
            cycles: 0,
            hz,
            since: (0, now),
        }
    }

    /// Frequency \[Hz\].
    pub fn hz(&self) -> u64 {
        self.hz
    }

    /// Time since power-up.
    pub fn now(&self) -> Time {
        self.since.1 + Time::periods(self.cycles - self.since.0, self.hz)
    }

    /// Goes on at another frequency.
    pub fn change(&mut self, hz: u64) {
        self.since = (self.cycles, self.now());
        self.hz = hz;
    }

    /// The first cycle at which `time` has come.
    pub fn cycle_at(&self, time: Time) -> u64 {
        if time == Time::NEVER {
            return u64::MAX;
        }
        let wait = u128::from((time - self.since.1).0) * u128::from(self.hz);
        self.since
            .0
            .saturating_add(u64::try_from(wait.div_ceil(PS_PER_SECOND)).unwrap_or(u64::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_keeps_its_time_when_its_frequency_changes() {
        let mut clock = CoreClock::new(64_000_000, Time::default());
        clock.cycles += 64_000;
        assert_eq!(clock.now(), Time::ms(1));
        clock.change(520_000_000);
        clock.cycles += 520_000;
        assert_eq!(clock.now(), Time::ms(2));
        assert_eq!(clock.cycle_at(Time::ms(3)), clock.cycles + 520_000);
        assert_eq!(clock.cycle_at(Time::NEVER), u64::MAX);
    }

    #[test]
    fn periods_and_counts_agree() {
        for hz in [32_000, 7_222_222, 260_000_000] {
            for count in [0, 1, 7, 1_000_000] {
                assert_eq!(Time::periods(count, hz).count(hz), count, "{hz} Hz");
            }
        }
        assert_eq!(Time::periods(1, 0), Time::NEVER);
    }
}
