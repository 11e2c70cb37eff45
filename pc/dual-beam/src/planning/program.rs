//! The NC program of a planned weld: approach, run-in, seam, run-out, retract.

use super::{CLEARANCE, DualBeamPlan, PlanError, PlanOptions, PlannedPoint, moved};
use config::machine::MachineFile;
use nc::text::{NcText, decimal, tip_words};
use shared::io::AXES;
use shared::kinematics::Kinematics;
use shared::units::DEG_PER_RAD;

/// Power 2 follows the speed on seam 2 where that differs by more from the speed on seam 1 (mathematics 0.5).
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
        let mut nc = begun(machine, &options.title, options.speed_m_min);
        approach(&mut nc, &self.points, machine, &kinematics)?;
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
            }
            for (beam, (on, _)) in self.beams.iter().enumerate() {
                if left == *on {
                    nc.block(&format!("M62 P{beam}"));
                }
            }
            let wanted = options.power_w[1] * power_factor(point.speed_ratio);
            let on_seam = (self.seam.0..self.seam.1).contains(&left);
            if on_seam && (wanted - power_2).abs() > POWER_STEP * options.power_w[1] {
                power_2 = wanted;
                nc.block(&format!("M67 E1 Q{}", decimal(power_2, 1)));
            }
            if left == self.seam.1 {
                nc.comment("run-out");
            }
            for (beam, (_, off)) in self.beams.iter().enumerate() {
                if left == *off {
                    nc.block(&format!("M63 P{beam}"));
                }
            }
            // The slides stay on the seam until the beams are surely off.
            if left == self.seam.1 + 1 {
                nc.block("M63 P2");
            }
            nc.block(&format!("G1 {}", words(point, &kinematics)?));
        }
        Ok(retracted(nc, machine))
    }

    /// The program of a pass on which the cameras see the whole seam: beams and tracking off, the tip a lead behind.
    pub fn measuring_program(
        &self,
        machine: &MachineFile,
        title: &str,
        speed_m_min: f64,
    ) -> Result<String, PlanError> {
        let kinematics = machine.motion.kinematics()?;
        let unit = machine.tracking.as_ref().ok_or(PlanError::NoTracking)?;
        let lead = unit.board.head.camera_lead_mm;
        let (first, last) = self.seam;
        // The runs are straight, and of one point at least.
        let seen = first.saturating_sub(1)..=(last + 1).min(self.points.len() - 1);
        let points: Vec<PlannedPoint> = self.points[seen].iter().map(|p| moved(p, -lead)).collect();
        let mut nc = begun(machine, title, speed_m_min);
        approach(&mut nc, &points, machine, &kinematics)?;
        nc.comment("measuring heads: beams off, the cameras pass along the seam");
        nc.block(&format!("F{}", decimal(speed_m_min * 1000.0, 1)));
        for point in &points[1..] {
            nc.block(&format!("G1 {}", words(point, &kinematics)?));
        }
        Ok(retracted(nc, machine))
    }
}

/// Words of a point.
fn words(point: &PlannedPoint, kinematics: &Kinematics) -> Result<String, PlanError> {
    let angles = angles(point, kinematics)?;
    Ok(tip_words(&point.pose.position.into(), &angles, &point.extension))
}

/// A B C of a point \[deg\].
fn angles(point: &PlannedPoint, kinematics: &Kinematics) -> Result<[f64; 3], PlanError> {
    let q = kinematics.inverse(&point.pose, &[0.0; AXES])?;
    Ok([q[3], q[4], q[5]].map(|a| a * DEG_PER_RAD))
}

/// A program up to its approach.
fn begun(machine: &MachineFile, title: &str, speed_m_min: f64) -> NcText {
    let mut nc = NcText::default();
    nc.line("%");
    nc.comment(title);
    nc.comment(&format!("machine {}, {speed_m_min} m/min", machine.name));
    nc.comment("X Y Z: tip [mm], A B C: head [deg], V1 V2: slides that keep the defocus [mm]");
    nc.block("G21 G17 G90 G94 G40 G500 G64");
    nc.block("G43.4");
    nc
}

/// From above to the first of the `points`, which are all well below the safe height.
fn approach(
    nc: &mut NcText,
    points: &[PlannedPoint],
    machine: &MachineFile,
    kinematics: &Kinematics,
) -> Result<(), PlanError> {
    let safe_mm = machine.planning.safe_height_mm;
    let heights = points.iter().map(|p| p.pose.position.z);
    let top_mm = heights.fold(f64::NEG_INFINITY, f64::max);
    if safe_mm < top_mm + CLEARANCE {
        return Err(PlanError::SafeHeight { safe_mm, top_mm });
    }
    let start = &points[0];
    let position = start.pose.position;
    let above = [position.x, position.y, safe_mm];
    let above = tip_words(&above, &angles(start, kinematics)?, &start.extension);
    nc.comment("approach");
    nc.block(&format!("G0 {above}"));
    nc.block(&format!("G0 Z{}", decimal(position.z, 5)));
    Ok(())
}

/// A program with its end: back up.
fn retracted(mut nc: NcText, machine: &MachineFile) -> String {
    nc.comment("retract");
    nc.block(&format!("G0 Z{}", decimal(machine.planning.safe_height_mm, 5)));
    nc.block("M2");
    nc.line("%");
    nc.finish()
}
