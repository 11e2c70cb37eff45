//! The ranging probe: from voltage and switches to a distance that can be relied on (mathematics 2, 2.1).

use crate::{RangeError, in_range};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Properties of a ranging probe with a linear analogue output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeConfig {
    /// Distance at 0 V \[mm\].
    pub distance_at_0v_mm: f64,
    /// Change of distance with voltage \[mm/V\]; negative if the voltage falls with distance.
    pub mm_per_volt: f64,
    /// Largest voltage to either side that is a distance \[V\].
    pub max_volts: f64,
    /// Readings of one distance that must remain when the outliers are gone. Take some more than these: of readings
    /// without a disturbance, a tenth falls out.
    pub least_readings: usize,
    /// A reading further from the median than this many times the median distance from it is an outlier.
    pub outlier_mad: f64,
}

impl Default for ProbeConfig {
    /// The published probe: 60…100 mm at −5…+5 V.
    fn default() -> Self {
        Self {
            distance_at_0v_mm: 80.0,
            mm_per_volt: 4.0,
            max_volts: 5.0,
            least_readings: 5,
            outlier_mad: 3.0,
        }
    }
}

/// One reading of a probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Analogue output \[V\].
    pub volts: f64,
    /// Switch: the light that comes back suffices.
    pub valid: bool,
    /// Switch: the surface is nearer than the range.
    pub near: bool,
    /// Switch: the surface is further than the range.
    pub far: bool,
}

/// Why a reading is no distance.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Refused {
    /// Too little light came back.
    #[error("the probe sees no surface: clean it, or tilt the probe towards its normal")]
    NotValid,
    /// Nearer than the range.
    #[error("the surface is too near: move the probe away")]
    Near,
    /// Further than the range.
    #[error("the surface is too far: move the probe nearer")]
    Far,
    /// Outside the probe's output, so that a wire or the converter is at fault.
    #[error("{volts} V is beyond the {max} V of the probe: check its wiring")]
    Volts {
        /// What was read.
        volts: f64,
        /// Largest to either side.
        max: f64,
    },
}

/// A distance from several readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranging {
    /// Mean of the readings used \[mm\].
    pub distance_mm: f64,
    /// Standard deviation of the readings used \[mm\]. Without the outliers it comes out a fifth below that of the
    /// probe; the roughness of the surface is not in it.
    pub scatter_mm: f64,
    /// Readings used.
    pub used: usize,
    /// Readings left out as outliers.
    pub outliers: usize,
    /// Readings that were refused.
    pub refused: usize,
}

/// Too few readings for a distance.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{used} of {taken} readings can be used, {least} are needed{}", reason(.refused))]
pub struct RangingError {
    /// Readings taken.
    pub taken: usize,
    /// Readings that are neither refused nor outliers.
    pub used: usize,
    /// Readings needed.
    pub least: usize,
    /// Why the first refused one was, if any was.
    pub refused: Option<Refused>,
}

fn reason(refused: &Option<Refused>) -> String {
    refused.map_or(String::new(), |refused| format!("; {refused}"))
}

/// A probe whose properties make sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe(ProbeConfig);

impl ProbeConfig {
    /// Checks the properties.
    pub fn build(&self) -> Result<Probe, RangeError> {
        let Self {
            distance_at_0v_mm,
            mm_per_volt,
            max_volts,
            least_readings,
            outlier_mad,
        } = *self;
        in_range("max_volts", max_volts, max_volts > 0.0, "above 0")?;
        in_range("mm_per_volt", mm_per_volt, mm_per_volt != 0.0, "other than 0")?;
        let least = mm_per_volt.abs() * max_volts;
        let ahead = "large enough that every voltage is a distance above 0";
        in_range(
            "distance_at_0v_mm",
            distance_at_0v_mm,
            distance_at_0v_mm > least,
            ahead,
        )?;
        // Fewer than three show neither scatter nor an outlier.
        in_range(
            "least_readings",
            least_readings as f64,
            least_readings >= 3,
            "3 or more",
        )?;
        in_range("outlier_mad", outlier_mad, outlier_mad >= 1.0, "1 or more")?;
        Ok(Probe(*self))
    }
}

impl Probe {
    /// The distance that one reading says \[mm\].
    pub fn distance_mm(&self, reading: &Reading) -> Result<f64, Refused> {
        let Reading {
            volts,
            valid,
            near,
            far,
        } = *reading;
        let max = self.0.max_volts;
        match () {
            () if near => Err(Refused::Near),
            () if far => Err(Refused::Far),
            () if !valid => Err(Refused::NotValid),
            () if volts.abs() <= max => Ok(self.0.distance_at_0v_mm + self.0.mm_per_volt * volts),
            () => Err(Refused::Volts { volts, max }),
        }
    }

    /// The least and the largest distance that it can show \[mm\].
    pub fn range_mm(&self) -> [f64; 2] {
        let reach = (self.0.mm_per_volt * self.0.max_volts).abs();
        [self.0.distance_at_0v_mm - reach, self.0.distance_at_0v_mm + reach]
    }

    /// The voltage at a distance \[V\], within the range or not.
    pub fn volts(&self, distance_mm: f64) -> f64 {
        (distance_mm - self.0.distance_at_0v_mm) / self.0.mm_per_volt
    }

    /// One distance from repeated readings of it: those refused are left out, then the outliers, the rest is
    /// averaged.
    pub fn range(&self, readings: &[Reading]) -> Result<Ranging, RangingError> {
        let (mut distances, mut refused) = (Vec::new(), Vec::new());
        for reading in readings {
            match self.distance_mm(reading) {
                Ok(distance) => distances.push(distance),
                Err(reason) => refused.push(reason),
            }
        }
        let accepted = distances.len();
        let centre = median(&mut distances.clone());
        let mad = median(&mut distances.iter().map(|d| (d - centre).abs()).collect::<Vec<_>>());
        distances.retain(|d| (d - centre).abs() <= self.0.outlier_mad * mad);
        let used = distances.len();
        if used < self.0.least_readings {
            return Err(RangingError {
                taken: readings.len(),
                used,
                least: self.0.least_readings,
                refused: refused.first().copied(),
            });
        }
        let mean = distances.iter().sum::<f64>() / used as f64;
        let squares: f64 = distances.iter().map(|d| (d - mean) * (d - mean)).sum();
        Ok(Ranging {
            distance_mm: mean,
            scatter_mm: libm::sqrt(squares / (used - 1) as f64),
            used,
            outliers: accepted - used,
            refused: refused.len(),
        })
    }
}

/// Median; 0 of no values.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}

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
    pub fn build(&self) -> Result<Probe, RangeError> {
        let output = self.output.build()?;
        let [near, far] = output.range_mm();
        let reference = self.reference_distance_mm;
        let inside = reference > near && reference < far;
        in_range(
            "reference_distance_mm",
            reference,
            inside,
            "inside the range of the probe",
        )?;
        let tilt = self.largest_tilt_deg;
        in_range(
            "largest_tilt_deg",
            tilt,
            tilt > 0.0 && tilt < 90.0,
            "above 0 and below 90",
        )?;
        in_range("settle_ms", self.settle_ms, self.settle_ms >= 0.0, "0 or more")?;
        let SimulatedProbeConfig {
            noise_mm,
            outlier_share,
        } = self.simulated;
        in_range("noise_mm", noise_mm, noise_mm >= 0.0, "0 or more")?;
        let share = (0.0..=1.0).contains(&outlier_share);
        in_range("outlier_share", outlier_share, share, "0 to 1")?;
        Ok(output)
    }
}
