//! A bank of chips on one bus that are written one by one and step together.

use crate::{Channel, CoarseGain, Error, FRAME_BYTES, Register};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiBus;

/// From the last SYNC edge to LDAC low: the slowest case, when all four channels of a chip were written.
pub const LOAD_SETUP_NS: u32 = 1_700;
/// How long LDAC (and CLR, when it is pulsed) stays low; the chip needs 10 ns, a line with filters more.
pub const LOAD_WIDTH_NS: u32 = 100;

/// One output of a bank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Chip, counted from 0 in the order of the SYNC pins.
    pub chip: usize,
    /// Its channel.
    pub channel: Channel,
}

/// `CHIPS` converters on one bus with a SYNC pin each and common LDAC and CLR pins (all active low).
pub struct Bank<B, P, D, const CHIPS: usize> {
    bus: B,
    sync: [P; CHIPS],
    ldac: P,
    clr: P,
    delay: D,
}

/// What fails on a bank with bus `B` and pins `P`.
pub type BankError<B, P> =
    Error<<B as embedded_hal::spi::ErrorType>::Error, <P as embedded_hal::digital::ErrorType>::Error>;

impl<B: SpiBus, P: OutputPin, D: DelayNs, const CHIPS: usize> Bank<B, P, D, CHIPS> {
    /// Takes bus and pins, deselects all chips and pulses CLR: all outputs are at 0 V when this returns.
    ///
    /// The bus must be set to [`crate::MODE`].
    pub fn new(bus: B, sync: [P; CHIPS], ldac: P, clr: P, delay: D) -> Result<Self, BankError<B, P>> {
        let mut bank = Self {
            bus,
            sync,
            ldac,
            clr,
            delay,
        };
        bank.ldac.set_high().map_err(Error::Pin)?;
        for sync in &mut bank.sync {
            sync.set_high().map_err(Error::Pin)?;
        }
        // The chip acts on the falling edge: the line may have been low since before the chip had its supply.
        bank.clr.set_high().map_err(Error::Pin)?;
        bank.delay.delay_ns(LOAD_WIDTH_NS);
        bank.clr.set_low().map_err(Error::Pin)?;
        bank.delay.delay_ns(LOAD_WIDTH_NS);
        bank.clr.set_high().map_err(Error::Pin)?;
        Ok(bank)
    }

    /// Sets `codes` (two's complement, −32768…32767 for −10…+10 V); all outputs change at the same instant.
    ///
    /// Outputs not named keep their code. After an error none has changed.
    pub fn update(&mut self, codes: &[(Output, i16)]) -> Result<(), BankError<B, P>> {
        for &(output, code) in codes {
            self.write(output.chip, Register::Data(output.channel), code as u16)?;
        }
        self.delay.delay_ns(LOAD_SETUP_NS);
        self.ldac.set_low().map_err(Error::Pin)?;
        self.delay.delay_ns(LOAD_WIDTH_NS);
        self.ldac.set_high().map_err(Error::Pin)
    }

    /// Pulls CLR: all outputs go to 0 V at once. An [`Bank::update`] is to come only after [`Bank::release`].
    pub fn clear(&mut self) -> Result<(), BankError<B, P>> {
        self.clr.set_low().map_err(Error::Pin)
    }

    /// Releases CLR; outputs stay at 0 V until the next [`Bank::update`].
    pub fn release(&mut self) -> Result<(), BankError<B, P>> {
        self.clr.set_high().map_err(Error::Pin)
    }

    /// Sets the range of an output.
    pub fn set_coarse_gain(&mut self, output: Output, gain: CoarseGain) -> Result<(), BankError<B, P>> {
        self.write(output.chip, Register::CoarseGain(output.channel), gain as u16)
    }

    /// Writes a register.
    pub fn write(&mut self, chip: usize, register: Register, data: u16) -> Result<(), BankError<B, P>> {
        self.transfer(chip, register.write_frame(data)).map(|_| ())
    }

    /// Reads a register (two frames; SDO must be wired to the bus).
    pub fn read(&mut self, chip: usize, register: Register) -> Result<u16, BankError<B, P>> {
        self.transfer(chip, register.read_frame())?;
        let [_, high, low] = self.transfer(chip, Register::NoOperation.write_frame(0))?;
        Ok(u16::from_be_bytes([high, low]))
    }

    /// Checks that every chip answers: writes two patterns to a data register, reads them back, and leaves it at
    /// zero. No output moves, because LDAC is not pulsed.
    pub fn self_test(&mut self) -> Result<(), BankError<B, P>> {
        let register = Register::Data(Channel::A);
        for chip in 0..CHIPS {
            for expected in [0x5a5a, 0xa5a5, 0x0000] {
                self.write(chip, register, expected)?;
                let seen = self.read(chip, register)?;
                if seen != expected {
                    return Err(Error::ReadBack { chip, expected, seen });
                }
            }
        }
        Ok(())
    }

    /// One frame out and one in. SYNC is raised even when the bus failed, so that the chip drops a torn frame.
    fn transfer(
        &mut self,
        chip: usize,
        mut frame: [u8; FRAME_BYTES],
    ) -> Result<[u8; FRAME_BYTES], BankError<B, P>> {
        let sync = self
            .sync
            .get_mut(chip)
            .ok_or(Error::NoSuchChip { chip, chips: CHIPS })?;
        sync.set_low().map_err(Error::Pin)?;
        let transferred = self
            .bus
            .transfer_in_place(&mut frame)
            .and_then(|()| self.bus.flush());
        sync.set_high().map_err(Error::Pin)?;
        transferred.map_err(Error::Bus)?;
        Ok(frame)
    }
}
