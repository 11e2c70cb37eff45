//! Boots the two firmwares on emulated boards, waits until both answer, and ends them again.
//!
//! Each board is a QEMU process of its own with user-mode networking: its ports are forwarded to free ports
//! of the loopback interface, and it reaches the other board through its gateway. The pace plugin keeps both
//! on one clock. No privileges are needed, and no board outlives [`Boards`] or the thread that booted it.
//!
//! A board's log is in the binary form of defmt: `defmt-print -e FIRMWARE < motion.defmt` shows it.
//!
//! Boards are emulated on Linux only. On other systems this crate has the session file and the names of the environment
//! variables, so that the PC's programs build everywhere.

#[cfg(target_os = "linux")]
mod boot;
#[cfg(target_os = "linux")]
mod hello;
#[cfg(target_os = "linux")]
mod monitor;
#[cfg(target_os = "linux")]
mod pace;
#[cfg(target_os = "linux")]
mod qemu;
mod session;

#[cfg(target_os = "linux")]
pub use boot::{BOOT_VARIABLES, Boards, BootError, Options, PROGRAM_VARIABLES};
#[cfg(target_os = "linux")]
pub use monitor::BoardAction;
#[cfg(target_os = "linux")]
pub use pace::{BoardTime, Pace};
#[cfg(target_os = "linux")]
pub use qemu::{INSTRUCTIONS_PER_US, bound_to_parent};
pub use session::{
    Endpoint, JOB_VARIABLE, MACHINE_VARIABLE, PLANT_VARIABLE, PathStatesTo, SEAM_VARIABLE, SESSION_VARIABLE,
    Session, SessionError,
};
