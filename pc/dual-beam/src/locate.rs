//! Pose of the dual-beam head at one point of seam 1 (mathematics 0.5).

use super::beams::closest_approach;
use super::cut::OtherSeam;
use nalgebra::Vector3;
use shared::geometry::rotate;
use thiserror::Error;

/// A point of seam 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamPlace {
    /// The point P1 \[mm\].
    pub point: Vector3<f64>,
    /// Direction of travel, any length.
    pub tangent: Vector3<f64>,
    /// Skin normal, pointing up to the head, any length.
    pub normal: Vector3<f64>,
}

/// The head at one point of seam 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// Point P2 of seam 2 \[mm\].
    pub p2: Vector3<f64>,
    /// Its arc length along seam 2 \[mm\].
    pub sigma2: f64,
    /// How many points of seam 2 lay in the plane.
    pub hits: usize,
    /// Axes N1, N2 of the beams, away from the work.
    pub beams: [Vector3<f64>; 2],
    /// Virtual tip P3 \[mm\].
    pub tip: Vector3<f64>,
    /// T3.
    pub tangent: Vector3<f64>,
    /// N3.
    pub normal: Vector3<f64>,
    /// Distance of the beam axes \[mm\].
    pub gap: f64,
    /// s_E, s_F: distance of each seam point before the tip along its beam \[mm\]; both must be positive.
    pub distance: [f64; 2],
}

/// Why there is no pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum LocateError {
    /// The plane across seam 1 does not meet seam 2.
    #[error("the plane across seam 1 misses seam 2; extend seam 2 or trim seam 1")]
    Miss,
    /// Only beyond the largest distance.
    #[error("seam 2 is too far from seam 1")]
    TooFar,
    /// The beams are parallel.
    #[error("the two beams are parallel")]
    ParallelBeams,
    /// The beams cross before they reach the seams.
    #[error(
        "the beams cross before they reach the seams; are the seams swapped, or has the head's angle the wrong sign?"
    )]
    CrossBefore,
    /// A direction without length, or the normal along the seam.
    #[error("a direction has no length")]
    ZeroVector,
    /// The symmetric plane was not found.
    #[error("no plane is symmetric to both seams")]
    NoConvergence,
}

fn unit(v: Vector3<f64>) -> Result<Vector3<f64>, LocateError> {
    let length = v.norm();
    if length > 1e-12 {
        Ok(v / length)
    } else {
        Err(LocateError::ZeroVector)
    }
}

/// The pose as the paper has it: the plane across seam 1; T2 = T1, or `t2` if it is given. `theta1` leans
/// beam 1 from the skin normal, `theta2` is the angle from beam 1 to beam 2 \[rad\].
pub fn locate(
    place: &SeamPlace,
    other: &impl OtherSeam,
    theta1: f64,
    theta2: f64,
    gap_max: f64,
    sigma_prev: Option<f64>,
    t2: Option<Vector3<f64>>,
) -> Result<Location, LocateError> {
    let t1 = unit(place.tangent)?;
    let n = unit(place.normal - t1 * place.normal.dot(&t1))?;
    let n1 = rotate(&t1, theta1, &n);
    let crossing = other.cut(&place.point, &t1, gap_max, sigma_prev)?;
    let t2 = t2.map_or(Ok(t1), unit)?;
    let t2 = if t2.dot(&t1) < 0.0 { -t2 } else { t2 };
    let n2 = rotate(&t1, theta2, &n1);
    let approach = closest_approach(&place.point, &n1, &crossing.point, &n2)?;
    let tangent = unit(t1 + t2)?;
    let mean = unit(n1 + n2)?;
    Ok(Location {
        p2: crossing.point,
        sigma2: crossing.sigma,
        hits: crossing.count,
        beams: [n1, n2],
        tip: approach.tip,
        tangent,
        normal: unit(mean - tangent * mean.dot(&tangent))?,
        gap: approach.gap,
        distance: approach.distance,
    })
}

/// Iterations for the symmetric plane, and the change of its normal that ends them.
const ROUNDS: usize = 50;
const SETTLED: f64 = 1e-13;

/// The pose in the plane that lies evenly across both seams: no side is privileged, and the beams of the
/// rigid head meet both seams exactly (mathematics 0.5 (b)).
pub fn locate_symmetric(
    place: &SeamPlace,
    other: &impl OtherSeam,
    theta1: f64,
    theta2: f64,
    gap_max: f64,
    sigma_prev: Option<f64>,
) -> Result<Location, LocateError> {
    let t1 = unit(place.tangent)?;
    let mut t = t1;
    for _ in 0..ROUNDS {
        let crossing = other.cut(&place.point, &t, gap_max, sigma_prev)?;
        let t2 = if crossing.tangent.dot(&t1) < 0.0 {
            -crossing.tangent
        } else {
            crossing.tangent
        };
        let next = unit(t1 + t2)?;
        let change = (next - t).norm();
        t = next;
        if change < SETTLED {
            let even = SeamPlace { tangent: t, ..*place };
            return locate(&even, other, theta1, theta2, gap_max, sigma_prev, None);
        }
    }
    Err(LocateError::NoConvergence)
}
