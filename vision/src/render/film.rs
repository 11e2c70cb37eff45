//! What lies between the work and the picture: veil, glare, dirt on the window, and a sensor other than calibrated.

use super::random::{of_place, unit};
use crate::noise::PhotonTransfer;

/// Light that does not come from the work, and dirt on the window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Share of full scale that lies over everything: stray light, smoke.
    pub veil: f64,
    /// Bright places: a reflected lamp, the glow of the plume.
    pub glares: Vec<Glare>,
    /// Spots on the window: far out of focus, they stay where they are in the picture.
    pub dirt: Vec<Dirt>,
}

/// A round brightness in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glare {
    /// Its middle, −1…1 across columns and rows.
    pub middle: [f64; 2],
    /// Its standard deviation on that scale.
    pub radius: f64,
    /// Share of full scale in its middle.
    pub level: f64,
}

/// A round spot that takes light from the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dirt {
    /// Its middle, −1…1 across columns and rows.
    pub middle: [f64; 2],
    /// Its standard deviation on that scale.
    pub radius: f64,
    /// What it multiplies the light by in its middle.
    pub factor: f64,
}

/// A sensor other than the camera's calibration says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Its electrons, in place of those that are calibrated.
    pub noise: Option<PhotonTransfer>,
    /// Standard deviation of the pixels' gain, fixed from picture to picture.
    pub pattern: f64,
    /// Which pattern.
    pub seed: u64,
}

impl Film {
    /// Whether there is nothing.
    pub fn is_clear(&self) -> bool {
        self.veil == 0.0 && self.glares.is_empty() && self.dirt.is_empty()
    }

    /// What becomes of the light at `x`, `y` (−1…1 across columns and rows).
    pub(super) fn through(&self, light: f64, x: f64, y: f64) -> f64 {
        let bell =
            |middle: [f64; 2], radius: f64| fading(x, middle[0], radius) * fading(y, middle[1], radius);
        let clear: f64 = self
            .dirt
            .iter()
            .map(|dirt| 1.0 + (dirt.factor - 1.0) * bell(dirt.middle, dirt.radius))
            .product();
        let glare: f64 = self
            .glares
            .iter()
            .map(|glare| glare.level * bell(glare.middle, glare.radius))
            .sum();
        light * clear + self.veil + glare
    }
}

/// A Gaussian of height 1.
pub(super) fn fading(x: f64, middle: f64, radius: f64) -> f64 {
    (-((x - middle) / radius).powi(2) / 2.0).exp()
}

impl Sensor {
    /// Gain of a pixel.
    pub(super) fn gain(&self, pixel: usize) -> f64 {
        let bits = of_place(self.seed, pixel, 0);
        // The sum of four even numbers is close to normal.
        let sum: f64 = (0..4).map(|k| unit((bits >> (16 * k)) << 48)).sum();
        1.0 + self.pattern * (sum - 2.0) * 3f64.sqrt()
    }
}
