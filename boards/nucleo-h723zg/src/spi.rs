//! The bus of the converters: SPI3, set up by the HAL, used without any wait that may not end.

use crate::clocks::{CORE_MHZ, SPI_HZ};
use crate::exchange::{Failure, Shifter, exchange};
use crate::timebase;
use embassy_stm32::Peri;
use embassy_stm32::mode::Blocking;
use embassy_stm32::pac::SPI3;
use embassy_stm32::peripherals::{self, PC10, PC11, PC12};
use embassy_stm32::spi::{self, Spi, mode::Master};
use embassy_stm32::time::Hertz;
use embedded_hal::spi::{ErrorKind, ErrorType, SpiBus};

/// Flags that IFCR clears: bits 3 to 11, EOTC to SUSPC (RM0468, SPI_IFCR).
const FLAGS: u32 = 0xff8;
/// Bytes that the controller may have left from a frame that was given up.
const FIFO: u32 = 16;
/// Cycles of the core that a byte takes on the wire.
const BYTE_CYCLES: u32 = (8 * CORE_MHZ as u64 * 1_000_000 / SPI_HZ as u64) as u32;
/// How often as long as on the wire a frame may take. Between bytes the controller's registers are read and written
/// a few times, which takes less than a byte does.
const PATIENCE: u32 = 4;

/// The bus. Only pins, clock and modes are the HAL's.
pub(crate) struct Bus {
    _setup: Spi<'static, Blocking, Master>,
}

impl Bus {
    /// Sets the bus up.
    pub(crate) fn start(
        controller: Peri<'static, peripherals::SPI3>,
        sck: Peri<'static, PC10>,
        mosi: Peri<'static, PC12>,
        miso: Peri<'static, PC11>,
    ) -> Self {
        let mut config = spi::Config::default();
        // ad5764r::MODE in the HAL's own type.
        config.mode = spi::MODE_1;
        config.frequency = Hertz(SPI_HZ);
        Self {
            _setup: Spi::new_blocking(controller, sck, mosi, miso, config),
        }
    }
}

impl Shifter for Bus {
    fn begin(&mut self) {
        // Switching the controller off ends what it was at.
        SPI3.cr1().modify(|w| w.set_spe(false));
        SPI3.ifcr().write(|w| w.0 = FLAGS);
        SPI3.cr1().modify(|w| w.set_spe(true));
        for _ in 0..FIFO {
            if !SPI3.sr().read().rxp() {
                break;
            }
            SPI3.rxdr8().read();
        }
    }

    fn failed(&mut self) -> bool {
        let status = SPI3.sr().read();
        status.ovr() || status.udr() || status.modf() || status.tifre()
    }

    fn has_room(&mut self) -> bool {
        SPI3.sr().read().txp()
    }

    fn send(&mut self, byte: u8) {
        SPI3.txdr8().write_value(byte);
        SPI3.cr1().modify(|w| w.set_cstart(true));
    }

    fn received(&mut self) -> Option<u8> {
        SPI3.sr().read().rxp().then(|| SPI3.rxdr8().read())
    }

    fn cycles(&mut self) -> u32 {
        timebase::cycles()
    }
}

impl embedded_hal::spi::Error for Failure {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TimedOut => ErrorKind::Other,
            Self::Torn => ErrorKind::Overrun,
        }
    }
}

impl ErrorType for Bus {
    type Error = Failure;
}

impl SpiBus for Bus {
    fn read(&mut self, words: &mut [u8]) -> Result<(), Failure> {
        words.fill(0);
        self.transfer_in_place(words)
    }

    fn write(&mut self, words: &[u8]) -> Result<(), Failure> {
        words
            .iter()
            .try_for_each(|&word| self.transfer_in_place(&mut [word]))
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Failure> {
        let both = read.len().min(write.len());
        read.fill(0);
        read[..both].copy_from_slice(&write[..both]);
        self.transfer_in_place(read)?;
        self.write(&write[both..])
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Failure> {
        let limit = PATIENCE * BYTE_CYCLES * words.len() as u32;
        exchange(self, words, limit)
    }

    /// Every byte that went out has come in: nothing is left to wait for.
    fn flush(&mut self) -> Result<(), Failure> {
        Ok(())
    }
}
