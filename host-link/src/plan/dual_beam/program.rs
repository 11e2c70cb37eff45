//! The NC program of a planned weld: approach, run-in, seam, run-out, retract.

use super::{CLEARANCE, DualBeamPlan, PlanError, PlanOptions, PlannedPoint};
use crate::machine::MachineFile;
use crate::plan::text::{NcText, decimal, tip_words};
use nalgebra::Vector3;
use shared::io::AXES;
use shared::units::DEG_PER_RAD;

/// Power 2 follows the speed on seam 2 where that differs by more from the speed on seam 1 (SPEC 0.5).
const SPEED_TOLERANCE: f64 = 0.02;
/// Smallest change of power 2 that is programmed, as part of it.
const POWER_STEP: f64 = 0.01;

/// By how much power 2 must be scaled, so that seam 2 gets the energy per length of seam 1.
fn power_factor(speed_ratio: f64) -> f64 {
    if (speed_ratio - 1.0).abs() > SPEED_TOLERANCE {
        speed_ratio
    } else {
        1.0
    }
}

impl DualBeamPlan {
    pub(super) fn write(&self, machine: &MachineFile, options: &PlanOptions) -> Result<String, PlanError> {
        let kinematics = machine.motion.kinematics()?;
        let words = |point: &PlannedPoint| -> Result<(Vector3<f64>, [f64; 3], String), PlanError> {
            let q = kinematics.inverse(&point.pose, &[0.0; AXES])?;
            let angles = [q[3], q[4], q[5]].map(|a| a * DEG_PER_RAD);
            let position = point.pose.position;
            let text = tip_words(&position.into(), &angles, &point.extension);
            Ok((position, angles, text))
        };
        let safe = machine.planning.safe_height_mm;
        let top = self
            .points
            .iter()
            .map(|p| p.pose.position.z)
            .fold(f64::NEG_INFINITY, f64::max);
        if safe < top + CLEARANCE {
            let (safe_mm, top_mm) = (safe, top);
            return Err(PlanError::SafeHeight { safe_mm, top_mm });
        }
        let start = &self.points[0];
        let (position, angles, _) = words(start)?;
        let above = tip_words(&[position.x, position.y, safe], &angles, &start.extension);

        let mut nc = NcText::default();
        nc.line("%");
        nc.comment(&options.title);
        nc.comment(&format!(
            "machine {}, {} m/min",
            machine.name, options.speed_m_min
        ));
        nc.comment("X Y Z: tip [mm], A B C: head [deg], V1 V2: slides that keep the defocus [mm]");
        nc.block("G21 G17 G90 G94 G40 G54 G64");
        nc.block("G43.4");
        nc.comment("approach");
        nc.block(&format!("G0 {above}"));
        nc.block(&format!("G0 Z{}", decimal(position.z, 5)));
        nc.block(&format!("M67 E0 Q{}", decimal(options.power_w[0], 1)));
        nc.block(&format!("M67 E1 Q{}", decimal(options.power_w[1], 1)));
        nc.comment("run-in");
        nc.block(&format!("F{}", decimal(options.speed_m_min * 1000.0, 1)));
        let mut power_2 = options.power_w[1];
        for (index, point) in self.points.iter().enumerate().skip(1) {
            // Outputs change at the start of the motion that leaves the point before.
            let left = index - 1;
            if left == self.tracking {
                nc.block("M62 P2");
            }
            if left == self.seam.0 {
                nc.comment("seam");
                nc.block("M62 P0");
                nc.block("M62 P1");
            }
            let wanted = options.power_w[1] * power_factor(point.speed_ratio);
            let on_seam = (self.seam.0..self.seam.1).contains(&left);
            if on_seam && (wanted - power_2).abs() > POWER_STEP * options.power_w[1] {
                power_2 = wanted;
                nc.block(&format!("M67 E1 Q{}", decimal(power_2, 1)));
            }
            if left == self.seam.1 {
                nc.comment("run-out");
                nc.block("M63 P0");
                nc.block("M63 P1");
            }
            // The slides stay on the seam until the beams are surely off.
            if left == self.seam.1 + 1 {
                nc.block("M63 P2");
            }
            nc.block(&format!("G1 {}", words(point)?.2));
        }
        nc.comment("retract");
        nc.block(&format!("G0 Z{}", decimal(safe, 5)));
        nc.block("M2");
        nc.line("%");
        Ok(nc.finish())
    }
}
