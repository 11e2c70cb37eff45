//! Rotation of vectors, and interpolation of attitude along the shortest way (mathematics C, 0.4).

use super::Pose;
use nalgebra::Vector3;
use thiserror::Error;

/// Why there is no attitude between two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AttitudeError {
    /// Half a turn apart (within 1e-6 rad): every way is as short as the others.
    #[error("antipodal orientation")]
    Antipodal,
}

/// `v` turned by `angle` \[rad\] about the unit vector `axis`, right-handed (Rodrigues).
pub fn rotate(axis: &Vector3<f64>, angle: f64, v: &Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(angle);
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

/// Angle between two vectors \[rad\], exact near 0 and π too.
pub fn angle(u: &Vector3<f64>, v: &Vector3<f64>) -> f64 {
    libm::atan2(u.cross(v).norm(), u.dot(v))
}

/// The pose at part `lambda` (0…1) of the way: the position on a straight line, the attitude about one axis
/// by the smaller angle.
pub fn interpolate(from: &Pose, to: &Pose, lambda: f64) -> Result<Pose, AttitudeError> {
    let position = from.position + (to.position - from.position) * lambda;
    let columns = |pose: &Pose| [pose.tangent, pose.lateral(), pose.normal];
    let (mut double_sin, mut trace) = (Vector3::zeros(), 0.0);
    for (a, b) in columns(from).iter().zip(&columns(to)) {
        // For b = Rot(k, φ)·a over an orthonormal a: Σ a×b = 2 sinφ·k, Σ a·b = 1 + 2 cosφ.
        double_sin += a.cross(b);
        trace += a.dot(b);
    }
    let size = double_sin.norm();
    let phi = libm::atan2(size / 2.0, (trace - 1.0) / 2.0);
    if core::f64::consts::PI - phi < 1e-6 {
        return Err(AttitudeError::Antipodal);
    }
    if phi < 1e-12 {
        return Ok(Pose { position, ..*from });
    }
    let axis = double_sin / size;
    Ok(Pose {
        position,
        tangent: rotate(&axis, lambda * phi, &from.tangent),
        normal: rotate(&axis, lambda * phi, &from.normal),
    })
}
