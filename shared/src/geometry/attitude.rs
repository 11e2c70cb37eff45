//! Rotation of vectors, and the angle between them (mathematics C).

use nalgebra::Vector3;

/// `v` turned by `angle` \[rad\] about the unit vector `axis`, right-handed (Rodrigues).
pub fn rotate(axis: &Vector3<f64>, angle: f64, v: &Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = libm::sincos(angle);
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

/// Angle between two vectors \[rad\], exact near 0 and π too.
pub fn angle(u: &Vector3<f64>, v: &Vector3<f64>) -> f64 {
    libm::atan2(u.cross(v).norm(), u.dot(v))
}
