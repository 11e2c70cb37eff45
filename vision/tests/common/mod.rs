//! The camera of the tests.

use vision::{Detector, Optics, PhotonTransfer, Profile};

/// 400 × 300 pixels of 3.45 µm.
pub const OPTICS: Optics = Optics {
    magnification: 4.0,
    pixel_mm: 0.0138,
    tilt_rad: std::f64::consts::FRAC_PI_4,
    aperture: 0.10,
    wavelength_mm: 0.00055,
    rows: 300,
    columns: 400,
};

/// Its noise.
pub const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

/// A detector for it.
pub fn detector() -> Detector {
    Detector::new(OPTICS, NOISE, Profile::expected(&OPTICS)).expect("a detector")
}
