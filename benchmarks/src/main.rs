//! The program that is counted: on the PC under callgrind, on the emulated board by its timer.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;
#[cfg(not(target_os = "none"))]
mod host;

#[cfg(not(target_os = "none"))]
fn main() -> anyhow::Result<()> {
    host::run()
}
