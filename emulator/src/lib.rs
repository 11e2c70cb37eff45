//! Boots the two firmwares on emulated boards, waits until both answer, and ends them again.
//!
//! Each board is a QEMU process of its own with user-mode networking: its ports are forwarded to free ports
//! of the loopback interface, and it reaches the other board through its gateway. The pace plugin keeps both
//! on one clock. No privileges are needed, and no board outlives [`Boards`] or the thread that booted it.
//!
//! A board's log is in the binary form of defmt: `defmt-print -e FIRMWARE < motion.defmt` shows it.

mod boot;
mod hello;
mod pace;
mod qemu;
mod qmp;
mod session;

pub use boot::{BOOT_VARIABLES, Boards, BootError, Options, PROGRAM_VARIABLES};
pub use pace::{BoardTime, Pace};
pub use qemu::{INSTRUCTIONS_PER_US, bound_to_parent};
pub use qmp::Meddling;
pub use session::{
    Endpoint, JOB_VARIABLE, MACHINE_VARIABLE, PathStatesTo, SEAM_VARIABLE, SESSION_VARIABLE, Session,
    SessionError,
};
