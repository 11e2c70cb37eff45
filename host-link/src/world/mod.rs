//! The world around a simulated machine: where its seam and its spots really are, and what its cameras see.
//!
//! Everything is looked up by the motion board's time, in what the boards told about that time; never by the
//! wall clock, never in the latest state. So the world is the same for emulated boards, which run in real
//! time, and for simulated ones, which do not.

mod camera;
mod clock;
mod noise;
mod probe;
mod surface;
pub(crate) mod truth;

pub use camera::{Cameras, Sight};
pub use clock::BoardClocks;
pub use noise::SplitMix64;
pub use probe::SimulatedProbe;
pub use surface::Surface;
pub use truth::{Crossing, Machine, TrueSeam};
