//! Periodic interrupts from basic timers.

use crate::clocks::TIMER_MHZ;
use crate::schedule::Schedule;
use crate::timebase::now_us;
use embassy_stm32::pac::timer::TimBasic;
use embassy_stm32::pac::timer::vals::Urs;

/// Clock of a tick timer \[MHz\].
const TICK_MHZ: u32 = 10;

/// A periodic interrupt.
pub struct Tick {
    timer: TimBasic,
    schedule: Schedule,
}

impl Tick {
    /// Starts `N` timers, which are clocked, in phase, each with its period of at most 6553 µs.
    pub(crate) fn start<const N: usize>(timers: [(TimBasic, u32); N]) -> [Self; N] {
        for (timer, period_us) in timers {
            timer.psc().write_value((TIMER_MHZ / TICK_MHZ - 1) as u16);
            timer
                .arr()
                .write(|w| w.set_arr((period_us * TICK_MHZ - 1) as u16));
            // Prescaler and period are taken over at an update, which is not to count as a tick.
            timer.cr1().modify(|w| w.set_urs(Urs::COUNTER_ONLY));
            timer.egr().write(|w| w.set_ug(true));
            timer.sr().modify(|w| w.set_uif(false));
            timer.dier().modify(|w| w.set_uie(true));
        }
        cortex_m::interrupt::free(|_| {
            for (timer, _) in timers {
                timer.cr1().modify(|w| w.set_cen(true));
            }
            let now = now_us();
            timers.map(|(timer, period_us)| Self {
                timer,
                schedule: Schedule::new(period_us, now),
            })
        })
    }

    /// Clears the interrupt; returns the periods that have passed since the last call, by the one timebase:
    /// 1 when on time, more when ticks were lost.
    pub fn acknowledge(&mut self) -> u32 {
        self.timer.sr().modify(|w| w.set_uif(false));
        self.schedule.passed(now_us())
    }

    /// When the period began that was acknowledged last \[µs\].
    pub fn began_us(&self) -> u64 {
        self.schedule.began_us()
    }
}
