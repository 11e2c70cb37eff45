//! defmt over UART 0. QEMU takes a byte as fast as it is written, so a message is sent while interrupts are
//! off: some hundred instructions.

use crate::registers::Block;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::{interrupt, register::primask};

const DATA: usize = 0x0;
const CONTROL: usize = 0x8;
const BAUD_DIVIDER: usize = 0x10;
const TX_ENABLE: u32 = 1;

/// Switches the UART on. Messages before it are lost.
pub fn start() {
    Block::UART0.write(BAUD_DIVIDER, 16);
    Block::UART0.write(CONTROL, TX_ENABLE);
}

/// Forgets a message that a failure interrupted, so that the failure can be logged.
pub fn abandon() {
    TAKEN.store(false, Ordering::Relaxed);
}

#[defmt::global_logger]
struct Logger;

static TAKEN: AtomicBool = AtomicBool::new(false);
static ENABLE_AFTER: AtomicBool = AtomicBool::new(false);

struct Encoder(UnsafeCell<defmt::Encoder>);
// SAFETY: used only between `acquire` and `release`, with interrupts off on a single core.
unsafe impl Sync for Encoder {}
static ENCODER: Encoder = Encoder(UnsafeCell::new(defmt::Encoder::new()));

fn send(bytes: &[u8]) {
    for byte in bytes {
        Block::UART0.write(DATA, u32::from(*byte));
    }
}

// SAFETY: interrupts are off from `acquire` to `release`; a second `acquire` within them panics.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let enabled = primask::read().is_active();
        interrupt::disable();
        assert!(!TAKEN.swap(true, Ordering::Relaxed), "logged while logging");
        ENABLE_AFTER.store(enabled, Ordering::Relaxed);
        // SAFETY: this is the only user now.
        unsafe { (*ENCODER.0.get()).start_frame(send) }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: called after `acquire`, by its caller.
        unsafe { (*ENCODER.0.get()).end_frame(send) }
        TAKEN.store(false, Ordering::Relaxed);
        if ENABLE_AFTER.load(Ordering::Relaxed) {
            // SAFETY: they were enabled when the message began.
            unsafe { interrupt::enable() }
        }
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: called between `acquire` and `release`, by their caller.
        unsafe { (*ENCODER.0.get()).write(bytes, send) }
    }
}

defmt::timestamp!("{=u64:us}", crate::time::now_us());
