//! Counting periods by the one timebase, so that a lost tick is seen.

/// When the next tick of a periodic interrupt is due.
#[derive(Clone, Copy, Debug)]
pub struct Schedule {
    period_us: u64,
    due_us: u64,
}

impl Schedule {
    /// Ticks every `period_us`, the first one period after `start_us`.
    pub fn new(period_us: u32, start_us: u64) -> Self {
        let period_us = u64::from(period_us);
        Self {
            period_us,
            due_us: start_us + period_us,
        }
    }

    /// Periods that have passed since the last call, now that an interrupt is handled at `now_us`: 1 when on
    /// time, more when ticks were lost.
    pub fn passed(&mut self, now_us: u64) -> u32 {
        if now_us + self.period_us / 2 < self.due_us {
            // The timer struck once more while the last call was reading the time, which counted that tick.
            return 1;
        }
        let periods = now_us.saturating_sub(self.due_us) / self.period_us + 1;
        self.due_us += periods * self.period_us;
        periods as u32
    }

    /// When the period began that was counted last: that is where the hardware's is, however late it was served.
    pub fn began_us(&self) -> u64 {
        self.due_us - self.period_us
    }
}

#[cfg(test)]
mod tests {
    use super::Schedule;

    #[test]
    fn ticks_on_time_count_one_each_however_late_within_their_period() {
        let mut schedule = Schedule::new(250, 1000);
        for tick in 1..=1000u64 {
            // Up to 1 µs early by rounding, up to 249 µs late by other tasks.
            let late = (tick * 97) % 251;
            assert_eq!(schedule.passed(1000 + tick * 250 + late - 1), 1, "tick {tick}");
            assert_eq!(schedule.began_us(), 1000 + tick * 250);
        }
    }

    #[test]
    fn a_stall_counts_every_period_it_swallowed_and_the_beat_stays() {
        let mut schedule = Schedule::new(250, 0);
        assert_eq!(schedule.passed(251), 1);
        assert_eq!(schedule.passed(250 * 5 + 100), 4);
        assert_eq!(schedule.passed(250 * 6 + 3), 1);
    }

    #[test]
    fn a_tick_that_was_already_counted_does_not_move_the_beat() {
        let mut schedule = Schedule::new(250, 0);
        assert_eq!(schedule.passed(501), 2);
        assert_eq!(schedule.passed(502), 1);
        assert_eq!(schedule.passed(750), 1);
        assert_eq!(schedule.passed(1000), 1);
    }
}
