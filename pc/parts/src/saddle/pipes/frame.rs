//! Directions of the groove between the walls, and the coordinates of a pipe welder (mathematics 1.2, 1.3).

use super::{PipePair, SaddleError};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// A point where the walls meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamPoint {
    /// The point in M \[mm\].
    pub main: Vector3<f64>,
    /// The same in S \[mm\].
    pub branch: Vector3<f64>,
    /// Outward unit normal NA of the branch wall, in M.
    pub branch_normal: Vector3<f64>,
    /// Outward unit normal NB of the main wall, in M.
    pub main_normal: Vector3<f64>,
}

/// The groove at a point of the seam; directions are unit vectors in M.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamFrame {
    /// Along the seam, NB×NA: increasing θ on the plus sheet, decreasing on the minus sheet.
    pub tangent: Vector3<f64>,
    /// l_A: across the seam up the branch wall, outside the main pipe.
    pub branch_wall: Vector3<f64>,
    /// l_B: across the seam along the main wall, outside the branch.
    pub main_wall: Vector3<f64>,
    /// Groove (dihedral) angle ψ between the walls \[rad\].
    pub groove: f64,
    /// Torch axis, from the seam to the torch, in the middle between the walls.
    pub torch: Vector3<f64>,
}

impl SeamFrame {
    /// Work angle α between torch and each wall \[rad\].
    pub fn work_angle(&self) -> f64 {
        self.groove / 2.0
    }
}

/// Coordinates of a welder that turns about the branch axis (mathematics 1.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineCoordinates {
    /// Waist θ \[rad\], in [0, 2π).
    pub waist: f64,
    /// Radial ρ \[mm\].
    pub radial: f64,
    /// Axial z_S \[mm\].
    pub axial: f64,
    /// Elevation of the torch above the radial direction, in the plane of waist and branch axis \[rad\].
    pub elevation: f64,
    /// Angle of the torch out of that plane, towards growing θ \[rad\]: four axes cannot reach it.
    pub out_of_plane: f64,
}

impl SeamPoint {
    /// θ \[rad\], in [0, 2π).
    pub fn theta(&self) -> f64 {
        let theta = libm::atan2(self.branch.y, self.branch.x);
        if theta < 0.0 { theta + TAU } else { theta }
    }

    /// The groove here.
    pub fn frame(&self) -> Result<SeamFrame, SaddleError> {
        let (na, nb) = (&self.branch_normal, &self.main_normal);
        let along = nb.cross(na);
        let sine = along.norm();
        if sine < 1e-9 {
            return Err(SaddleError::TangentPipes { x: self.main.x });
        }
        let tangent = along / sine;
        let between = na + nb;
        Ok(SeamFrame {
            tangent,
            // (t×NA)·NB is −sin of the angle of the normals and (t×NB)·NA its sine, so these are the signs.
            branch_wall: na.cross(&tangent),
            main_wall: tangent.cross(nb),
            // The walls enclose the supplement of the angle of their normals.
            groove: libm::atan2(sine, -na.dot(nb)),
            torch: between / between.norm(),
        })
    }
}

impl PipePair {
    /// Where a welder stands whose torch is at `point` along `torch` (unit, in M, from the seam to the torch).
    pub fn machine_coordinates(&self, point: &SeamPoint, torch: &Vector3<f64>) -> MachineCoordinates {
        let axis = self.direction_to_branch(torch);
        let (sin, cos) = (
            point.branch.y / self.branch_radius,
            point.branch.x / self.branch_radius,
        );
        MachineCoordinates {
            waist: point.theta(),
            radial: libm::hypot(point.branch.x, point.branch.y),
            axial: point.branch.z,
            elevation: libm::atan2(axis.z, axis.x * cos + axis.y * sin),
            out_of_plane: libm::asin((axis.y * cos - axis.x * sin).clamp(-1.0, 1.0)),
        }
    }

    /// Derivative of the unit tangent over the length \[1/mm\]: towards the centre of curvature.
    pub(super) fn curvature(&self, point: &SeamPoint, frame: &SeamFrame) -> Vector3<f64> {
        // Along the seam a normal turns by the way across its pipe's axis over the radius.
        let t = &frame.tangent;
        let branch_axis = Vector3::new(0.0, self.sin, self.cos);
        let na_1 = (t - branch_axis * t.dot(&branch_axis)) / self.branch_radius;
        let nb_1 = Vector3::new(t.x, t.y, 0.0) / self.main_radius;
        let along = point.main_normal.cross(&point.branch_normal);
        let along_1 = nb_1.cross(&point.branch_normal) + point.main_normal.cross(&na_1);
        (along_1 - t * t.dot(&along_1)) / along.norm()
    }
}
