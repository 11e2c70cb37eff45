//! Intersection of lines of sight with the work.

use super::scene::{Gap, Joint, Root};
use crate::optics::Optics;

/// A joint, prepared for lines of sight of a camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkSurface {
    joint: Joint,
    sin: f64,
    cos: f64,
    tangent: f64,
    squareness: f64,
}

/// Where a line of sight ends \[mm\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// a.
    pub along: f64,
    /// Way across the seam in the surface: u on a plate; in a corner u of the root and from there along the wall.
    pub across: f64,
    /// From the middle of the seam, square to it.
    pub lateral: f64,
    /// z: way along the optical axis from the focal plane, away from the camera.
    pub depth: f64,
    /// 0 left of the seam, 1 right of it.
    pub side: usize,
}

impl WorkSurface {
    pub fn new(joint: &Joint, optics: &Optics) -> Self {
        let (sin, cos) = optics.tilt_rad.sin_cos();
        let (tangent, squareness) = match joint {
            Joint::Gap(gap) => (gap.plate.yaw_rad.tan(), gap.plate.squareness()),
            Joint::Corner(_) => (0.0, 1.0),
        };
        Self {
            joint: *joint,
            sin,
            cos,
            tangent,
            squareness,
        }
    }

    /// The point seen at `r`, `u` of the focal plane (from the axis along rows and columns, mm): r = a cos α + n sin α,
    /// z = a sin α − n cos α.
    pub fn at(&self, r: f64, u: f64) -> Point {
        match &self.joint {
            Joint::Gap(gap) => self.on_plate(gap, r, u),
            Joint::Corner(root) => self.in_corner(root, r, u),
        }
    }

    fn on_plate(&self, gap: &Gap, r: f64, u: f64) -> Point {
        let plate = &gap.plate;
        let level = plate.height_mm + plate.roll * u;
        let along = |n: f64| (r - n * self.sin) / (self.cos + plate.pitch * self.sin);
        let lateral = |a: f64| (u - plate.lateral_mm - a * self.tangent) * self.squareness;
        let side = usize::from(lateral(along(level)) >= 0.0);
        let level = level + (side as f64 - 0.5) * gap.step_mm;
        let a = along(level);
        Point {
            along: a,
            across: u,
            lateral: lateral(a),
            depth: a * self.sin - (level + plate.pitch * a) * self.cos,
            side,
        }
    }

    fn in_corner(&self, root: &Root, r: f64, u: f64) -> Point {
        let lateral = u - root.corner.lateral_mm;
        let n = root.corner.height_mm + root.rise(lateral);
        let a = (r - n * self.sin) / self.cos;
        let side = usize::from(lateral >= 0.0);
        Point {
            along: a,
            across: root.corner.lateral_mm + lateral * root.corner.walls[side].hypot(1.0),
            lateral,
            depth: a * self.sin - n * self.cos,
            side,
        }
    }
}

impl Root {
    /// Height over the corner at `lateral` from it \[mm\]: two slopes, and between them a parabola that has the radius
    /// of the rounding at its bottom.
    pub(super) fn rise(&self, lateral: f64) -> f64 {
        let [left, right] = self.corner.walls;
        let reach = self.rounding_mm * (right - left).abs() / 2.0;
        if lateral <= -reach {
            left * lateral
        } else if lateral >= reach {
            right * lateral
        } else {
            left * lateral + (right - left) * (lateral + reach).powi(2) / (4.0 * reach)
        }
    }
}
