//! The axis N of a tool that is a body of revolution, held by a turn about z and a tilt: what the A/C head and
//! the friction-stir gantry have in common.
//!
//! N = sinθ·d + cosθ·ez: θ is the tilt and d a horizontal direction that turns with C. Where θ = 0 the turn has
//! no effect on N: that is the pole of C.

use super::KinematicsError;
use crate::geometry::{Moving, PoseMotion};
use nalgebra::Vector3;

/// Sine of the tilt below which N stands along the C axis (mathematics 2.5, 4.1).
pub(super) const POLE: f64 = 1e-9;

/// By how much N may turn, in rad/s and rad/s² (or over mm and mm²), in a direction that C does not allow at its
/// pole: within a tick that is no more than [`POLE`].
pub(super) const POLE_RATE: f64 = 1e-6;

/// N with its derivatives, of a tool whose frame turns by ω and α: Ṅ = ω×N. The spin about N itself drops out.
pub(super) fn axis_in_motion(normal: &Vector3<f64>, motion: &PoseMotion) -> Moving {
    let omega = &motion.angular_velocity;
    let first = omega.cross(normal);
    Moving {
        value: *normal,
        first,
        second: motion.angular_acceleration.cross(normal) + omega.cross(&first),
    }
}

/// Sine and cosine of the tilt θ, and the direction d into which it tilts, as the sine and cosine of C give it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tilt {
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// d.
    pub(super) toward: Vector3<f64>,
}

/// First and second derivatives of tilt and turn.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TiltMotion {
    pub(super) tilt: [f64; 2],
    pub(super) turn: [f64; 2],
}

impl Tilt {
    /// N.
    pub(super) fn normal(&self) -> Vector3<f64> {
        Vector3::new(self.toward.x * self.sin, self.toward.y * self.sin, self.cos)
    }

    /// Where N moves when C turns, per sinθ: ez × d.
    pub(super) fn across(&self) -> Vector3<f64> {
        Vector3::new(-self.toward.y, self.toward.x, 0.0)
    }

    /// How tilt and turn move with N. Differentiating N twice and taking the parts along ∂N/∂θ and ez × d gives
    /// Ṅ: θ̇, Ċ·sinθ; N̈: θ̈ − Ċ² sinθ cosθ, C̈ sinθ + 2 θ̇ Ċ cosθ.
    ///
    /// At the pole the turn is what `turn_at_pole` says, and N must not ask for another: else it is an error of
    /// the axis C, number `turn_axis`.
    pub(super) fn rates(
        &self,
        normal: &Moving,
        turn_at_pole: [f64; 2],
        turn_axis: usize,
    ) -> Result<TiltMotion, KinematicsError> {
        let (sin, cos) = (self.sin, self.cos);
        let along = Vector3::new(self.toward.x * cos, self.toward.y * cos, -sin);
        let across = self.across();
        let tilt = normal.first.dot(&along);
        let (first, second) = (normal.first.dot(&across), normal.second.dot(&across));
        if libm::fabs(sin) < POLE {
            let asked = [first, second - 2.0 * tilt * turn_at_pole[0] * cos];
            if !asked.iter().all(|rate| libm::fabs(*rate) <= POLE_RATE) {
                return Err(KinematicsError::Pole { axis: turn_axis });
            }
            return Ok(TiltMotion {
                tilt: [tilt, normal.second.dot(&along)],
                turn: turn_at_pole,
            });
        }
        let turn = first / sin;
        Ok(TiltMotion {
            tilt: [tilt, normal.second.dot(&along) + turn * turn * sin * cos],
            turn: [turn, (second - 2.0 * tilt * turn * cos) / sin],
        })
    }
}
