//! The operator's screen: what a job does, live, and what an operator may ask of it.
//!
//! The screen is one more client of [`host_link::control`]: it sends [`host_link::Command`]s and subscribes to events, as the
//! terminal does, and has no other way to a board. It never delays a job: what it is too slow for is dropped by its subscription.
//!
//! - [`loaded`]: a program that was read, planned and predicted for a machine, before anything moves.
//! - [`running`]: its job, on a thread of its own.
//! - [`commissioning`]: motors while they are commissioned.
//! - [`parameters`]: the machine file while its parameters are changed.
//! - [`sets`]: tools and weld data while they are changed.
//! - [`edited`]: what both are: the text of a file that is edited.
//! - [`records`]: reports of past jobs, read back.
//! - [`teaching`]: places of the tip that are being taught, for a part.
//! - [`access`]: who may do what.
//! - [`record`]: what happened, in a file that outlives the screen.
//! - [`settings`]: how the screen looks, and its PINs, in a file.
//! - [`connection`]: that of a screen that watches another one.
//! - [`serving`]: what this one serves to viewers.
//! - `sockets`: what both need.
//! - [`station`]: what is loaded, the job that runs, and what may be asked of it now.
//! - [`screen`]: the pages. They read the station and ask it for what the operator wants.
//!
//! What is seen, and the pages that only show it, are [`view`]'s.

pub mod access;
pub mod commissioning;
pub mod connection;
pub mod edited;
pub mod loaded;
pub mod parameters;
pub mod record;
pub mod records;
pub mod running;
pub mod screen;
pub mod serving;
pub mod sets;
pub mod settings;
mod sockets;
pub mod station;
pub mod teaching;

pub use view::{drawn, live, seen, texts, viewing};
