//! Teaching both seams at the feet of a rib with the cameras of the welding heads (SPEC 0.4, 0.7).
//!
//! The machine stands still while the cameras look. The pose brings both seams to the middle of their bands, the V
//! slides take what no pose can, and the place of both seams is taken down in the world. Then the machine goes on
//! along the tangent of what it has seen so far, farther where the seam is straight.
//!
//! Nothing here knows boards or pictures: the machine is a [`Rig`].

mod centring;
mod config;
mod course;
mod drawing;
mod file;
mod follow;
mod jog;
mod rig;
mod search;
#[cfg(test)]
mod tests;

pub use centring::{Cameras, Stance};
pub use config::SeamTeaching;
pub use course::{Foot, SeamPoint};
pub use drawing::Drawing;
pub use file::{Head, Opened, SeamFile, SeamFileError, read_seam_points};
pub use follow::{Ended, Follower, SeamTeachError};
pub use jog::{Hand, JOG_WORDS, Jog};
pub use rig::{Rig, Seen, View};
