//! What the boards are wired to, in plain arithmetic: velocity-mode drives, gratings, slides.
//!
//! The emulated board steps a plant inside its axis facade, the host simulation and the tests step the same
//! one, so that all of them see the same machine to the bit. Rules as in `shared`: values in, values out, no
//! clock, no allocation, all mathematics through `libm`.
//!
//! Inside, lengths are mm and angles rad; the constants of the machine are written in mm and degrees.
#![no_std]

mod drive;
mod grating;
mod machines;
mod motion;
mod motor;
mod slides;

pub use drive::{Drive, DriveConfig};
pub use grating::{Grating, GratingConfig, GratingFault, Reading};
pub use motion::{DEFAULT_MACHINE, MotionPlant};
pub use slides::{Slide, SlideFault, SlidePlant};
