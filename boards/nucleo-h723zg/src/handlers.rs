//! When the firmware fails: outputs off with a few stores, then still until the watchdog resets the board.
//!
//! No formatting, no locks, no SPI: nothing here may fail in its turn.

use crate::outputs;
use core::panic::PanicInfo;
use cortex_m_rt::exception;
use embassy_stm32::pac::IWDG1;
use embassy_stm32::pac::iwdg::vals::Key;

/// Switches everything off and never returns. The watchdog is started in case it does not run yet.
fn stop() -> ! {
    cortex_m::interrupt::disable();
    outputs::kill();
    IWDG1.kr().write(|w| w.set_key(Key::START));
    loop {
        // A debugger finds the reason on the stack; the empty loop must stay.
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    stop()
}

#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    stop()
}

/// Any exception or interrupt that nothing handles.
#[exception]
unsafe fn DefaultHandler(_: i16) -> ! {
    stop()
}
