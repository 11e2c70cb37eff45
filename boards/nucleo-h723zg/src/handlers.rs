//! When the firmware fails: outputs off with a few stores, then still until the watchdog resets the board.
//!
//! No formatting, no locks, no SPI: nothing here may fail in its turn. Why it happened is left in memory that a
//! reset does not clear, and logged at the next start.

use crate::{outputs, watchdog};
use board_faults::Fault;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m_rt::exception;
use embassy_stm32::pac::RCC;

/// Words that tell a record from what memory holds at power-up.
const PANIC: u32 = 0x70616e69;
const FAULT: u32 = 0x66617568;
const STACK: u32 = 0x73746163;
const SUPPLY: u32 = 0x73757070;
const CLOCK: u32 = 0x636c6f63;
const UNHANDLED: u32 = 0x756e6861;

/// The last failure.
#[repr(C, align(8))]
struct Failure {
    kind: AtomicU32,
    /// Line of a panic, place of a fault, number of an exception.
    detail: AtomicU32,
    /// The memory keeps the last word written in a buffer that a reset loses: this one may be lost.
    flush: AtomicU32,
}

#[unsafe(link_section = ".uninit.failure")]
static FAILURE: MaybeUninit<Failure> = MaybeUninit::uninit();

fn failure() -> &'static Failure {
    // SAFETY: any bits are valid in an atomic word.
    unsafe { FAILURE.assume_init_ref() }
}

/// Logs why the board was reset, if it had failed.
pub(crate) fn report_last() {
    let last = failure();
    let detail = last.detail.load(Ordering::Relaxed);
    match last.kind.swap(0, Ordering::Relaxed) {
        PANIC => defmt::error!("the last run ended in a panic, at line {} of its file", detail),
        FAULT => defmt::error!("the last run ended in a fault at {=u32:#010x}", detail),
        STACK => defmt::error!(
            "the last run ended when the stack overflowed, at {=u32:#010x}",
            detail
        ),
        SUPPLY => {
            defmt::error!("the last run ended when the supply fell below 2.85 V: check the board's 3.3 V")
        }
        CLOCK => defmt::error!("the last run ended when the clock from the ST-LINK failed"),
        UNHANDLED => defmt::error!(
            "the last run ended in exception {} without handler",
            detail as i32
        ),
        _ if RCC.rsr().read().iwdg1rstf() => defmt::error!("the watchdog was not fed: a task had stopped"),
        _ => {}
    }
    RCC.rsr().modify(|w| w.set_rmvf(true));
}

/// Switches everything off and never returns.
fn stop(kind: u32, detail: u32) -> ! {
    cortex_m::interrupt::disable();
    outputs::kill();
    let record = failure();
    record.kind.store(kind, Ordering::Relaxed);
    record.detail.store(detail, Ordering::Relaxed);
    record.flush.store(0, Ordering::Relaxed);
    watchdog::ensure_running();
    loop {
        cortex_m::asm::nop();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    stop(PANIC, info.location().map_or(0, |location| location.line()))
}

/// Entered from `board_faults`, on a stack that starts again.
#[unsafe(no_mangle)]
extern "Rust" fn board_fault(fault: &Fault) -> ! {
    stop(if fault.stack_overflow() { STACK } else { FAULT }, fault.at)
}

/// The voltage detector, see `supply`.
#[unsafe(no_mangle)]
unsafe extern "C" fn PVD_AVD() -> ! {
    stop(SUPPLY, 0)
}

/// The clock security system, see `supply`. Nothing else raises it.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    stop(CLOCK, 0)
}

/// Any exception or interrupt that nothing handles.
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    stop(UNHANDLED, number as u32)
}
