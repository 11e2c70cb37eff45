//! The pose of the tool in the world frame.

use nalgebra::Vector3;
use thiserror::Error;

/// Position and attitude of the tool centre point in the world frame (mathematics 0.2).
///
/// `tangent` (T) is the direction of travel, `normal` (N) the tool axis, pointing from the tip to the machine,
/// away from the work. Both have unit length and are perpendicular: [`Pose::new`] sees to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Tool centre point D \[mm\].
    pub position: Vector3<f64>,
    /// Direction of travel T.
    pub tangent: Vector3<f64>,
    /// Tool axis N.
    pub normal: Vector3<f64>,
}

/// Why three vectors are not a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum PoseError {
    /// A vector is shorter than 1e-12.
    #[error("zero vector")]
    ZeroVector,
    /// N is shorter than 1e-12.
    #[error("zero N")]
    ZeroNormal,
    /// N and T do not span a plane.
    #[error("N parallel T")]
    NormalParallelTangent,
    /// A component is infinite or not a number.
    #[error("not finite")]
    NotFinite,
}

impl Pose {
    /// Makes a pose of a position and two directions of any length: T keeps its direction, N is turned into
    /// the plane perpendicular to it (Gram–Schmidt, mathematics 0.2 step 1).
    pub fn new(
        position: Vector3<f64>,
        tangent: Vector3<f64>,
        normal: Vector3<f64>,
    ) -> Result<Self, PoseError> {
        let all = [position, tangent, normal];
        if all.iter().any(|v| !v.iter().all(|x| x.is_finite())) {
            return Err(PoseError::NotFinite);
        }
        let tangent = unit(tangent).ok_or(PoseError::ZeroVector)?;
        let across = normal - tangent * normal.dot(&tangent);
        let width = length_across(&normal, &across)?;
        Ok(Self {
            position,
            tangent,
            normal: across / width,
        })
    }

    /// The pose of a tool that is a body of revolution: `normal`, of any length, keeps its direction, and T is some
    /// direction perpendicular to it.
    pub fn pointing(position: Vector3<f64>, normal: Vector3<f64>) -> Result<Self, PoseError> {
        if !position.iter().chain(normal.iter()).all(|x| x.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        let normal = unit(normal).ok_or(PoseError::ZeroVector)?;
        // The coordinate axis furthest from N, turned into the plane perpendicular to it.
        let furthest = Vector3::ith(normal.iamin(), 1.0);
        let tangent = furthest - normal * normal.dot(&furthest);
        Ok(Self {
            position,
            tangent: tangent / tangent.norm(),
            normal,
        })
    }

    /// Left of travel: M = N × T.
    pub fn lateral(&self) -> Vector3<f64> {
        self.normal.cross(&self.tangent)
    }
}

/// Vectors that are shorter have no direction.
pub(super) const SHORTEST: f64 = 1e-12;
/// A normal that is off T by less has none across it \[rad\].
const PARALLEL: f64 = 1e-6;

/// Length of `across`, which is the part of `normal` perpendicular to T.
pub(super) fn length_across(normal: &Vector3<f64>, across: &Vector3<f64>) -> Result<f64, PoseError> {
    let (whole, part) = (normal.norm_squared(), across.norm_squared());
    if whole <= SHORTEST * SHORTEST {
        return Err(PoseError::ZeroNormal);
    }
    if part < PARALLEL * PARALLEL * whole {
        return Err(PoseError::NormalParallelTangent);
    }
    Ok(libm::sqrt(part))
}

/// `v` with length 1, or `None` if it is shorter than 1e-12.
pub(crate) fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let length = v.norm();
    (length > SHORTEST).then(|| v / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pointing_tool_keeps_its_axis_and_gets_some_tangent() {
        for n in [
            Vector3::z(),
            Vector3::new(0.0, -3.0, 0.0),
            Vector3::new(1.0, 1.0, -1.0),
            Vector3::new(1e-9, 5.0, 2.0),
        ] {
            let pose = Pose::pointing(Vector3::x(), n).unwrap();
            assert_eq!(pose.normal, n / n.norm());
            assert!(pose.tangent.dot(&pose.normal).abs() < 1e-15);
            assert!((pose.tangent.norm() - 1.0).abs() < 1e-15);
        }
        let (zero, bad) = (Vector3::zeros(), Vector3::new(0.0, f64::NAN, 1.0));
        assert_eq!(Pose::pointing(zero, zero), Err(PoseError::ZeroVector));
        assert_eq!(Pose::pointing(zero, bad), Err(PoseError::NotFinite));
        assert_eq!(Pose::pointing(bad, Vector3::z()), Err(PoseError::NotFinite));
    }
}
