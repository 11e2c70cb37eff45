//! A simulated ranging probe in front of the true surface of a panel.

use config::probe::{Probe, ProbeUnit, Reading};
use job::RangingProbe;
use parts::CurvedPanel;
use shared::geometry::{Pose, angle};
use vision::render::SplitMix64;

/// Largest false distance of an outlier \[mm\].
const OUTLIER: f64 = 2.0;

/// A simulated ranging probe in the nozzle's place.
#[derive(Clone, Debug)]
pub struct SimulatedProbe {
    surface: CurvedPanel,
    output: Probe,
    unit: ProbeUnit,
    noise: SplitMix64,
}

impl SimulatedProbe {
    /// A probe with the properties of `unit` in front of `surface`; `output` turns its distances into voltages,
    /// `seed` starts its noise.
    pub fn new(surface: CurvedPanel, output: Probe, unit: &ProbeUnit, seed: u64) -> Self {
        Self {
            surface,
            output,
            unit: *unit,
            noise: SplitMix64::new(seed),
        }
    }
}

impl RangingProbe for SimulatedProbe {
    /// One reading where the tool truly is.
    fn read(&mut self, tool: &Pose) -> Reading {
        let silent = Reading {
            volts: 0.0,
            valid: false,
            near: false,
            far: false,
        };
        let lens = tool.position + tool.normal * self.unit.reference_distance_mm;
        let Some((distance, normal)) = self.surface.hit(&lens, &-tool.normal) else {
            return Reading { far: true, ..silent };
        };
        if angle(&normal, &tool.normal) > self.unit.largest_tilt_deg.to_radians() {
            return silent;
        }
        let simulated = &self.unit.simulated;
        let mut seen = distance + simulated.noise_mm * self.noise.gauss()[0];
        if self.noise.uniform() < simulated.outlier_share {
            seen += OUTLIER * (2.0 * self.noise.uniform() - 1.0);
        }
        let [nearest, furthest] = self.output.range_mm();
        Reading {
            volts: self.output.volts(seen.clamp(nearest, furthest)),
            valid: true,
            near: distance < nearest,
            far: distance > furthest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use config::machine::MachineFile;
    use config::probe::Refused;
    use nalgebra::Vector3;

    fn probe() -> (SimulatedProbe, Probe) {
        let text = include_str!("../../../machines/ac-head.toml");
        let unit = MachineFile::parse("ac-head.toml", text).unwrap().probe.unwrap();
        let surface = toml::from_str(
            "crown_mm = [0.0, 0.0, 0.0]\nsize_mm = [100.0, 100.0]\nradius_mm = [400.0, 400.0]\n",
        )
        .unwrap();
        let output = unit.output.build().unwrap();
        (SimulatedProbe::new(surface, output, &unit, 7), output)
    }

    fn tool(z: f64, lean: f64) -> Pose {
        Pose::new(
            Vector3::new(0.0, 0.0, z),
            Vector3::x(),
            Vector3::new(0.0, lean, 1.0),
        )
        .unwrap()
    }

    /// 4000 readings: mean within four standard errors, scatter within 5 %.
    #[test]
    fn readings_scatter_about_the_distance() {
        let (mut probe, output) = probe();
        probe.unit.simulated.outlier_share = 0.0;
        let off: Vec<f64> = (0..4000)
            .map(|_| output.distance_mm(&probe.read(&tool(2.5, 0.0))).unwrap() - 82.5)
            .collect();
        let mean = off.iter().sum::<f64>() / 4000.0;
        let deviation = (off.iter().map(|d| d * d).sum::<f64>() / 4000.0).sqrt();
        assert!(mean.abs() < 4.0 * 0.02 / 4000f64.sqrt(), "{mean}");
        assert!((deviation / 0.02 - 1.0).abs() < 0.05, "{deviation}");
    }

    #[test]
    fn outliers_are_there_and_thrown_out() {
        let (mut probe, output) = probe();
        probe.unit.simulated.outlier_share = 0.2;
        let readings: Vec<Reading> = (0..40).map(|_| probe.read(&tool(0.0, 0.0))).collect();
        let ranging = output.range(&readings).unwrap();
        assert!(ranging.outliers > 2, "{ranging:?}");
        assert!((ranging.distance_mm - 80.0).abs() < 0.02, "{ranging:?}");
    }

    #[test]
    fn too_near_too_far_past_the_edge_and_too_steep_are_told() {
        let (mut probe, output) = probe();
        let mut refused = |tool: &Pose| output.distance_mm(&probe.read(tool)).unwrap_err();
        assert_eq!(refused(&tool(-21.0, 0.0)), Refused::Near);
        assert_eq!(refused(&tool(21.0, 0.0)), Refused::Far);
        assert_eq!(refused(&tool(0.0, 3.0)), Refused::NotValid);
        let mut beside = tool(0.0, 0.0);
        beside.position.x = 51.0;
        assert_eq!(refused(&beside), Refused::Far);
    }
}
