//! The vector table: which interrupt goes to which handler.

use crate::device::Interrupt;
use crate::watchdog::expired;

unsafe extern "C" {
    fn DefaultHandler();
    fn SOFT_0();
    fn SOFT_1();
    fn SERVO_TICK();
    fn PATH_TICK();
    fn ETHERNET();
}

const VECTORS: [unsafe extern "C" fn(); 32] = {
    let mut vectors = [DefaultHandler as unsafe extern "C" fn(); 32];
    vectors[Interrupt::SOFT_0 as usize] = SOFT_0;
    vectors[Interrupt::SOFT_1 as usize] = SOFT_1;
    vectors[Interrupt::SERVO_TICK as usize] = SERVO_TICK;
    vectors[Interrupt::PATH_TICK as usize] = PATH_TICK;
    vectors[Interrupt::WATCHDOG as usize] = expired;
    vectors[Interrupt::ETHERNET as usize] = ETHERNET;
    vectors
};

/// Vector table behind the core's own exceptions.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 32] = VECTORS;
