//! Periodic interrupts from basic timers.

use crate::clocks::TIMER_MHZ;
use crate::timebase::now_us;
use embassy_stm32::pac::timer::TimBasic;
use embassy_stm32::pac::timer::vals::Urs;

/// Clock of a tick timer \[MHz\].
const TICK_MHZ: u32 = 10;

/// A periodic interrupt.
pub struct Tick {
    timer: TimBasic,
    period_us: u32,
    /// When the next tick is due \[µs\].
    due_us: u64,
}

impl Tick {
    /// Sets `timer`, which is clocked, to a period of at most 6553 µs; it does not run yet.
    pub(crate) fn new(timer: TimBasic, period_us: u32) -> Self {
        timer.psc().write_value((TIMER_MHZ / TICK_MHZ - 1) as u16);
        timer
            .arr()
            .write(|w| w.set_arr((period_us * TICK_MHZ - 1) as u16));
        // Prescaler and period are taken over at an update, which is not to count as a tick.
        timer.cr1().modify(|w| w.set_urs(Urs::COUNTER_ONLY));
        timer.egr().write(|w| w.set_ug(true));
        timer.sr().modify(|w| w.set_uif(false));
        timer.dier().modify(|w| w.set_uie(true));
        Self {
            timer,
            period_us,
            due_us: 0,
        }
    }

    /// Starts all of `ticks` in phase.
    pub(crate) fn start<const N: usize>(ticks: [&mut Self; N]) {
        cortex_m::interrupt::free(|_| {
            let now = now_us();
            for tick in ticks {
                tick.timer.cr1().modify(|w| w.set_cen(true));
                tick.due_us = now + u64::from(tick.period_us);
            }
        });
    }

    /// Clears the interrupt; returns the periods that have passed since the last call, by the one timebase:
    /// 1 when on time, more when ticks were lost.
    pub fn acknowledge(&mut self) -> u32 {
        self.timer.sr().modify(|w| w.set_uif(false));
        let now = now_us();
        let period = u64::from(self.period_us);
        if now + period / 2 < self.due_us {
            // This tick came between the last call's two lines above, and is accounted for there.
            return 1;
        }
        let periods = now.saturating_sub(self.due_us) / period + 1;
        self.due_us += periods * period;
        periods as u32
    }
}
