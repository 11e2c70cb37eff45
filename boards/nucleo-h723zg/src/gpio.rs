//! Pins by their place in the tables of [`crate::pins`].

use crate::pins::Pin;
use core::convert::Infallible;
use embassy_stm32::pac::{self, gpio::Gpio, gpio::vals};
use embedded_hal::digital;

/// Distance of two ports' registers.
const PORT_STRIDE: usize = 0x400;

/// Registers of a port, A = 0.
pub(crate) fn port(number: u8) -> Gpio {
    let base = pac::GPIOA.as_ptr() as usize;
    // SAFETY: ports A to K lie at this distance; the pin tables hold A to H only.
    unsafe { Gpio::from_ptr((base + usize::from(number) * PORT_STRIDE) as *mut ()) }
}

/// Makes `pin` an input that reads low when nothing drives it.
pub(crate) fn input(pin: Pin) {
    let (port, n) = (port(pin.port), usize::from(pin.number));
    port.pupdr().modify(|w| w.set_pupdr(n, vals::Pupdr::PULL_DOWN));
    port.moder().modify(|w| w.set_moder(n, vals::Moder::INPUT));
}

/// Connects `pin` to a peripheral, without pull.
pub(crate) fn alternate(pin: Pin, function: u8, speed: vals::Ospeedr) {
    let (port, n) = (port(pin.port), usize::from(pin.number));
    port.pupdr().modify(|w| w.set_pupdr(n, vals::Pupdr::FLOATING));
    port.ospeedr().modify(|w| w.set_ospeedr(n, speed));
    port.afr(n / 8).modify(|w| w.set_afr(n % 8, function));
    port.moder().modify(|w| w.set_moder(n, vals::Moder::ALTERNATE));
}

/// A push-pull output.
pub(crate) struct Output {
    port: Gpio,
    bit: u32,
}

impl Output {
    /// Makes `pin` an output that starts at this level, without a glitch.
    pub(crate) fn new(pin: Pin, high: bool) -> Self {
        let (port, n) = (port(pin.port), usize::from(pin.number));
        let mut output = Self { port, bit: 1 << n };
        output.set(high);
        port.ospeedr()
            .modify(|w| w.set_ospeedr(n, vals::Ospeedr::MEDIUM_SPEED));
        port.moder().modify(|w| w.set_moder(n, vals::Moder::OUTPUT));
        output
    }

    fn set(&mut self, high: bool) {
        let store = if high { self.bit } else { self.bit << 16 };
        self.port.bsrr().write_value(pac::gpio::regs::Bsrr(store));
    }
}

impl digital::ErrorType for Output {
    type Error = Infallible;
}

impl digital::OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}
