//! The processor's instructions; exceptions, time and everything on the bus are this program's own.

pub mod cycles;
pub mod fetch;
mod unicorn;

pub use unicorn::UnicornCpu;

use cycles::Block;

/// Registers of the core (ARMv7-M B1.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// R0 to R12.
    R(u8),
    /// The stack pointer in use.
    Sp,
    /// Link register.
    Lr,
    /// Program counter, without the bit for Thumb.
    Pc,
    /// Program status with the number of the exception.
    Xpsr,
    /// Bit 0 masks all exceptions of configurable priority.
    Primask,
    /// Masks exceptions from this priority on, unless 0.
    Basepri,
    /// Bit 0 masks all but the non-maskable interrupt.
    Faultmask,
    /// Bit 1: process stack; bit 2: floating-point context active.
    Control,
    /// Floating-point status.
    Fpscr,
}

/// What the core does with memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Loads.
    Read,
    /// Stores.
    Write,
    /// Fetches an instruction.
    Fetch,
}

/// Why the core stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The bus asked for it.
    Asked,
    /// It waits for an interrupt.
    Wait,
    /// It branched to an EXC_RETURN value, which is given.
    ExceptionReturn(u32),
    /// Supervisor call.
    Supervisor,
    /// No memory answers, or it refuses.
    Refused {
        /// What was tried.
        access: Access,
        /// Where.
        address: u32,
    },
    /// An instruction that the core does not have, or not in this state; the number is the back end's.
    Undefined(u32),
}

/// Whether a block of instructions may run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// It runs.
    Run,
    /// The core stops before it.
    Stop,
    /// An exception is pending: it runs unless [`Bus::preempts`].
    Pending,
}

/// What the core sees. It is called while the core runs.
pub trait Bus {
    /// A block of instructions at `pc` is about to run, and takes `half_cycles` but for what it waits on the bus.
    fn step(&mut self, pc: u32, block: &Block, half_cycles: u32) -> Step;
    /// Whether the pending exception is taken now.
    fn preempts(&mut self, masks: Masks) -> bool;
    /// A load from a window of [`Cpu::map_bus`].
    fn read(&mut self, address: u32, size: u32) -> u64;
    /// A store to such a window.
    fn write(&mut self, address: u32, size: u32, value: u64);
}

/// Registers that hold exceptions back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Masks {
    /// PRIMASK.
    pub primask: bool,
    /// FAULTMASK.
    pub faultmask: bool,
    /// BASEPRI.
    pub basepri: u8,
}

/// No memory is mapped there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unmapped;

/// A Cortex-M7 with double-precision floating point, without its exceptions.
pub trait Cpu {
    /// What it is connected to.
    type Bus: Bus;

    /// What it is connected to.
    fn bus(&self) -> &Self::Bus;
    /// What it is connected to.
    fn bus_mut(&mut self) -> &mut Self::Bus;
    /// Reads a register.
    fn get(&self, register: Register) -> u32;
    /// Sets a register.
    fn set(&mut self, register: Register, value: u32);
    /// Reads floating-point register D`n`.
    fn get_double(&self, n: u8) -> u64;
    /// Sets floating-point register D`n`.
    fn set_double(&mut self, n: u8, value: u64);
    /// Puts memory at `address`, `writable` or not, with its first contents.
    fn map(&mut self, address: u32, contents: &[u8], writable: bool) -> Result<(), Unmapped>;
    /// Passes accesses in `length` bytes at `address` to the bus.
    fn map_bus(&mut self, address: u32, length: u32) -> Result<(), Unmapped>;
    /// Reads memory, not the bus.
    fn load(&self, address: u32, to: &mut [u8]) -> Result<(), Unmapped>;
    /// Writes memory, not the bus, also where it is not writable.
    fn store(&mut self, address: u32, from: &[u8]) -> Result<(), Unmapped>;
    /// Runs from the program counter until something stops it.
    fn run(&mut self) -> Stop;

    /// What holds exceptions back now.
    fn masks(&self) -> Masks {
        Masks {
            primask: self.get(Register::Primask) & 1 != 0,
            faultmask: self.get(Register::Faultmask) & 1 != 0,
            basepri: self.get(Register::Basepri) as u8,
        }
    }

    /// Reads a word of memory.
    fn load_word(&self, address: u32) -> Result<u32, Unmapped> {
        let mut word = [0; 4];
        self.load(address, &mut word)?;
        Ok(u32::from_le_bytes(word))
    }
}
