//! Which radius the ring should have: halved until the normal is good enough (mathematics 2.3, 2.4).
//!
//! Two things turn the normal of a ring. Noise turns it by σ/(√2·S): small rings are bad. Third order of the
//! surface turns it by b·S²: large rings are bad. The change of the normal from S to S/2 is ¾·b·S² and noise,
//! so two rings show how much of each there is. [`StopRule::Balance`] measures on until the expected error
//! grows, and keeps the ring where it was least. The published rule, [`StopRule::Spread`], waits for its
//! three triangles to agree; noise alone spreads them by 2σ/S, so halving may make it worse for ever.

use crate::ring::{NEIGHBOURS, Ring, RingError, Unsmooth};
use config::{RangeError, in_range};
use serde::{Deserialize, Serialize};
use shared::geometry::angle;
use std::error::Error as StdError;
use thiserror::Error;

/// When to be content with a ring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopRule {
    /// When half the radius would add more noise than it takes away error of shape.
    #[default]
    Balance,
    /// When the normals of three triangles agree, as published.
    Spread,
}

/// How to find the radius of a ring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalvingConfig {
    /// Radius of the first ring \[mm\].
    pub start_radius_mm: f64,
    /// No ring is smaller \[mm\].
    pub smallest_radius_mm: f64,
    /// Largest error of the normal that is taught: expected error or spread, as the rule has it \[deg\].
    pub limit_deg: f64,
    /// Standard deviation of one height: noise of the averaged ranging, and roughness \[mm\].
    pub noise_mm: f64,
    /// When to be content.
    #[serde(default)]
    pub rule: StopRule,
}

impl Default for HalvingConfig {
    /// From 8 mm down to 1 mm, 0.5°, five readings of a probe with 0.02 mm noise on a surface of Ra 12.5 µm.
    fn default() -> Self {
        Self {
            start_radius_mm: 8.0,
            smallest_radius_mm: 1.0,
            limit_deg: 0.5,
            noise_mm: 0.015,
            rule: StopRule::Balance,
        }
    }
}

/// How to find the radius of a ring, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halving {
    start: f64,
    smallest: f64,
    limit: f64,
    noise: f64,
    rule: StopRule,
}

/// The ring found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taught {
    /// The ring to take the normal from.
    pub ring: Ring,
    /// Rings measured.
    pub rings: usize,
    /// What the rule compares with its limit \[rad\]: the expected error of the least-squares normal (rms, right
    /// within a third), or the spread of the three triangles.
    pub error: f64,
    /// That it is within the limit. If not, no ring down to the smallest was good enough.
    pub ok: bool,
    /// What is uneven in the ring, if anything is.
    pub unsmooth: Option<Unsmooth>,
}

/// Why there is no ring.
#[derive(Debug, Error)]
pub enum HalvingError<E: StdError + 'static> {
    /// It could not be measured.
    #[error("ring of {radius} mm: {source}")]
    Measure {
        /// Radius \[mm\].
        radius: f64,
        /// Why.
        source: E,
    },
    /// What was measured is no ring.
    #[error(transparent)]
    Ring(#[from] RingError),
}

impl HalvingConfig {
    /// Checks the values.
    pub fn build(&self) -> Result<Halving, RangeError> {
        let (start, smallest) = (self.start_radius_mm, self.smallest_radius_mm);
        in_range("smallest_radius_mm", smallest, smallest > 0.0, "above 0")?;
        match self.rule {
            StopRule::Balance => {
                let requirement = "at least twice the smallest radius: two rings are compared";
                in_range("start_radius_mm", start, start >= 2.0 * smallest, requirement)?;
            }
            StopRule::Spread => {
                in_range(
                    "start_radius_mm",
                    start,
                    start >= smallest,
                    "the smallest radius or more",
                )?;
            }
        }
        in_range("limit_deg", self.limit_deg, self.limit_deg > 0.0, "above 0")?;
        in_range("noise_mm", self.noise_mm, self.noise_mm >= 0.0, "0 or more")?;
        Ok(Halving {
            start,
            smallest,
            limit: self.limit_deg.to_radians(),
            noise: self.noise_mm,
            rule: self.rule,
        })
    }
}

impl Halving {
    /// Measures rings until one is good enough. `measure` is asked for the heights \[mm\] over the centre of a ring
    /// of a radius \[mm\], in the order of [`Ring::new`]; its error ends the search.
    pub fn run<E: StdError + 'static>(
        &self,
        mut measure: impl FnMut(f64) -> Result<[f64; NEIGHBOURS], E>,
    ) -> Result<Taught, HalvingError<E>> {
        let mut rings = 0;
        let mut ring = |radius| -> Result<Ring, HalvingError<E>> {
            rings += 1;
            let heights = measure(radius).map_err(|source| HalvingError::Measure { radius, source })?;
            Ok(Ring::new(radius, heights)?)
        };
        let (ring, error) = match self.rule {
            StopRule::Balance => self.balance(&mut ring)?,
            StopRule::Spread => self.spread(&mut ring)?,
        };
        Ok(Taught {
            ring,
            rings,
            error,
            ok: error <= self.limit,
            unsmooth: ring.unsmooth(self.noise, self.limit),
        })
    }

    /// Halves until the three triangles agree; gives the ring and their spread.
    fn spread<E>(&self, ring: &mut impl FnMut(f64) -> Result<Ring, E>) -> Result<(Ring, f64), E> {
        let mut seen = ring(self.start)?;
        loop {
            let spread = seen.triples().spread;
            if spread <= self.limit || seen.radius() / 2.0 < self.smallest {
                return Ok((seen, spread));
            }
            seen = ring(seen.radius() / 2.0)?;
        }
    }

    /// Halves while that makes the expected error less; gives the ring where it is least, and that error.
    fn balance<E>(&self, ring: &mut impl FnMut(f64) -> Result<Ring, E>) -> Result<(Ring, f64), E> {
        let mut large = ring(self.start)?;
        loop {
            let small = ring(large.radius() / 2.0)?;
            let shape = self.change_by_shape(&large, &small);
            // What the change says of the error: 4/3 of it at S, 1/3 at S/2, 1/12 at S/4.
            let error = |ring: &Ring, part: f64| libm::hypot(ring.normal_noise(self.noise), part * shape);
            let (at_large, at_small) = (error(&large, 4.0 / 3.0), error(&small, 1.0 / 3.0));
            if at_large <= at_small {
                return Ok((large, at_large));
            }
            let next = libm::hypot(2.0 * small.normal_noise(self.noise), shape / 12.0);
            if next >= at_small || small.radius() / 2.0 < self.smallest {
                return Ok((small, at_small));
            }
            large = small;
        }
    }

    /// Change of the normal between two rings \[rad\], less what their noise explains.
    fn change_by_shape(&self, large: &Ring, small: &Ring) -> f64 {
        let change = angle(&large.normal(), &small.normal());
        let noise = libm::hypot(large.normal_noise(self.noise), small.normal_noise(self.noise));
        libm::sqrt((change * change - noise * noise).max(0.0))
    }
}
