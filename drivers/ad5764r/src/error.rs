//! Why an access to a bank failed.

use thiserror::Error;

/// Why an access failed. `B` is the error of the bus, `P` of the pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Error<B, P> {
    /// The SPI bus reported an error; the frame may not have arrived.
    #[error("the SPI bus of the DAC failed")]
    Bus(B),
    /// A SYNC, LDAC or CLR pin could not be set.
    #[error("a control pin of the DAC could not be set")]
    Pin(P),
    /// There is no such chip in the bank.
    #[error("DAC chip {chip} does not exist, the bank has {chips}: correct the output table")]
    NoSuchChip {
        /// Asked for, counted from 0.
        chip: usize,
        /// How many the bank has.
        chips: usize,
    },
    /// A register did not read back as written: broken wiring, a chip without supply, or a missing chip.
    #[error("DAC chip {chip} read back {seen:#06x} instead of {expected:#06x}: check its wiring and supply")]
    ReadBack {
        /// Which chip.
        chip: usize,
        /// What was written.
        expected: u16,
        /// What came back.
        seen: u16,
    },
}
