//! Circular arcs and helices over their length (mathematics 1.4, 4.2).

#[cfg(test)]
mod tests;

use super::{Moving, pose::unit, rotate};
use core::f64::consts::{PI, SQRT_2, TAU};
use nalgebra::Vector3;
use thiserror::Error;

/// Ends nearer than this \[mm\] mean a full circle: no program is written finer.
const SAME_POINT: f64 = 1e-6;
/// A sweep that is beyond half a turn, or a full one, by less is not \[rad\]: whoever makes the arc again, of numbers
/// that are rounded, makes the same one.
const SAME_TURN: f64 = 1e-6;
/// Radii at start and end may differ by this share of the larger one,
const RADIUS_SHARE: f64 = 1e-3;
/// and by this much in any case \[mm\]: a point that is rounded to two decimals is up to 0.005·√2 mm off, and start and end are each
/// with the centre,
const LEAST_TOLERANCE: f64 = 0.02 * SQRT_2;
/// but never by more than this \[mm\].
const MOST_TOLERANCE: f64 = 0.5;

/// Why there is no arc.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ArcError {
    /// Start and end are not equally far from the centre.
    #[error(
        "radius mismatch: the start is {start:.4} mm from the centre, the end {end:.4} mm, a difference of {:.4} mm; \
         {limit:.4} mm is allowed here ({limits}); correct the centre or the end",
        libm::fabs(start - end),
        limits = Arc::RADIUS_LIMITS
    )]
    RadiusMismatch {
        /// Distance from start to centre \[mm\].
        start: f64,
        /// Distance from end to centre \[mm\].
        end: f64,
        /// Largest difference \[mm\].
        limit: f64,
    },
    /// The start lies on the axis.
    #[error("zero radius: the start of the arc is its centre")]
    ZeroRadius,
    /// The axis has no direction.
    #[error("zero axis: the plane of the arc is undefined")]
    ZeroAxis,
    /// A coordinate is infinite or not a number.
    #[error("not finite: a coordinate of the arc is not a number, or too large for one")]
    NotFinite,
}

/// Sense of an arc, seen from the tip of the axis: with the axis of the plane, G3 or G2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Right-handed about the axis (G3).
    CounterClockwise,
    /// Left-handed about the axis (G2).
    Clockwise,
}

/// An arc of up to a full circle or, if it rises along its axis, a helix of up to one turn; more than that by
/// [`Arc::with_turns`].
///
/// It always goes right-handed about its own [`Arc::axis`]; a clockwise arc has the opposite axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    centre: Vector3<f64>,
    axis: Vector3<f64>,
    /// From the centre to the start.
    arm: Vector3<f64>,
    radius: f64,
    sweep: f64,
    /// Spread evenly over the sweep: the rise, and beyond half a turn what the given end is off the circle.
    drift: Vector3<f64>,
    length: f64,
}

impl Arc {
    /// By how much radii may differ, in words.
    pub const RADIUS_LIMITS: &str =
        "0.1 % of the radius, but 0.028 mm in any case and never more than 0.5 mm";

    /// Largest difference of the radii at start and end of an arc, of which `radius` is the larger one \[mm\]: as
    /// LinuxCNC takes them.
    pub fn radius_tolerance(radius: f64) -> f64 {
        libm::fmin(libm::fmax(RADIUS_SHARE * radius, LEAST_TOLERANCE), MOST_TOLERANCE)
    }

    /// The arc from `start` to `end` about `centre`, as G2 and G3 give it: `axis` is the axis of the plane, of
    /// any length, and `turn` the sense about it. Ends at one place mean a full circle. The end may be higher
    /// along the axis than the start (helix); the height of `centre` does not matter.
    ///
    /// The arc ends exactly at `end`. Where the radii differ, by [`Arc::radius_tolerance`] at most, up to half a turn goes
    /// about the point nearest to `centre` that is as far from one end as from the other; more is a spiral about `centre`
    /// (mathematics 4.2). Either is off the circle through the start by that difference at most.
    pub fn about_centre(
        start: Vector3<f64>,
        end: Vector3<f64>,
        centre: Vector3<f64>,
        axis: Vector3<f64>,
        turn: Turn,
    ) -> Result<Self, ArcError> {
        Self::with_turns(start, end, centre, axis, turn, 0)
    }

    /// The same with so many full turns `more`, as the P word of G2 and G3 asks for, and what it rises spread over all of
    /// it. With any, radii that differ make a spiral.
    pub fn with_turns(
        start: Vector3<f64>,
        end: Vector3<f64>,
        centre: Vector3<f64>,
        axis: Vector3<f64>,
        turn: Turn,
        more: u32,
    ) -> Result<Self, ArcError> {
        finite(&[start, end, centre, axis])?;
        let axis = unit(axis).ok_or(ArcError::ZeroAxis)?;
        let rise = (end - start).dot(&axis);
        let centre = centre + axis * (start - centre).dot(&axis);
        let axis = match turn {
            Turn::CounterClockwise => axis,
            Turn::Clockwise => -axis,
        };
        let arm = start - centre;
        let end_arm = end - centre - axis * (end - centre).dot(&axis);
        let (radius, end_radius) = (arm.norm(), end_arm.norm());
        if radius <= SAME_POINT {
            return Err(ArcError::ZeroRadius);
        }
        let limit = Self::radius_tolerance(libm::fmax(radius, end_radius));
        if libm::fabs(radius - end_radius) > limit {
            return Err(ArcError::RadiusMismatch {
                start: radius,
                end: end_radius,
                limit,
            });
        }
        let chord = end_arm - arm;
        let closed = chord.norm() <= SAME_POINT;
        let sweep = central_angle(&axis, &arm, &end_arm);
        let (centre, arm, sweep) = if closed {
            (centre, arm, TAU)
        } else if more == 0 && sweep <= PI + SAME_TURN {
            // The part of the way from the middle of the chord to the centre that is along the chord.
            let shift = chord * (-0.5 * (arm + end_arm).dot(&chord) / chord.norm_squared());
            let [arm, end_arm] = [arm + shift, end_arm + shift];
            (centre - shift, arm, central_angle(&axis, &arm, &end_arm))
        } else {
            (centre, arm, sweep)
        };
        let radius = arm.norm();
        let sweep = sweep + TAU * f64::from(more);
        let length = libm::hypot(radius * sweep, rise);
        finite(&[centre, arm, Vector3::repeat(length)])?;
        Ok(Self {
            centre,
            axis,
            arm,
            radius,
            sweep,
            drift: end - (centre + rotate(&axis, sweep, &arm)),
            length,
        })
    }

    /// Centre \[mm\], in the plane of the start.
    pub fn centre(&self) -> Vector3<f64> {
        self.centre
    }

    /// Unit axis; the arc goes right-handed about it.
    pub fn axis(&self) -> Vector3<f64> {
        self.axis
    }

    /// Radius \[mm\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Central angle from start to end \[rad\], above 0 and up to 2π, but for [`Arc::with_turns`].
    pub fn sweep(&self) -> f64 {
        self.sweep
    }

    /// Full turns beyond the first time it comes to its end.
    pub fn more_turns(&self) -> u32 {
        libm::fmax(libm::ceil((self.sweep - SAME_TURN) / TAU) - 1.0, 0.0) as u32
    }

    /// Sweep \[rad\], positive if right-handed about `direction`, else negative (mathematics 4.2).
    pub fn signed_sweep(&self, direction: &Vector3<f64>) -> f64 {
        libm::copysign(self.sweep, self.axis.dot(direction))
    }

    /// Height gained along [`Arc::axis`] from start to end \[mm\]; 0 for a plane arc.
    pub fn rise(&self) -> f64 {
        self.drift.dot(&self.axis)
    }

    /// Length \[mm\].
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Curvature \[1/mm\].
    pub fn curvature(&self) -> f64 {
        let turn = self.sweep / self.length;
        self.radius * turn * turn
    }

    /// Start \[mm\].
    pub fn start(&self) -> Vector3<f64> {
        self.centre + self.arm
    }

    /// End \[mm\].
    pub fn end(&self) -> Vector3<f64> {
        self.at_angle(self.sweep)
    }

    /// The point after the central angle `angle` \[rad\] from the start \[mm\].
    pub fn at_angle(&self, angle: f64) -> Vector3<f64> {
        self.centre + rotate(&self.axis, angle, &self.arm) + self.drift * (angle / self.sweep)
    }

    /// Point \[mm\] and its derivatives over the length `s` \[mm\] gone. The first is the unit tangent, but for
    /// the difference of the radii (see [`Arc::about_centre`]) as a part of the length.
    pub fn at(&self, s: f64) -> Moving {
        let (part, turn) = (s / self.length, self.sweep / self.length);
        let arm = rotate(&self.axis, self.sweep * part, &self.arm);
        Moving {
            value: self.centre + arm + self.drift * part,
            first: self.axis.cross(&arm) * turn + self.drift / self.length,
            second: -arm * (turn * turn),
        }
    }

    /// Central angle from the start to the direction of `point`, right-handed about the axis \[rad\], in (0, 2π]
    /// (mathematics 1.4).
    pub fn angle_of(&self, point: &Vector3<f64>) -> f64 {
        central_angle(&self.axis, &self.arm, &(point - self.centre))
    }
}

fn finite(points: &[Vector3<f64>]) -> Result<(), ArcError> {
    if points.iter().all(|p| p.iter().all(|x| x.is_finite())) {
        Ok(())
    } else {
        Err(ArcError::NotFinite)
    }
}

/// Angle from `from` to `to`, right-handed about the unit `axis`, in (0, 2π].
fn central_angle(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> f64 {
    let angle = libm::atan2(axis.dot(&from.cross(to)), from.dot(to));
    if angle > 0.0 { angle } else { angle + TAU }
}
