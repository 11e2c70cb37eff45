//! The parameters of a machine file one by one: listed with what the file says beside them, and replaced in its text, of which
//! everything else stays as it is, to the letter.
//!
//! What a value may be is known to the reader of the file alone ([`MachineFile::parse`](crate::machine::MachineFile::parse)); it
//! is asked.

mod change;
mod edit;
mod list;
mod range;
mod shipped;
mod unit;

pub use change::{Change, changes, is_same};
pub use edit::{EditError, replace};
pub use list::{Kind, Parameter, Table, list};
pub use range::{Range, is_about, ranges};
pub use shipped::{shipped, shipped_values};

#[cfg(test)]
mod tests;
