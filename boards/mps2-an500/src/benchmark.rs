//! What a benchmark has of this board in place of a machine: command line and files of the emulator's host, a
//! console, a clock, and an end.

pub use crate::semihosting::{COMMAND_LINE, command_line, exit, read_file};
pub use crate::time::{TICK_NS, now_ticks};

use crate::semihosting::say;
use crate::time;
use core::fmt;

/// Guards the stack and starts the timebase, as a firmware's board does. Done once.
pub fn start() {
    if let Some(mut core) = cortex_m::Peripherals::take() {
        board_faults::guard_stack(&mut core);
    }
    time::start();
}

/// The console of QEMU.
pub struct Console;

impl fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        say(text);
        Ok(())
    }
}
