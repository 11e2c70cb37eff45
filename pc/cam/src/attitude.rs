//! Interpolation of attitude along the shortest rotation (mathematics 0.4).

use nalgebra::Vector3;
use shared::geometry::{Pose, rotate};
use thiserror::Error;

/// Why there is no attitude between two others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AttitudeError {
    /// Half a turn apart (within 1e-6 rad): every way is as short as the others.
    #[error("antipodal orientation")]
    Antipodal,
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
    if std::f64::consts::PI - phi < 1e-6 {
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
