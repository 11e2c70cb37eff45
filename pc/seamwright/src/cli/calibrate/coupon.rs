//! What lies before simulated cameras that are calibrated.

use clap::Args;
use std::path::PathBuf;
use world::{Deviation, PictureChoice};

/// A coupon before rendered cameras.
#[derive(Debug, Args)]
pub struct Coupon {
    /// Deviation of the seams, or of a plate in their place, of a simulated world (CSV) [default: none, a straight coupon]
    #[arg(long, value_name = "FILE")]
    pub seam: Option<PathBuf>,
    /// What the work of a simulated world looks like (TOML) [default: ground plates]
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Start of the noise of simulated cameras
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl Coupon {
    /// How it deviates from the drawing; real cameras see what is there.
    pub fn deviation(&self, source: &PictureChoice) -> anyhow::Result<Option<Deviation>> {
        Ok(match (&self.seam, source) {
            (Some(file), _) => Some(Deviation::read(file)?),
            (None, PictureChoice::Rendered(_)) => Some(Deviation::straight()),
            (None, PictureChoice::Real(_)) => None,
        })
    }
}
