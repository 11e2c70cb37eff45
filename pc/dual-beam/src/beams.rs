//! Where two beams cross, and how far the V slides reach (mathematics 0.5 (3), 0.6).

use super::locate::LocateError;
use nalgebra::Vector3;

/// Closest approach of two beam axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Middle of the shortest connection: the virtual tip D \[mm\].
    pub tip: Vector3<f64>,
    /// Length of the shortest connection \[mm\].
    pub gap: f64,
    /// Distance of each seam point before D along its beam axis \[mm\]; negative if the beams cross before
    /// the seam.
    pub distance: [f64; 2],
}

/// Smallest angle between the beams: sin² of 1°.
const SIN2_PARALLEL: f64 = 3.045_864_904_521_35e-4;

/// Closest approach of the lines through the seam points `e`, `f` along the unit vectors `n1`, `n2`.
pub fn closest_approach(
    e: &Vector3<f64>,
    n1: &Vector3<f64>,
    f: &Vector3<f64>,
    n2: &Vector3<f64>,
) -> Result<Approach, LocateError> {
    let w = e - f;
    let beta = n1.dot(n2);
    let (d, along) = (n1.dot(&w), n2.dot(&w));
    let sin2 = n1.cross(n2).norm_squared();
    if sin2 < SIN2_PARALLEL {
        return Err(LocateError::ParallelBeams);
    }
    let a = (beta * along - d) / sin2;
    let b = (along - beta * d) / sin2;
    let (first, second) = (e + n1 * a, f + n2 * b);
    Ok(Approach {
        tip: (first + second) / 2.0,
        gap: (first - second).norm(),
        distance: [-a, -b],
    })
}

/// Extension of a V slide that keeps focal distance and defocus: v = ℓ − s − f − z, with `working_distance`
/// ℓ − f − z and the `distance` s of the seam before D, all \[mm\] (mathematics 0.6).
pub fn slide_extension(working_distance: f64, distance: f64) -> f64 {
    working_distance - distance
}
