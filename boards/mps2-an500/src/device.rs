//! Interrupts of the board under the names every firmware binds, in the form RTIC expects of a device crate.

use cortex_m::interrupt::InterruptNumber;

/// Bits of an interrupt priority.
pub const NVIC_PRIO_BITS: u8 = 3;

/// Interrupts a firmware may bind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
#[repr(u16)]
pub enum Interrupt {
    /// Spare, for software tasks (UART 1 receives).
    SOFT_0 = 2,
    /// Spare, for software tasks (UART 1 sends).
    SOFT_1 = 3,
    /// Timer 0: servo tick of the motion board.
    SERVO_TICK = 8,
    /// Timer 1: path tick of the motion board.
    PATH_TICK = 9,
    /// Dual timer: the watchdog, handled by this crate.
    WATCHDOG = 10,
    /// Network controller.
    ETHERNET = 13,
}

impl Interrupt {
    /// Timer 0: control tick of the tracker board.
    pub const CONTROL_TICK: Self = Self::SERVO_TICK;
}

pub use Interrupt as interrupt;

// SAFETY: the numbers are those of the board's interrupt controller.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}
