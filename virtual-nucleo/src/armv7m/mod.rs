//! Exceptions, the system timer and the other registers of the core itself (Armv7-M Architecture Reference Manual,
//! DDI 0403).

mod exceptions;
mod mpu;
mod nvic;
mod system;
mod systick;

pub use exceptions::{HasSystem, LockUp, fault, leave, reset, take};
pub use nvic::{FIRST_INTERRUPT, HARD_FAULT, NMI, Nvic, SYSTICK};
pub use system::{ResetRequested, System};
