//! The last things a board does: panic and hard fault.
//!
//! The simulated machine advances only when the firmware reads it, and its outputs are off from the moment
//! interrupts are: nothing more reaches the plant. Then the message is logged and QEMU ends with exit code
//! [`EXIT_CODE`], so that no failure passes for an orderly end.

use crate::semihosting::{exit, say};
use board_faults::Fault;
use core::panic::PanicInfo;
use cortex_m_rt::exception;

/// Exit code of QEMU after a panic or a fault.
const EXIT_CODE: usize = 101;

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    crate::logger::abandon();
    defmt::error!("{}", defmt::Display2Format(info));
    exit(EXIT_CODE)
}

#[defmt::panic_handler]
fn defmt_panic() -> ! {
    // The message is logged already.
    cortex_m::interrupt::disable();
    exit(EXIT_CODE)
}

/// Entered from `board_faults`, on a stack that starts again.
#[unsafe(no_mangle)]
extern "Rust" fn board_fault(fault: &Fault) -> ! {
    crate::logger::abandon();
    if fault.stack_overflow() {
        // To the console too, which programs without a logger have.
        say("the stack overflowed\n");
        defmt::error!("the stack overflowed");
    }
    defmt::error!(
        "hard fault at {=u32:#010x}, called from {=u32:#010x}",
        fault.at,
        fault.from
    );
    exit(EXIT_CODE)
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    panic!("interrupt {interrupt} has no handler");
}
