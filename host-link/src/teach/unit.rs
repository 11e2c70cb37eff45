//! The probe of a machine: how it is mounted, and what it would be in a simulated world.

use super::{Probe, ProbeConfig, TeachParameterError, check};
use serde::Deserialize;

/// A ranging probe in the nozzle's place, its beam along the axis of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeUnit {
    /// Distance that it shows when the focus is on the surface \[mm\].
    pub reference_distance_mm: f64,
    /// No light comes back from a surface that is inclined further against the beam \[deg\].
    pub largest_tilt_deg: f64,
    /// Time the axes get to come to rest before a reading \[ms\].
    pub settle_ms: f64,
    /// Its output.
    pub output: ProbeConfig,
    /// What it is in a simulated world.
    pub simulated: SimulatedProbeConfig,
}

/// A probe in a simulated world.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulatedProbeConfig {
    /// Standard deviation of one reading \[mm\].
    pub noise_mm: f64,
    /// Part of the readings that are nonsense, 0…1.
    pub outlier_share: f64,
}

impl ProbeUnit {
    /// Checks the properties and gives the probe's output.
    pub fn build(&self) -> Result<Probe, TeachParameterError> {
        let output = self.output.build()?;
        let [near, far] = output.range_mm();
        let reference = self.reference_distance_mm;
        let inside = reference > near && reference < far;
        check(
            "reference_distance_mm",
            reference,
            inside,
            "inside the range of the probe",
        )?;
        let tilt = self.largest_tilt_deg;
        check(
            "largest_tilt_deg",
            tilt,
            tilt > 0.0 && tilt < 90.0,
            "above 0 and below 90",
        )?;
        check("settle_ms", self.settle_ms, self.settle_ms >= 0.0, "0 or more")?;
        let SimulatedProbeConfig {
            noise_mm,
            outlier_share,
        } = self.simulated;
        check("noise_mm", noise_mm, noise_mm >= 0.0, "0 or more")?;
        let share = (0.0..=1.0).contains(&outlier_share);
        check("outlier_share", outlier_share, share, "0 to 1")?;
        Ok(output)
    }
}
