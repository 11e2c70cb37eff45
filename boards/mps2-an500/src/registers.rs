//! Memory-mapped registers.

/// A block of 32-bit registers.
#[derive(Clone, Copy)]
pub struct Block(usize);

impl Block {
    pub const UART0: Self = Self(0x4000_4000);
    pub const TIMER0: Self = Self(0x4000_0000);
    pub const TIMER1: Self = Self(0x4000_1000);
    /// First counter of the dual timer.
    pub const DUAL_TIMER_1: Self = Self(0x4000_2000);
    /// Second counter of the dual timer.
    pub const DUAL_TIMER_2: Self = Self(0x4000_2020);
    /// Lamps and switches.
    pub const FPGA_IO: Self = Self(0x4002_8000);
    pub const LAN9118: Self = Self(0xA000_0000);

    pub fn read(self, offset: usize) -> u32 {
        // SAFETY: a block is a peripheral of this board; its registers are 32 bits wide and always readable.
        unsafe { ((self.0 + offset) as *const u32).read_volatile() }
    }

    pub fn write(self, offset: usize, value: u32) {
        // SAFETY: as above, and writing a register of these peripherals touches no memory of the program.
        unsafe { ((self.0 + offset) as *mut u32).write_volatile(value) }
    }
}

impl lan9118::Bus for Block {
    fn read(&mut self, offset: usize) -> u32 {
        Block::read(*self, offset)
    }

    fn write(&mut self, offset: usize, value: u32) {
        Block::write(*self, offset, value);
    }
}
