//! How a PC speaks with the boards of a machine, and how a job on them is driven and watched.
//!
//! - [`boards`]: connections to a motion board and a tracker board. [`boards::Boards`] is what jobs are written against; it is
//!   implemented for boards in a network here, and for simulated ones elsewhere.
//! - [`control`]: the two ends of a job's control. The owner of a [`Remote`] sends [`Command`]s and subscribes to
//!   [`events`]; the job has the [`Control`].
//! - [`record`], [`clock`], [`geometry`]: what the boards told by tick, how their clocks are related, and where the tool was
//!   by it.
//! - [`spool`]: sequences that are too long for memory, as records are.
//!
//! A job runs on a thread of its own; any number of others watch it:
//!
//! ```
//! use host_link::events::{Event, Interest, Phase};
//! use host_link::{Command, control};
//!
//! let (remote, mut control) = control();
//! let events = remote.subscribe(Interest::Milestones, 100);
//! let job = std::thread::spawn(move || {
//!     // A job would move a machine here; it takes commands between two turns, and publishes events.
//!     while control.order() != Some(Command::Resume) {}
//!     control.publish(Event::Phase(Phase::Welding));
//! });
//! remote.send(Command::Resume)?;
//! for received in events {
//!     println!("{:?}, {} events lost before it", received.event, received.lost);
//! }
//! # job.join().unwrap();
//! # Ok::<(), host_link::CommandError>(())
//! ```
//!
//! The examples `drive_weld` and `watch_weld` of the crate `seamwright` do that with a weld on simulated boards.

pub mod boards;
mod by_hand;
pub mod clock;
mod control;
pub mod events;
pub mod geometry;
pub mod record;
pub mod spool;

pub use by_hand::{ByHand, Jog, JogWay};
pub use control::{Command, CommandError, Control, Remote, control};
