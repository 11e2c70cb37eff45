//! The measurement of pictures: what a picture costs, and how far it is off. On the PC only.

pub mod accuracy;
mod corners;
pub mod cost;
pub mod effect_runs;
pub mod effects;
mod figures;
mod groups;
mod limits;
pub mod photographs;
mod seeds;

use vision::{Optics, PhotonTransfer};

/// Noise of the cameras.
const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

/// Samples a pixel of the truth: centres then are off by 0.1 µm from those of seven, heights by 0.2 µm.
const SAMPLES: usize = 2;

/// A camera of 1.38 × 1.04 mm that many pixels wide; three quarters as many high.
fn camera(columns: usize) -> Optics {
    Optics {
        magnification: 4.0,
        pixel_mm: 5.52 / columns as f64,
        tilt_rad: std::f64::consts::FRAC_PI_4,
        aperture: 0.10,
        wavelength_mm: 0.00055,
        rows: columns * 3 / 4,
        columns,
    }
}
