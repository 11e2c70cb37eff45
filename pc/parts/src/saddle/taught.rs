//! The seam from points taught with the tip of the torch.

use super::error::{SaddlePartError, TaughtError};
use super::fit::{Fit, Known, fit};
use super::pipes::PipePair;
use super::seam::Seam;
use config::table::{self, TableError};
use nalgebra::Vector3;
use shared::io::AXES;
use shared::kinematics::{AXIS_UNIT, Kinematics};
use shared::units::DEG_PER_RAD;
use std::path::Path;

const COLUMNS: [&str; 4] = ["X_mm", "Z_mm", "B_deg", "C_deg"];
/// Slots of the columns.
const SLOTS: [usize; 4] = [0, 2, 4, 5];

/// A point as it was taught.
struct Taught {
    line: usize,
    tip: Vector3<f64>,
}

/// The seam by the points in `file`, as far as it is not `known`, and what a person should know of it. No point
/// may lie further than `within` \[mm\] off it, and it must be sure to as much.
pub(super) fn seam(
    file: &Path,
    kinematics: &Kinematics,
    known: &Known,
    within: f64,
) -> anyhow::Result<(Seam, Vec<String>)> {
    let points = read(file, kinematics)?;
    let tips: Vec<_> = points.iter().map(|point| point.tip).collect();
    let fit = fit(&tips, known)?;
    let count = points.len() as f64;
    let rms_mm = libm::sqrt(fit.distances.iter().map(|d| d * d).sum::<f64>() / count);
    let distances = points.iter().zip(&fit.distances);
    let (worst, worst_mm) = distances
        .max_by(|a, b| a.1.total_cmp(b.1))
        .ok_or(TaughtError::NoSaddle)?;
    if *worst_mm > within {
        let radii = tips.iter().map(|tip| tip.xy().norm());
        return Err(TaughtError::Poor {
            line: worst.line,
            worst_mm: *worst_mm,
            rms_mm,
            outside_mm: radii.sum::<f64>() / count - fit.branch_radius,
            within_mm: within,
        }
        .into());
    }
    fit.check_sure(within)?;
    let pair = PipePair::new(fit.main_radius, fit.branch_radius, fit.angle, fit.offset)
        .map_err(SaddlePartError::of_pipes)?;
    let seam = Seam::new(pair, fit.offset, fit.placement)?;
    let mut notes = vec![format!(
        "{} taught points lie within {worst_mm:.3} mm of the saddle, rms {rms_mm:.3} mm; the farthest is in line {}",
        points.len(),
        worst.line
    )];
    notes.extend(fit.notes());
    Ok((seam, notes))
}

/// Where the tip was at every point of `file`.
fn read(file: &Path, kinematics: &Kinematics) -> Result<Vec<Taught>, TableError> {
    let rows = table::parse(&file.display().to_string(), &table::read(file)?, COLUMNS)?;
    let taught = rows.iter().map(|row| {
        let mut axes = [0.0; AXES];
        for (slot, value) in SLOTS.into_iter().zip(row.values) {
            axes[slot] = value * AXIS_UNIT[slot];
        }
        Taught {
            line: row.line,
            tip: kinematics.forward(&axes).position,
        }
    });
    Ok(taught.collect())
}

impl Fit {
    fn notes(&self) -> [String; 2] {
        let value = |name: &str, value: f64, sure: f64, unit: &str| {
            if sure == 0.0 {
                format!("{name} {value:.3}{unit} as given")
            } else {
                format!("{name} {value:.3} ± {sure:.3}{unit}")
            }
        };
        let [lift, turn, offset, angle, main, branch] = self.sure;
        let values = [
            value("offset", self.offset, offset, " mm"),
            value("angle", self.angle * DEG_PER_RAD, angle * DEG_PER_RAD, "°"),
            value("main pipe", 2.0 * self.main_radius, 2.0 * main, " mm"),
            value("branch", 2.0 * self.branch_radius, 2.0 * branch, " mm"),
            value("clamped at Z", self.placement.lift, lift, " mm"),
            value(
                "turned by",
                self.placement.turn * DEG_PER_RAD,
                turn * DEG_PER_RAD,
                "°",
            ),
        ];
        [
            format!("fitted: {} (±: two standard deviations)", values.join(", ")),
            format!(
                "the position of the seam is known to ±{:.3} mm everywhere",
                self.seam_sure
            ),
        ]
    }
}
