//! The parameters of a machine file one by one: listed with what the file says beside them, and replaced in its text, of which
//! everything else stays as it is, to the letter.
//!
//! What a value may be is known to the reader of the file alone ([`MachineFile::parse`](crate::machine::MachineFile::parse)); it
//! is asked.

mod change;
mod edit;
mod insert;
mod list;
mod range;
mod shipped;
mod unit;

pub use change::{Change, changes, differing, is_same};
pub use edit::{EditError, replace};
pub use insert::{copy, insert, insert_written, remove};
pub use list::{Kind, Parameter, Table, list, list_elements};
pub use range::{Range, is_about, ranges};
pub use shipped::{shipped, shipped_values};
pub use unit::unit;

#[cfg(test)]
mod tests;
