//! Converters, enables, gates and heartbeat.

use crate::clocks::Wait;
use crate::gpio::{self, Output as Line};
use crate::pins::{
    DAC_CLEAR, DAC_LOAD, DAC_SYNC, HEARTBEAT, OUTPUT_MASK, OUTPUT_PORT, PROCESS_OUTPUTS, Pin, mask,
};
use crate::spi::Bus;
use ad5764r::{Bank, Channel, Output, ReadBack};
use core::sync::atomic::{AtomicBool, Ordering};
use defmt::Display2Format;
use embassy_stm32::pac::gpio::regs::Bsrr;

/// Set for good once everything was switched off.
static DEAD: AtomicBool = AtomicBool::new(false);

/// Everything off for good.
pub(crate) fn kill() {
    DEAD.store(true, Ordering::Relaxed);
    switch_off();
}

/// Enables, gates, triggers and heartbeat low with one store, then all converters to 0 V and the outputs of the process off.
pub(crate) fn switch_off() {
    gpio::port(OUTPUT_PORT)
        .bsrr()
        .write_value(Bsrr(u32::from(OUTPUT_MASK) << 16));
    gpio::port(DAC_CLEAR.port)
        .bsrr()
        .write_value(Bsrr(1 << (DAC_CLEAR.number + 16)));
    for pin in PROCESS_OUTPUTS {
        store(pin, false);
    }
}

/// Sets one line.
fn store(pin: Pin, on: bool) {
    let bit = 1 << pin.number;
    let store = if on { bit } else { bit << 16 };
    gpio::port(pin.port).bsrr().write_value(Bsrr(store));
}

/// Switches one line between two ticks, as long as the converters are sound.
pub(crate) fn switch_line(pin: Pin, on: bool) {
    store(pin, on && !DEAD.load(Ordering::Relaxed));
}

/// Output `index` of a row of chips with four channels each.
pub(crate) const fn output(index: usize) -> Output {
    let channel = match index % 4 {
        0 => Channel::A,
        1 => Channel::B,
        2 => Channel::C,
        _ => Channel::D,
    };
    Output {
        chip: index / 4,
        channel,
    }
}

/// All outputs of a board with `CHIPS` converters.
pub(crate) struct Outputs<const CHIPS: usize> {
    /// `None` once a converter has failed: then everything stays off until the next reset.
    bank: Option<Bank<Bus, Line, Wait, CHIPS>>,
    read_back: ReadBack,
    beat: bool,
}

impl<const CHIPS: usize> Outputs<CHIPS> {
    /// Sets up the lines of `switched` and the heartbeat, all low, and the converters, all at 0 V.
    /// One output is read back in every `read_back_every`-th tick.
    pub(crate) fn start(bus: Bus, switched: &[Pin], read_back_every: u32) -> Self {
        for &pin in switched.iter().chain(&[HEARTBEAT]) {
            Line::new(pin, false);
        }
        let sync = core::array::from_fn(|chip| Line::new(DAC_SYNC[chip], true));
        let clear = Line::new(DAC_CLEAR, false);
        let bank = Bank::new(bus, sync, Line::new(DAC_LOAD, true), clear, Wait);
        let tested = bank.and_then(|mut bank| bank.self_test().map(|()| bank));
        if let Err(error) = &tested {
            kill();
            defmt::error!(
                "{}; outputs stay off until the board is reset",
                Display2Format(error)
            );
        }
        Self {
            bank: tested.ok(),
            read_back: ReadBack::new(read_back_every),
            beat: false,
        }
    }

    /// Whether a converter has failed since reset.
    pub(crate) fn failed(&self) -> bool {
        self.bank.is_none()
    }

    /// Sets the lines of `all` to their bits in `on`, and the converters: off before the converters move, on
    /// after. The heartbeat alternates.
    pub(crate) fn apply(&mut self, all: u16, on: u16, codes: &[(Output, i16)]) {
        let Some(bank) = &mut self.bank else { return };
        let port = gpio::port(OUTPUT_PORT);
        port.bsrr().write_value(Bsrr(u32::from(all & !on) << 16));
        let read_back = &mut self.read_back;
        if let Err(error) = bank
            .update(codes)
            .and_then(|()| read_back.after_update(bank, codes))
        {
            kill();
            defmt::error!(
                "{}; outputs stay off until the board is reset",
                Display2Format(&error)
            );
            self.bank = None;
            return;
        }
        self.beat = !self.beat;
        let beat = u32::from(mask(&[HEARTBEAT]));
        let beat = if self.beat { beat } else { beat << 16 };
        port.bsrr().write_value(Bsrr(u32::from(on) | beat));
    }
}

/// Sets or clears `lines` of the output port.
pub(crate) fn switch(lines: u16, on: bool) {
    let lines = u32::from(lines);
    let store = if on { lines } else { lines << 16 };
    gpio::port(OUTPUT_PORT).bsrr().write_value(Bsrr(store));
}
