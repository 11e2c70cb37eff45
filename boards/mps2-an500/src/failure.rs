//! The last things a board does: panic and hard fault.
//!
//! The simulated machine advances only when the firmware reads it, and its outputs are off from the moment
//! interrupts are: nothing more reaches the plant. Then the message is logged and QEMU ends with exit code
//! [`EXIT_CODE`], so that no failure passes for an orderly end.

use core::panic::PanicInfo;
use cortex_m_rt::{ExceptionFrame, exception};

/// Exit code of QEMU after a panic or a fault.
const EXIT_CODE: u32 = 101;

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    cortex_m::interrupt::disable();
    crate::logger::abandon();
    defmt::error!("{}", defmt::Display2Format(info));
    exit()
}

#[defmt::panic_handler]
fn defmt_panic() -> ! {
    // The message is logged already.
    cortex_m::interrupt::disable();
    exit()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    cortex_m::interrupt::disable();
    crate::logger::abandon();
    defmt::error!(
        "hard fault at {=u32:#010x}, called from {=u32:#010x}",
        frame.pc(),
        frame.lr()
    );
    exit()
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    panic!("interrupt {interrupt} has no handler");
}

fn exit() -> ! {
    /// "The application exited", with a code of its own.
    const APPLICATION_EXIT: u32 = 0x20026;
    let block = [APPLICATION_EXIT, EXIT_CODE];
    loop {
        // SAFETY: the semihosting call SYS_EXIT_EXTENDED reads the two words it is given and ends QEMU.
        unsafe {
            core::arch::asm!("bkpt 0xab", in("r0") 0x20, in("r1") block.as_ptr(), lateout("r0") _);
        }
    }
}
