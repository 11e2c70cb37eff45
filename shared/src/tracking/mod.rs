//! Following the seam: from captures to the velocity of the slides.

pub mod clock;
mod config;
mod fault;
pub mod frames;
pub mod gain;
pub mod history;
pub mod law;
pub mod map;

pub use config::{HeadConfig, SlideConfig, TrackerConfig, TrackingConfig};
pub use fault::{TrackerFault, TrackerState};
