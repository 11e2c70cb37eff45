//! The emulated board: QEMU's `mps2-an500`, a Cortex-M7 with double-precision FPU and Ethernet.
//!
//! Its public names are those of every board crate, so the firmware does not know which it runs on. Behind
//! the axes and slides runs the plant: reading them advances the simulated machine by one tick. Time is
//! instructions executed (see the `emulator` crate), so the idle loop spins instead of sleeping.
//!
//! On a host this crate is empty.
#![cfg(target_os = "none")]
#![no_std]
// Registers and vectors are reached here and nowhere else.
#![allow(unsafe_code)]

use board_memcpy as _;

pub mod benchmark;
pub mod device;
mod failure;
mod logger;
mod machine;
pub mod motion;
mod network;
mod registers;
mod semihosting;
mod tick;
mod time;
pub mod tracker;
mod vectors;
mod watchdog;

pub use network::Network;
pub use tick::Tick;
pub use time::{CYCLES_PER_US, cycles, now_us};
pub use watchdog::Watchdog;

/// Name of the board, as reported to the PC.
pub const NAME: &str = "mps2-an500";
/// The machine behind the axes is simulated on the board.
pub const SIMULATED_MACHINE: bool = true;
/// A permit of the tracker board is valid for so long \[µs\]: twice as long as on real boards. Between two emulated
/// boards a datagram takes the time of the computer that they run on, which is not theirs: seldom 3 ms on a busy one.
pub const PERMIT_US: u32 = 10_000;

/// One turn of the idle loop. It spins, because time advances by instructions only; a long straight run costs
/// the host less than a short loop.
pub fn idle() {
    // SAFETY: 64 instructions that do nothing.
    unsafe {
        core::arch::asm!(
            ".rept 64",
            "nop",
            ".endr",
            options(nomem, nostack, preserves_flags)
        )
    }
}
