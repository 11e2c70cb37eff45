//! Faults, for every board: what lies below the stack is made inaccessible, and the handler runs whatever became of
//! the stack.
//!
//! A stack that ran over is still the stack when the fault is entered: the processor's own pushes fail, which it bears
//! once, and the first push of a handler would lock it up. So the entry pushes nothing before it has given the
//! stack pointer its value after a reset. Nothing returns from there. On a host this crate is empty.
//!
//! The board defines `board_fault`, and the linker script (`memory.x`) makes all four fault vectors lead here.
#![cfg(target_os = "none")]
#![no_std]
// The processor's registers are reached here, by their names and addresses.
#![allow(unsafe_code)]

use core::arch::naked_asm;
use core::ptr::addr_of;
use cortex_m::peripheral::scb::Exception;
use cortex_m::peripheral::{MPU, SCB};

unsafe extern "C" {
    /// Lowest address of the guard; a whole multiple of its size, as the linker asserts.
    static _stack_guard: u8;
    /// End of the guard: lowest address of the stack.
    static _stack_end: u8;
}

unsafe extern "Rust" {
    /// The board's last act: outputs off, and no return. Any of the task's stack may be lost.
    safe fn board_fault(fault: &Fault) -> !;
}

/// What is known of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Number of the exception: 3 hard fault, 4 memory management.
    pub exception: u32,
    /// Where the fault struck, and the link register there; 0 if they could not be saved.
    pub at: u32,
    /// See [`Fault::at`].
    pub from: u32,
    /// Configurable fault status register.
    pub status: u32,
    /// Address of the access that memory protection refused, if the status says that it is valid.
    pub address: u32,
}

/// Refused: a push of the processor on entry to an exception, its late saving of floating-point registers, an access
/// whose address is known.
const STACKING: u32 = 1 << 4;
const LAZY_STACKING: u32 = 1 << 5;
const ADDRESS_VALID: u32 = 1 << 7;

impl Fault {
    /// Whether the stack overflowed.
    pub fn stack_overflow(&self) -> bool {
        let guard = addr_of!(_stack_guard) as u32..addr_of!(_stack_end) as u32;
        let in_guard = self.status & ADDRESS_VALID != 0 && guard.contains(&self.address);
        self.status & (STACKING | LAZY_STACKING) != 0 || in_guard
    }
}

/// Region that exists, and refuses all accesses and all execution.
const NO_ACCESS: u32 = 1 << 28 | 1;
/// Memory protection on, all that no region names as without it; off while a hard fault is handled.
const PROTECT: u32 = 1 << 2 | 1;

/// Makes what lies below the stack inaccessible. First thing of a board: from here on a stack that runs over is a
/// fault of its own, at the access that does it.
pub fn guard_stack(core: &mut cortex_m::Peripherals) {
    protect(&mut core.MPU);
    core.SCB.enable(Exception::MemoryManagement);
}

fn protect(mpu: &mut MPU) {
    let (begin, end) = (addr_of!(_stack_guard) as u32, addr_of!(_stack_end) as u32);
    let size = (end - begin).trailing_zeros() - 1;
    // SAFETY: no object lies in the region.
    unsafe {
        mpu.rnr.write(0);
        mpu.rbar.write(begin);
        mpu.rasr.write(NO_ACCESS | size << 1);
        mpu.ctrl.write(PROTECT);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Floating-point context control register; its lowest bit says that registers are still to be saved.
const CONTEXT_CONTROL: u32 = 0xe000_ef34;

/// Entry of every fault. The saved program counter and link register are fetched if the processor's frame
/// lies in the stack; the stack starts again; and floating-point registers that are still to be saved into
/// the old one are given up.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        "cpsid i",
        "mrs r0, ipsr",
        "mov r12, sp",
        "movs r1, #0",
        "movs r2, #0",
        "movw r3, #:lower16:_stack_end",
        "movt r3, #:upper16:_stack_end",
        "cmp r12, r3",
        "movw r3, #:lower16:_stack_start",
        "movt r3, #:upper16:_stack_start",
        "mov sp, r3",
        "blo 1f",
        "sub r3, r3, #32",
        "cmp r12, r3",
        "bhi 1f",
        "ldr r1, [r12, #24]",
        "ldr r2, [r12, #20]",
        "1:",
        "movw r3, #({context_control} & 0xffff)",
        "movt r3, #({context_control} >> 16)",
        "ldr r12, [r3]",
        "bic r12, r12, #1",
        "str r12, [r3]",
        "b {entered}",
        context_control = const CONTEXT_CONTROL,
        entered = sym entered,
    )
}

extern "C" fn entered(exception: u32, at: u32, from: u32) -> ! {
    // SAFETY: the registers are read, by the only code that runs.
    let scb = unsafe { &*SCB::PTR };
    board_fault(&Fault {
        exception,
        at,
        from,
        status: scb.cfsr.read(),
        address: scb.mmfar.read(),
    })
}
