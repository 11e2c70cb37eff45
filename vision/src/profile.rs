//! What is left of the texture's energy out of focus.

use crate::optics::Optics;
use serde::{Deserialize, Serialize};

/// Width of the profile at 3.45 µm object pixels and an aperture of 0.10 \[mm\].
const WIDTH_MM: f64 = 0.09;

/// That object pixel \[mm\] and aperture.
const REFERENCE: (f64, f64) = (0.00345, 0.10);

/// How the width grows with the object pixel: 0.09, 0.125 at 3.45 and 6.9 µm.
const GROWTH: f64 = 0.474;

/// How much wider it is on the picture of half the resolution.
const HALVED: f64 = 1.5;

/// The energy at a depth z off the focal plane is T = (1 + x²)^(−3/2) of that in it, x = z / s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// s in the picture at its full resolution, not finer than 2.4 µm \[mm\].
    pub fine_mm: f64,
    /// s in the picture of half that resolution \[mm\].
    pub coarse_mm: f64,
}

impl Profile {
    /// What a lens without faults has; calibration by stepping through focus measures it.
    pub fn expected(optics: &Optics) -> Self {
        let pitch = optics.object_pixel_mm() * optics.binning() as f64;
        let growth = (pitch / REFERENCE.0).powf(GROWTH);
        let fine_mm = WIDTH_MM * growth * REFERENCE.1 / optics.aperture;
        Self {
            fine_mm,
            coarse_mm: HALVED * fine_mm,
        }
    }
}
