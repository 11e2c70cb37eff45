//! What the boards are wired to, in plain arithmetic: velocity-mode drives, gratings, slides.
//!
//! The emulated board steps a plant inside its axis facade, the host simulation and the tests step the same
//! one, so that all of them see the same machine to the bit. Rules as in `shared`: values in, values out, no
//! clock, no allocation, all mathematics through `libm`.
//!
//! Inside, lengths are mm and angles rad; plant files are written in mm and degrees.
#![no_std]

mod beam;
mod chain;
mod config;
mod drive;
mod geometry;
mod grating;
mod motion;
mod motor;
mod noise;
mod slides;
mod touch;

pub use chain::TrueChain;
pub use config::{
    AngularError, AngularErrors, BODIES, BeamConfig, BodyConfig, DriveConfig, ERRORS, EnvironmentConfig,
    GeometryConfig, GratingConfig, Growth, LONGEST, MODES, MechanicsConfig, ModeConfig, MotorConfig,
    PlantConfig, SlideConfig, TouchConfig, Wave,
};
pub use drive::{Drive, Outside};
pub use grating::{Grating, GratingFault, Reading};
pub use motion::MotionPlant;
pub use noise::Noise;
pub use slides::{Slide, SlideFault, SlidePlant};
