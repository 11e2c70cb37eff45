//! The real board: NUCLEO-H723ZG (STM32H723ZG), wired as `docs/wiring.md` says, one for each firmware.
//!
//! Its public names are those of every board crate, so the firmware does not know which it runs on. All
//! registers, and all `unsafe`, are here. **Compiled for, never yet flashed.**
//!
//! What is wired where stands in [`pins`] as data: the same tables set the pins up here and are checked on the
//! host against the manufacturer's own description of the chip. On a host nothing else of this crate exists but the
//! arithmetic in [`counting`] and [`schedule`], the bound on the converters' bus in [`exchange`], and the constants of
//! [`reset`].
#![cfg_attr(target_os = "none", no_std)]
// Registers, vectors and fault handlers are reached here and nowhere else.
#![cfg_attr(target_os = "none", allow(unsafe_code))]

#[cfg(target_os = "none")]
use board_memcpy as _;

pub mod counting;
pub mod exchange;
pub mod pins;
pub mod reset;
pub mod schedule;

#[cfg(target_os = "none")]
mod bring_up;
#[cfg(target_os = "none")]
mod clocks;
#[cfg(target_os = "none")]
pub mod device;
#[cfg(target_os = "none")]
mod encoders;
#[cfg(target_os = "none")]
mod ethernet;
#[cfg(target_os = "none")]
mod gpio;
#[cfg(target_os = "none")]
mod handlers;
#[cfg(target_os = "none")]
mod inputs;
#[cfg(target_os = "none")]
pub mod motion;
#[cfg(target_os = "none")]
mod outputs;
#[cfg(target_os = "none")]
mod phy;
#[cfg(target_os = "none")]
mod spi;
#[cfg(target_os = "none")]
mod supply;
#[cfg(target_os = "none")]
mod ticks;
#[cfg(target_os = "none")]
mod timebase;
#[cfg(target_os = "none")]
pub mod tracker;
#[cfg(target_os = "none")]
mod watchdog;

#[cfg(target_os = "none")]
pub use {
    ethernet::Network,
    ticks::Tick,
    timebase::{CYCLES_PER_US, cycles, now_us},
    watchdog::Watchdog,
};

/// Name of the board, as reported to the PC.
pub const NAME: &str = "nucleo-h723zg";
/// A real machine hangs on the axes.
pub const SIMULATED_MACHINE: bool = false;
/// A permit of the tracker board is valid for so long \[µs\].
pub const PERMIT_US: u32 = 5000;

/// One turn of the idle loop: sleeps until the next interrupt.
#[cfg(target_os = "none")]
pub fn idle() {
    cortex_m::asm::wfi();
}
