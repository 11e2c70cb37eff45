//! Simulated machines and what is around them: boards with plants, where seams and spots really are, what cameras and
//! probes see.
//!
//! Everything around a machine is looked up by the motion board's time, in what the boards reported for that
//! time; never by the wall clock, never in the latest state. So the world is the same for emulated boards,
//! which run in real time, and for simulated ones, which do not.

mod boards;
pub mod deviation;
pub mod emulated;
mod followed;
mod geometric;
mod marks;
mod mounts;
mod probe;
mod rendered;
mod seams;
pub mod simulated;
mod surroundings;
#[cfg(test)]
mod tests;
mod true_machine;

pub use boards::BoardChoice;
pub use deviation::{Deviation, SeamError, check_seam};
pub use emulated::BoardsError;
pub use followed::{NotFollowed, not_followed};
pub use geometric::GeometricCameras;
use mounts::Mounted;
pub use probe::SimulatedProbe;
pub use rendered::{
    Dark, Direction, DirtSpot, FieldOfView, Grooves, JointStretch, Plate, Plates, RenderedCamera,
    RenderedPictures, RenderedWorld, SceneError, SceneFile, Scratch, SensorFile, Standpoint, StrayLight,
    SurfaceFinish, TackStretch, View, ViewForm,
};
pub use seams::{Crossing, SharedSeams, TrueSeam, TrueSeams};
pub use surroundings::{CameraChoice, DrawingError, PictureChoice, Surroundings, Workpiece, World};
pub use true_machine::TrueMachine;
