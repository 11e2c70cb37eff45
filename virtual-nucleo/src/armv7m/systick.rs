//! The system timer (ARMv7-M B3.3). It counts core cycles.

const ENABLE: u32 = 1;
const TICKINT: u32 = 1 << 1;
const CLKSOURCE: u32 = 1 << 2;
const COUNTFLAG: u32 = 1 << 16;
const COUNTER: u32 = 0x00ff_ffff;
/// Core cycles in one of the external reference, HCLK/8 (RM0468, 2.3).
const REFERENCE: u64 = 8;

/// The timer.
#[derive(Clone, Debug, Default)]
pub struct SysTick {
    control: u32,
    reload: u32,
    /// Value while it stands.
    held: u32,
    /// Cycle at which it reaches zero next, while it runs.
    zero_at: Option<u64>,
    flag: bool,
}

impl SysTick {
    fn step(&self) -> u64 {
        if self.control & CLKSOURCE != 0 {
            1
        } else {
            REFERENCE
        }
    }

    fn start(&mut self, now: u64) {
        // From zero the next count is the reload value.
        let steps = match (self.held, self.reload) {
            (0, 0) => {
                self.zero_at = None;
                return;
            }
            (0, reload) => u64::from(reload) + 1,
            (held, _) => u64::from(held),
        };
        self.zero_at = Some(now + steps * self.step());
    }

    fn count(&self, now: u64) -> u32 {
        match self.zero_at {
            None => self.held,
            Some(zero) => {
                let left = zero.saturating_sub(now).div_ceil(self.step());
                // Just reloaded: a full period is left, which is shown as zero for one count.
                if left > u64::from(self.reload) && self.held == 0 {
                    0
                } else {
                    left as u32 & COUNTER
                }
            }
        }
    }

    /// A register, by its offset from 0xe000e010.
    pub fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            0 => {
                self.control
                    | if std::mem::take(&mut self.flag) {
                        COUNTFLAG
                    } else {
                        0
                    }
            }
            4 => self.reload,
            8 => self.count(now),
            // Calibration: no reference value is given.
            _ => 1 << 30,
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            0 => {
                self.held = self.count(now);
                self.zero_at = None;
                self.control = value & (ENABLE | TICKINT | CLKSOURCE);
                if self.control & ENABLE != 0 {
                    self.start(now);
                }
            }
            4 => {
                self.reload = value & COUNTER;
                if self.zero_at.is_none() && self.control & ENABLE != 0 {
                    self.start(now);
                }
            }
            8 => {
                self.held = 0;
                self.flag = false;
                if self.control & ENABLE != 0 {
                    self.start(now);
                }
            }
            _ => {}
        }
    }

    /// Cycle at which it has to be looked at.
    pub fn due(&self) -> u64 {
        self.zero_at.unwrap_or(u64::MAX)
    }

    /// Counts up to `now`; whether its exception is to be pended.
    pub fn advance(&mut self, now: u64) -> bool {
        let mut struck = false;
        while let Some(zero) = self.zero_at.filter(|zero| *zero <= now) {
            struck = true;
            self.flag = true;
            self.held = 0;
            self.zero_at = (self.reload != 0).then(|| zero + (u64::from(self.reload) + 1) * self.step());
        }
        struck && self.control & TICKINT != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_strikes_every_period_from_the_clearing_write_on() {
        let mut timer = SysTick::default();
        timer.write(4, 99, 0);
        timer.write(8, 0, 0);
        timer.write(0, ENABLE | TICKINT | CLKSOURCE, 0);
        assert_eq!(timer.due(), 100);
        assert_eq!(timer.read(8, 40), 60);
        assert!(!timer.advance(99));
        assert!(timer.advance(100));
        assert_eq!(timer.due(), 200);
        assert_eq!(timer.read(0, 100) & COUNTFLAG, COUNTFLAG);
        assert_eq!(timer.read(0, 100) & COUNTFLAG, 0);
        // No longer after the reload value is zero.
        timer.write(4, 0, 150);
        assert!(timer.advance(200));
        assert_eq!(timer.due(), u64::MAX);
    }

    #[test]
    fn the_reference_clock_is_eight_times_as_slow() {
        let mut timer = SysTick::default();
        timer.write(4, 9, 0);
        timer.write(0, ENABLE, 0);
        assert_eq!(timer.due(), 80);
    }
}
