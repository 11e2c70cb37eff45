//! The world around a simulated machine: where its seam and its spots really are, and what its cameras see.
//!
//! Everything is looked up by the motion board's time, in what the boards told about that time; never by the
//! wall clock, never in the latest state. So the world is the same for emulated boards, which run in real
//! time, and for simulated ones, which do not.

mod clock;
mod geometric;
pub(crate) mod machine;
mod moment;
mod probe;
mod rendered;
pub(crate) mod seams;
mod surface;

pub use clock::BoardClocks;
pub use geometric::GeometricCameras;
pub use machine::Machine;
pub use moment::Moment;
pub use probe::SimulatedProbe;
pub use rendered::{
    Dark, Prospect, RenderedCamera, RenderedWorld, SceneError, SceneFile, Scratch, Surface as Texture, View,
    ViewForm,
};
pub use seams::{Crossing, TrueSeam, TrueSeams};
pub use surface::Surface;
