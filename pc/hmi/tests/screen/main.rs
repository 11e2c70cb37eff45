//! The screen without a window, on simulated boards that run as fast as they can.

mod bench;
mod day;
mod parameters;
mod pictures;
#[cfg(target_os = "linux")]
mod window;
