//! Excitation of one motor, at rest or on a way there and back, and capture of its answer (mathematics 0.10).
//!
//! The path tick checks what is asked for ([`order`]) and keeps the samples ([`capture`]); the servo ticks add the chirp
//! ([`run`]) for as long as every order says so.

mod capture;
mod chirp;
mod order;
mod run;
mod way;

pub(super) use capture::Capturing;
pub use chirp::Chirp;
pub(super) use order::{ExcitationOrder, Limits};
pub(super) use run::{Added, ExcitationReport, Exciting};
pub use way::Way;
