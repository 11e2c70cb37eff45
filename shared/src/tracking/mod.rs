//! Following the seam: from captures to the velocity of the slides.

mod config;
mod fault;

pub use config::{HeadConfig, SlideConfig, TrackerConfig, TrackingConfig};
pub use fault::{TrackerFault, TrackerState};
