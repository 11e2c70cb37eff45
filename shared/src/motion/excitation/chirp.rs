//! A linear chirp that repeats itself without a step.

use crate::protocol::CAPTURE_TICKS;
use crate::ticks::SERVO_PERIOD_S;
use core::f64::consts::PI;

/// Ticks of a period.
const PERIOD: u64 = CAPTURE_TICKS as u64;

/// sin(2π(m·k/N + d·k²/(2N²))) at tick k of a period of N: from m to m + d whole periods of a sine in N ticks, d even, so that
/// it begins and ends with 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Chirp {
    first: u32,
    sweep: u32,
}

impl Chirp {
    /// Distance between two lines of its spectrum \[Hz\].
    pub const LINE_HZ: f64 = 1.0 / (PERIOD as f64 * SERVO_PERIOD_S);

    /// From the line next to `from_hz` to one next to `to_hz`, which is above it.
    pub fn new(from_hz: f64, to_hz: f64) -> Self {
        let line = |hz: f64| libm::round(hz / Self::LINE_HZ).max(1.0) as u32;
        let first = line(from_hz);
        let sweep = line(to_hz).saturating_sub(first).next_multiple_of(2);
        Self { first, sweep }
    }

    /// Numbers of the first line and of the last one.
    pub fn lines(&self) -> (u32, u32) {
        (self.first, self.first + self.sweep)
    }

    /// Its value at tick `tick`, in ±1.
    pub fn at(&self, tick: u32) -> f64 {
        let k = u64::from(tick) % PERIOD;
        // Of 2N² in a turn: exact, however many turns it is.
        let turns = 2 * PERIOD * u64::from(self.first) * k + u64::from(self.sweep) * k * k;
        let part = (turns % (2 * PERIOD * PERIOD)) as f64 / (2 * PERIOD * PERIOD) as f64;
        libm::sin(2.0 * PI * part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_again_where_it_ends_and_is_as_fast_as_it_was_asked_to_be() {
        let chirp = Chirp::new(5.0, 400.0);
        assert_eq!(chirp.at(0), 0.0);
        let period = PERIOD as u32;
        for k in 0..period {
            assert_eq!(chirp.at(k), chirp.at(k + 3 * period));
        }
        // The turns before a tick, from zero to zero: at the start 5 Hz, at the end 400.
        let rises = |from: u32, ticks: u32| {
            let crossed = |k: &u32| chirp.at(*k) < 0.0 && chirp.at(*k + 1) >= 0.0;
            (from..from + ticks).filter(crossed).count()
        };
        let seconds = 0.05;
        let ticks = (seconds / SERVO_PERIOD_S) as u32;
        assert_eq!(rises(period - ticks, ticks), 20);
        // As many turns as at the mean of both.
        let mean = (5.0 + 400.0) / 2.0 * PERIOD as f64 * SERVO_PERIOD_S;
        let all = rises(0, period) as f64;
        assert!((all - mean).abs() <= 2.0, "{all} {mean}");
    }

    #[test]
    fn energy_is_where_it_was_asked_for_and_nowhere_else() {
        let chirp = Chirp::new(20.0, 300.0);
        let power = |line: u32| {
            let mut sum = (0.0, 0.0);
            for k in 0..PERIOD as u32 {
                let angle = 2.0 * PI * f64::from(line * k % PERIOD as u32) / PERIOD as f64;
                sum.0 += chirp.at(k) * libm::cos(angle);
                sum.1 += chirp.at(k) * libm::sin(angle);
            }
            libm::hypot(sum.0, sum.1) / (PERIOD as f64 / 2.0)
        };
        let (first, last) = chirp.lines();
        let mean = 1.0 / libm::sqrt(f64::from(last - first));
        for line in first + 6..last - 6 {
            let part = power(line) / mean;
            assert!((0.6..1.5).contains(&part), "line {line}: {part}");
        }
        assert!(power(last + 60) < 0.05 * mean);
    }
}
