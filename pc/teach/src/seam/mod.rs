//! Teaching both seams at the feet of a rib with the cameras of the welding heads (mathematics 0.4, 0.7).
//!
//! The machine stands still while the cameras look. The slides of each side search its seam and bring it to
//! the middle of its band, and the place of both seams is taken down in the world. Then the machine continues
//! along the tangent of what it has seen so far, farther where the seams are straight, to where the slides
//! will stand near their middle. Where a seam begins after its drawing, or ends before it, the machine comes back to where
//! the pictures show its end.
//!
//! Nothing here knows boards or pictures: the machine is a [`CameraMachine`].

mod camera_machine;
mod centring;
mod config;
mod course;
mod drawing;
mod ends;
mod file;
mod follow;
mod jog;
mod not_found;
mod search;
#[cfg(test)]
mod tests;

pub use camera_machine::{CameraMachine, EndSighting, SeamSighting, View};
pub use centring::{Cameras, MachinePose};
pub use config::SeamTeaching;
pub use course::{MeasuredSeam, SeamEnd, SeamPoint};
pub use drawing::Drawing;
pub use file::{Head, Opened, SeamFile, SeamFileError, parse_seam_points, read_seam_points};
pub use follow::{Ended, Follower, SeamTeachError};
pub use jog::{JOG_WORDS, Jog, JogOperator};
pub use not_found::NotFound;
