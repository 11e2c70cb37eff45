//! Interrupts of the board under the names every firmware binds, in the form RTIC expects of a device crate.
//!
//! The vector table is that of `stm32-metapac`; `regions.x` makes its entries point at the handlers that the
//! firmware defines under these names.

use cortex_m::interrupt::InterruptNumber;
use embassy_stm32::pac;

/// Bits of an interrupt priority.
pub const NVIC_PRIO_BITS: u8 = pac::NVIC_PRIO_BITS;

/// Interrupts a firmware may bind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
#[repr(u16)]
pub enum Interrupt {
    /// TIM6: servo tick of the motion board.
    SERVO_TICK = pac::Interrupt::TIM6_DAC as u16,
    /// TIM7: path tick of the motion board.
    PATH_TICK = pac::Interrupt::TIM7 as u16,
    /// Ethernet controller.
    ETHERNET = pac::Interrupt::ETH as u16,
    /// Spare, for software tasks (filter accelerator, unused).
    SOFT_0 = pac::Interrupt::FMAC as u16,
    /// Spare, for software tasks (CORDIC accelerator, unused).
    SOFT_1 = pac::Interrupt::CORDIC as u16,
}

impl Interrupt {
    /// TIM6: control tick of the tracker board.
    pub const CONTROL_TICK: Self = Self::SERVO_TICK;
}

pub use Interrupt as interrupt;

// SAFETY: the numbers are those of the chip's own interrupt table.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}
