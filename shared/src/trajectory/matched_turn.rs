//! The paper's rule for a tool that turns with an arc, for comparison (mathematics 4.2).

use super::{Trapezoid, TrapezoidError};
use crate::geometry::Arc;

/// Trapezoid of the C axis that matches the trapezoid of the path along an arc: equal times, and
/// C = C₀ ± s/R.
///
/// It is exact only while the path really runs this very trapezoid: with the override at 50 % from the middle
/// of a quarter arc on, C is 22.5° off. Better, and what the machines do: C = [`Arc::heading`]`(s)` + a constant
/// in every tick with the velocity κ·ṡ, which follows from the tangent of the arc at any speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchedTurn {
    path: Trapezoid,
    radius: f64,
    sweep: f64,
}

impl MatchedTurn {
    /// The turn along the plane arc `arc`, seen from +Z, with the path at most at `velocity` \[mm/s\] and with
    /// `acceleration` \[mm/s²\].
    pub fn build(arc: &Arc, velocity: f64, acceleration: f64) -> Result<Self, TrapezoidError> {
        Ok(Self {
            path: Trapezoid::build(arc.radius() * arc.sweep(), velocity, acceleration)?,
            radius: arc.radius(),
            sweep: arc.signed_sweep(&nalgebra::Vector3::z()),
        })
    }

    /// The trapezoid of the path.
    pub fn path(&self) -> &Trapezoid {
        &self.path
    }

    /// The whole turn, positive about +Z \[rad\].
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// Path length of the acceleration \[mm\].
    pub fn ramp_length(&self) -> f64 {
        self.path.peak() * self.path.ramp() / 2.0
    }

    /// Angle of the acceleration φₐ \[rad\].
    pub fn ramp_angle(&self) -> f64 {
        self.ramp_length() / self.radius
    }

    /// Angular acceleration of C, 2φₐ/tₐ² \[rad/s²\].
    pub fn acceleration(&self) -> f64 {
        2.0 * self.ramp_angle() / (self.path.ramp() * self.path.ramp())
    }

    /// Highest angular speed of C \[rad/s\].
    pub fn velocity(&self) -> f64 {
        self.path.peak() / self.radius
    }

    /// Angle C has turned by after the time `t` \[s\], positive about +Z \[rad\].
    pub fn at(&self, t: f64) -> f64 {
        libm::copysign(self.path.at(t).s / self.radius, self.sweep)
    }
}
