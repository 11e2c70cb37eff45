//! The screen without a window, on simulated boards that run as fast as they can.

mod access;
mod bench;
mod browser;
mod cameras;
mod chromium;
mod commission;
mod day;
mod keyboard;
mod parameters;
mod pictures;
mod set_up;
mod sets;
mod teach;
mod viewers;
mod watching;
mod whole_day;
#[cfg(target_os = "linux")]
mod window;
mod work_offsets;
