//! What is known when cameras are asked for their answers.

use super::{Machine, TrueSeams};
use crate::record::MachinePosition;

/// The world as far as it is known at a time.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The machine.
    pub machine: &'a Machine,
    /// The seams as they really are.
    pub seams: &'a TrueSeams,
    /// Now, by the motion clock \[µs\].
    pub now_us: u64,
    /// Where the machine was at a time of the motion clock; `None` if that is not known (yet).
    pub position: &'a dyn Fn(u64) -> Option<MachinePosition>,
}
