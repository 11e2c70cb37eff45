//! Faults of the core that are not in the image: what a program does that has gone wrong.

use crate::armv7m::HARD_FAULT;
use crate::board::Board;
use crate::cpu::{Cpu, Register, Unmapped};
use crate::image::{FLASH, FLASH_LENGTH};
use crate::time::Time;
use thiserror::Error;

/// Nothing is there.
const NOWHERE: u32 = 0x1000_0000;
/// `b .`, as it lies in memory.
const FOR_EVER: [u8; 2] = [0xfe, 0xe7];
/// Where it is put: no image is so long.
const LOOP: u32 = FLASH + FLASH_LENGTH as u32 - 32;
/// Blocks of instructions from the entry of a task to where it is caught.
const INTO_TASK: usize = 8;
/// Time within which a task runs that comes by itself.
const TASK_LIMIT: Time = Time::ms(5);
/// Functions of Rust's core library that panic.
const PANICS: [&str; 4] = [
    "core::panicking::panic_const::panic_const_add_overflow",
    "core::panicking::panic_const::panic_const_div_by_zero",
    "core::panicking::panic",
    "core::panicking::panic_fmt",
];

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A panic.
    Panic,
    /// A jump to where no memory is.
    WildJump,
    /// A call with the stack full.
    FullStack,
    /// A loop for ever.
    Hang,
}

/// A fault cannot be injected.
#[derive(Debug, Error)]
pub enum InjectError {
    /// The task does not run.
    #[error("the task of exception {0} does not run within {TASK_LIMIT}")]
    NoTask(u16),
    /// The image has no such symbol.
    #[error("the image has no {0}")]
    NoSymbol(&'static str),
}

impl Board {
    /// Runs until the task of this exception runs; 0 is what runs when none does. One that does not come by itself is `pended`.
    pub fn run_to_task(&mut self, exception: u16, pended: bool) -> Result<(), InjectError> {
        let end = self.now() + TASK_LIMIT;
        if pended {
            self.chip_mut().shared.system.nvic.pend(exception);
        }
        let mut blocks = 0;
        while blocks < INTO_TASK {
            if self.now() >= end {
                return Err(InjectError::NoTask(exception));
            }
            self.run_block();
            if self.running() == exception {
                blocks += 1;
            }
        }
        Ok(())
    }

    /// Lets this go wrong where the core is.
    pub fn inject(&mut self, fault: Fault) -> Result<(), InjectError> {
        let panic = PANICS.iter().find_map(|name| self.symbol(name));
        let panic = panic.ok_or(InjectError::NoSymbol("function that panics"))?;
        match fault {
            Fault::Panic => self.call(panic),
            Fault::WildJump => self.jump(NOWHERE),
            Fault::FullStack => {
                self.fill_stack(0)?;
                self.call(panic);
            }
            Fault::Hang => {
                // The image has no such loop; it gets one behind its end.
                let loops = self.core_mut().store(LOOP, &FOR_EVER);
                loops.map_err(|Unmapped| InjectError::NoSymbol("end of the flash memory"))?;
                self.jump(LOOP);
            }
        }
        Ok(())
    }

    /// Leaves this many bytes of the stack.
    pub fn fill_stack(&mut self, left: u32) -> Result<(), InjectError> {
        let end = self
            .symbol("_stack_end")
            .ok_or(InjectError::NoSymbol("_stack_end"))?;
        self.core_mut().set(Register::Sp, end + left);
        Ok(())
    }

    /// A jump to nowhere, and another one in the handler of its fault.
    pub fn lock_up(&mut self) {
        self.jump(NOWHERE);
        let end = self.now() + TASK_LIMIT;
        while self.running() != HARD_FAULT && self.now() < end {
            self.run_block();
        }
        self.jump(NOWHERE);
    }

    /// Calls a function; its arguments point at the vectors, which can be read.
    fn call(&mut self, function: u32) {
        for register in 0..4 {
            self.core_mut().set(Register::R(register), FLASH);
        }
        self.jump(function);
    }

    fn jump(&mut self, address: u32) {
        self.core_mut().set(Register::Pc, address & !1);
    }

    /// Exception that runs.
    pub fn running(&self) -> u16 {
        self.chip().shared.system.nvic.running()
    }

    /// Runs a block of instructions, or waits for what is due.
    fn run_block(&mut self) {
        self.run(self.now() + Time(1));
    }
}
