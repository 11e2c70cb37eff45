//! Teaching both seams at the feet of a rib with the cameras of the welding heads (mathematics 0.4, 0.7).
//!
//! The machine stands still while the cameras look. The slides of each side search its seam and bring it to the middle
//! of its band, and the place of both seams is taken down in the world. Then the machine goes on along the tangent of
//! what it has seen so far, farther where the seams are straight, to where the slides will stand near their middle.
//!
//! Nothing here knows boards or pictures: the machine is a [`Rig`].

mod centring;
mod config;
mod course;
mod drawing;
mod file;
mod follow;
mod jog;
mod not_found;
mod rig;
mod search;
#[cfg(test)]
mod tests;

pub use centring::{Cameras, Stance};
pub use config::SeamTeaching;
pub use course::{Foot, SeamPoint};
pub use drawing::Drawing;
pub use file::{Head, Opened, SeamFile, SeamFileError, parse_seam_points, read_seam_points};
pub use follow::{Ended, Follower, SeamTeachError};
pub use jog::{Hand, JOG_WORDS, Jog};
pub use not_found::NotFound;
pub use rig::{Rig, SeamSighting, View};
