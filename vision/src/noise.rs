//! Noise of the camera.

use crate::layer::Layer;
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

/// Variance of a pixel of a layer, in the layer's own steps: `slope` · level + `offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerNoise {
    slope: f32,
    offset: f32,
}

impl LayerNoise {
    /// That of `transfer` in the pixels of `layer`.
    pub fn new(transfer: &PhotonTransfer, layer: &Layer) -> Self {
        let scale = f64::from(layer.scale);
        // The mean of `binned` pixels.
        let offset = transfer.variance(0.0) / layer.binned;
        let slope = transfer.variance(1.0) / layer.binned - offset;
        Self {
            slope: (slope / scale) as f32,
            offset: (offset / scale / scale) as f32,
        }
    }

    /// Variance of a pixel whose mean is `level`.
    pub fn variance(&self, level: f32) -> f32 {
        level * self.slope + self.offset
    }
}
