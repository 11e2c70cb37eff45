//! The saddle curve, where the walls of two pipes meet (mathematics 1.1–1.3).
//!
//! Frames: M is that of the main pipe (Z along its axis), S that of the branch (Z along its axis, X common
//! with M). The branch axis is tilted by β from Z_M towards +Y_M and stands `offset` beside the main axis,
//! towards +X. Points on the branch go by θ about Z_S from X_S; [`Sheet`] says on which side of the main pipe.
//!
//! [`PipePair`] answers for a given θ. A weld goes along a [`SaddleCurve`], which knows no sheets and no places
//! where θ stands still.

mod closed;
mod curve;
mod error;
mod frame;
mod nearest;
#[cfg(test)]
mod tests;

pub use curve::{CurvePoint, SaddleCurve};
pub use error::SaddleError;
pub use frame::{MachineCoordinates, SeamFrame, SeamPoint};
pub use nearest::Nearest;

use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Relative tolerance of tangency: r + |δ| = R within this part of R.
const TANGENT: f64 = 1e-9;

/// How two pipes intersect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intersection {
    /// They do not intersect.
    None,
    /// All of the branch goes into the main pipe: one closed seam a sheet.
    Full,
    /// As full or partial, but the walls touch at the rim (r + |δ| = R), where both sheets meet.
    Tangent,
    /// A part of the branch passes beside the main pipe.
    Partial,
}

/// Side of the main pipe, by the sign of y_M.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// Where the branch leaves.
    Plus,
    /// The opposite wall.
    Minus,
}

impl Sheet {
    fn sign(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

/// Two pipes that may meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PipePair {
    /// R.
    main_radius: f64,
    /// r.
    branch_radius: f64,
    /// δ.
    offset: f64,
    sin: f64,
    cos: f64,
    meeting: Intersection,
}

impl PipePair {
    /// A main pipe of radius `main_radius` and a branch of `branch_radius` \[mm\], whose axis is at `angle` β
    /// \[rad\] to the main axis and passes it at `offset` δ \[mm\] towards +X. Pipes that do not meet are a
    /// pair as well, with [`Intersection::None`].
    pub fn new(main_radius: f64, branch_radius: f64, angle: f64, offset: f64) -> Result<Self, SaddleError> {
        for (pipe, radius) in [("main", main_radius), ("branch", branch_radius)] {
            if !(radius.is_finite() && radius > 0.0) {
                return Err(SaddleError::Radius { pipe, radius });
            }
        }
        if !(angle.is_finite() && offset.is_finite()) {
            return Err(SaddleError::NotFinite);
        }
        let (sin, cos) = libm::sincos(angle);
        if libm::fabs(sin) < 1e-6 {
            return Err(SaddleError::ParallelAxes {
                angle_deg: angle.to_degrees(),
            });
        }
        let (beside, free) = (libm::fabs(offset), TANGENT * main_radius);
        let meeting = if beside - branch_radius >= main_radius {
            Intersection::None
        } else if libm::fabs(branch_radius + beside - main_radius) <= free {
            Intersection::Tangent
        } else if branch_radius + beside < main_radius {
            Intersection::Full
        } else {
            Intersection::Partial
        };
        Ok(Self {
            main_radius,
            branch_radius,
            offset,
            sin,
            cos,
            meeting,
        })
    }

    /// Radius R of the main pipe \[mm\].
    pub fn main_radius(&self) -> f64 {
        self.main_radius
    }

    /// Radius r of the branch \[mm\].
    pub fn branch_radius(&self) -> f64 {
        self.branch_radius
    }

    /// How the pipes meet.
    pub fn meeting(&self) -> Intersection {
        self.meeting
    }

    /// The intervals of θ where the branch meets the main pipe \[rad\]; the first may begin below 0. At the
    /// ends of those of a partial meeting both sheets join.
    pub fn intervals(&self) -> Vec<[f64; 2]> {
        let mut intervals = Vec::new();
        let mut add = |from: f64, to: f64| intervals.push([from, to]);
        match self.meeting {
            Intersection::None => {}
            Intersection::Full | Intersection::Tangent => add(0.0, TAU),
            Intersection::Partial => {
                let upper = (self.main_radius - self.offset) / self.branch_radius;
                let lower = (-self.main_radius - self.offset) / self.branch_radius;
                match (upper < 1.0, lower > -1.0) {
                    (true, true) => {
                        let (high, low) = (libm::acos(upper), libm::acos(lower));
                        add(high, low);
                        add(TAU - low, TAU - high);
                    }
                    (true, false) => add(libm::acos(upper), TAU - libm::acos(upper)),
                    (false, _) => add(-libm::acos(lower), libm::acos(lower)),
                }
            }
        }
        intervals
    }

    /// The point of the seam at `theta` \[rad\] on `sheet`.
    pub fn at_theta(&self, theta: f64, sheet: Sheet) -> Result<SeamPoint, SaddleError> {
        let (sin, cos) = libm::sincos(theta);
        let x = self.branch_radius * cos + self.offset;
        let radius = self.main_radius;
        // The product keeps its digits near the rim, where R² − x² would not.
        let radicand = (radius - x) * (radius + x);
        if radicand.is_nan() || radicand < -1e-12 * radius * radius {
            return Err(SaddleError::NoIntersection {
                theta_deg: theta.to_degrees(),
                x,
                main_radius: radius,
            });
        }
        let w = sheet.sign() * libm::sqrt(radicand.max(0.0));
        Ok(self.seam_point(x, w, self.branch_radius * sin))
    }

    /// Derivative of [`SeamPoint::main`] over θ \[mm/rad\], at the same place.
    pub fn theta_derivative(&self, theta: f64, sheet: Sheet) -> Result<Vector3<f64>, SaddleError> {
        let point = self.at_theta(theta, sheet)?;
        let w = point.main.y;
        if libm::fabs(w) < 1e-9 * self.main_radius {
            return Err(SaddleError::VerticalTangent {
                theta_deg: theta.to_degrees(),
            });
        }
        let [dx, dy] = [-point.branch.y, point.branch.x];
        Ok(self.main_direction(dx, -point.main.x * dx / w, dy))
    }

    /// Distances of a point in M from the walls of branch and main pipe \[mm\], positive outside.
    #[cfg(test)]
    pub(crate) fn wall_distances(&self, main: &Vector3<f64>) -> [f64; 2] {
        let branch = self.to_branch(main);
        [
            libm::hypot(branch.x, branch.y) - self.branch_radius,
            libm::hypot(main.x, main.y) - self.main_radius,
        ]
    }

    /// A point of M in S \[mm\].
    #[cfg(test)]
    pub(crate) fn to_branch(self, main: &Vector3<f64>) -> Vector3<f64> {
        self.direction_to_branch(&(main - Vector3::new(self.offset, 0.0, 0.0)))
    }

    /// A point of S in M \[mm\].
    #[cfg(test)]
    pub(crate) fn to_main(self, branch: &Vector3<f64>) -> Vector3<f64> {
        let (x, y, z) = (branch.x, branch.y, branch.z);
        Vector3::new(
            x + self.offset,
            y * self.cos + z * self.sin,
            z * self.cos - y * self.sin,
        )
    }

    /// A direction of M in S.
    pub fn direction_to_branch(&self, main: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            main.x,
            main.y * self.cos - main.z * self.sin,
            main.y * self.sin + main.z * self.cos,
        )
    }

    /// The vector in M of what x and y_M of the main pipe and y_S of the branch do together.
    fn main_direction(&self, x: f64, w: f64, y: f64) -> Vector3<f64> {
        Vector3::new(x, w, (w * self.cos - y) / self.sin)
    }

    /// The point at x_M, y_M = `w` and y_S = `y`, which must lie on both walls.
    fn seam_point(&self, x: f64, w: f64, y: f64) -> SeamPoint {
        let (across, radius) = (x - self.offset, self.branch_radius);
        SeamPoint {
            main: self.main_direction(x, w, y),
            branch: Vector3::new(across, y, (w - y * self.cos) / self.sin),
            branch_normal: Vector3::new(across, y * self.cos, -y * self.sin) / radius,
            main_normal: Vector3::new(x, w, 0.0) / self.main_radius,
        }
    }
}
