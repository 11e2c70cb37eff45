//! Supervision of a bank while it runs.

use crate::{Bank, BankError, Error, Output, Register};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiBus;

/// How often in a row an output may read back another code than it was given before that is an error. One reading may
/// be disturbed on its way back, while the code itself arrived; and every update writes it again.
pub const TOLERATED: u8 = 2;

/// Reads one output after another back, one in several updates.
///
/// Each reading is two frames. A converter that lost its supply, or a line of the bus that broke, is an error after
/// `every` × (number of outputs + [`TOLERATED`]) updates at the latest.
#[derive(Clone, Copy, Debug)]
pub struct ReadBack {
    every: u32,
    /// Updates since the last reading.
    updates: u32,
    /// Index of the output whose turn it is.
    turn: usize,
    /// Readings in a row that showed another code.
    wrong: u8,
}

impl ReadBack {
    /// Reads an output back in every `every`-th update (1 or more).
    pub const fn new(every: u32) -> Self {
        Self {
            every,
            updates: 0,
            turn: 0,
            wrong: 0,
        }
    }

    /// To be called after each successful [`Bank::update`], with the same codes. An error of the bus is
    /// reported at once, a code that is not what was written when it was so more than [`TOLERATED`] times in
    /// a row.
    pub fn after_update<B: SpiBus, P: OutputPin, D: DelayNs, const CHIPS: usize>(
        &mut self,
        bank: &mut Bank<B, P, D, CHIPS>,
        codes: &[(Output, i16)],
    ) -> Result<(), BankError<B, P>> {
        self.updates += 1;
        if self.updates < self.every {
            return Ok(());
        }
        self.updates = 0;
        if self.turn >= codes.len() {
            self.turn = 0;
        }
        let Some(&(Output { chip, channel }, code)) = codes.get(self.turn) else {
            return Ok(());
        };
        let expected = code as u16;
        let seen = bank.read(chip, Register::Data(channel))?;
        if seen == expected {
            self.wrong = 0;
            self.turn += 1;
            return Ok(());
        }
        // The same output again next time.
        self.wrong += 1;
        if self.wrong <= TOLERATED {
            return Ok(());
        }
        Err(Error::ReadBack { chip, expected, seen })
    }
}
