//! Noise of the camera.

use serde::{Deserialize, Serialize};

/// Photon transfer of a camera that gives 8 bits a pixel, as its calibration measured it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhotonTransfer {
    /// Electrons of a pixel of the picture at 255; binning has it collect more.
    pub full_well: f64,
    /// Read noise of such a pixel, standard deviation in electrons.
    pub read_noise: f64,
}

impl PhotonTransfer {
    /// Variance of a pixel whose mean is `level` \[steps of 8 bits, squared\]: photons, reading, rounding.
    pub fn variance(&self, level: f64) -> f64 {
        let step = 255.0 / self.full_well;
        level * step + (self.read_noise * step).powi(2) + 1.0 / 12.0
    }
}
