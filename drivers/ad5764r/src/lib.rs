//! AD5764R: four channels of 16 bits, ±10 V, internal reference; several chips on one SPI bus.
//!
//! A [`Bank`] holds the bus, one SYNC pin a chip, and the LDAC and CLR pins that all chips share. New codes are
//! shifted into every chip while LDAC is high and take effect together at one LDAC pulse, so that no axis steps
//! before another. If anything fails on the way LDAC is not pulsed, and the outputs stay as they were.
//!
//! Codes are two's complement: strap BIN/2sCOMP low. Then the power-up code and the code after CLR are both 0 V;
//! strapped for offset binary, the same codes would be full negative scale.
//!
//! The chip takes data on the falling edge of SCLK: [`MODE`], at most 30 MHz ([`MAX_CLOCK_HZ`]).

#![no_std]

mod bank;
mod error;
mod frame;
mod read_back;

pub use bank::{Bank, BankError, LOAD_SETUP_NS, LOAD_WIDTH_NS, Output};
pub use error::Error;
pub use frame::{Channel, CoarseGain, FRAME_BYTES, Register};
pub use read_back::{ReadBack, TOLERATED};

use embedded_hal::spi;

/// Clock idles low, data is taken on the second (falling) edge.
pub const MODE: spi::Mode = spi::MODE_1;

/// Highest SCLK.
pub const MAX_CLOCK_HZ: u32 = 30_000_000;

/// Volts of code 32767 with the default coarse gain: one step of the lower bits short of +10 V.
pub const FULL_SCALE_V: f64 = 10.0 * 32767.0 / 32768.0;
