//! Eight heights on a circle: normal, curvature and what does not fit (mathematics 2.2, 2.4).
//!
//! A surface z(x, y) over a circle of radius S is a sum of harmonics of the angle. The gradient is the first one, the
//! curvature is in mean and second, and neither disturbs the other: the least-squares normal is exact for every
//! surface of second order. Third order is where it errs, by ¾kS² for z = kx³; that shows in the third harmonic.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::FRAC_1_SQRT_2;
use thiserror::Error;

/// Heights on a ring.
pub const NEIGHBOURS: usize = 8;

/// Chance of an [`Unsmooth`] ring where only noise is to blame: one in a thousand. This is that quantile of χ² with
/// the three degrees of freedom that eight heights leave to a surface of second order.
const NOISE_LIMIT: f64 = 16.27;

/// cos and sin of k·45°, exact for the multiples of 90°.
pub(super) const DIRECTIONS: [[f64; 2]; NEIGHBOURS] = {
    const H: f64 = FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [H, H],
        [0.0, 1.0],
        [-H, H],
        [-1.0, 0.0],
        [-H, -H],
        [0.0, -1.0],
        [H, -H],
    ]
};

/// Why eight numbers are no ring.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RingError {
    /// A ring needs a radius.
    #[error("the radius of the ring is {radius} mm, but must be above 0")]
    Radius {
        /// What was given \[mm\].
        radius: f64,
    },
    /// A height is infinite or not a number.
    #[error("height {} of the ring is not finite", index + 1)]
    Height {
        /// Its place, from 0.
        index: usize,
    },
}

/// Eight heights on a circle, against the height of its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    radius: f64,
    heights: [f64; NEIGHBOURS],
}

/// Harmonics of the heights over the angle: z = mean + Σ ck cos kθ + sk sin kθ \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonics {
    /// Mean height over the centre.
    pub mean: f64,
    /// First, cosine: the slope along x, times the radius.
    pub c1: f64,
    /// First, sine: the slope along y, times the radius.
    pub s1: f64,
    /// Second, cosine.
    pub c2: f64,
    /// Second, sine.
    pub s2: f64,
    /// Third, cosine.
    pub c3: f64,
    /// Third, sine.
    pub s3: f64,
    /// Fourth, cosine; its sine is zero at all eight points.
    pub c4: f64,
}

/// Second derivatives of the surface at the centre \[1/mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// ∂²z/∂x².
    pub xx: f64,
    /// ∂²z/∂y².
    pub yy: f64,
    /// ∂²z/∂x∂y.
    pub xy: f64,
}

/// The plane with the least sum of squared distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal, upwards.
    pub normal: Vector3<f64>,
    /// Root mean square distance of the heights from it \[mm\].
    pub rms: f64,
}

/// The surface under a ring is neither a plane nor curved evenly: an edge, a step, a crease, or strong third order.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the surface in the ring of {radius} mm is uneven by {rest:.3} mm, which may turn its normal by {:.2}°: is there an edge? \
     measure closer, or teach the normal by hand",
    .normal_error.to_degrees()
)]
pub struct Unsmooth {
    /// Radius of the ring \[mm\].
    pub radius: f64,
    /// Amplitude of what second order does not explain \[mm\].
    pub rest: f64,
    /// By how much that may turn the least-squares normal \[rad\].
    pub normal_error: f64,
}

impl Ring {
    /// `heights` \[mm\] over the centre, at the angles k·45° from x to y on a circle of `radius` \[mm\].
    pub fn new(radius: f64, heights: [f64; NEIGHBOURS]) -> Result<Self, RingError> {
        if !(radius.is_finite() && radius > 0.0) {
            return Err(RingError::Radius { radius });
        }
        match heights.iter().position(|z| !z.is_finite()) {
            Some(index) => Err(RingError::Height { index }),
            None => Ok(Self { radius, heights }),
        }
    }

    /// Radius \[mm\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Point k of the ring, from 0 \[mm\].
    pub fn point(&self, k: usize) -> Vector3<f64> {
        let [cos, sin] = DIRECTIONS[k % NEIGHBOURS];
        Vector3::new(self.radius * cos, self.radius * sin, self.heights[k % NEIGHBOURS])
    }

    /// Harmonics of the heights.
    pub fn harmonics(&self) -> Harmonics {
        // Σ z cos kθ and Σ z sin kθ: k·45° is again one of the eight directions.
        let sums = |k: usize| {
            self.heights.iter().enumerate().fold([0.0; 2], |[c, s], (i, z)| {
                let [cos, sin] = DIRECTIONS[k * i % NEIGHBOURS];
                [c + z * cos, s + z * sin]
            })
        };
        let [[mean, _], [c1, s1], [c2, s2], [c3, s3], [c4, _]] = [0, 1, 2, 3, 4].map(sums);
        Harmonics {
            mean: mean / 8.0,
            c1: c1 / 4.0,
            s1: s1 / 4.0,
            c2: c2 / 4.0,
            s2: s2 / 4.0,
            c3: c3 / 4.0,
            s3: s3 / 4.0,
            c4: c4 / 8.0,
        }
    }

    /// Slope of the surface along x and y by least squares.
    pub fn gradient(&self) -> [f64; 2] {
        let Harmonics { c1, s1, .. } = self.harmonics();
        [c1 / self.radius, s1 / self.radius]
    }

    /// Unit normal by least squares, upwards.
    pub fn normal(&self) -> Vector3<f64> {
        let [x, y] = self.gradient();
        Vector3::new(-x, -y, 1.0).normalize()
    }

    /// Second derivatives of the surface.
    pub fn curvature(&self) -> Curvature {
        let Harmonics { mean, c2, s2, .. } = self.harmonics();
        let over = 2.0 / (self.radius * self.radius);
        Curvature {
            xx: (mean + c2) * over,
            yy: (mean - c2) * over,
            xy: s2 * over,
        }
    }

    /// The plane nearest to the eight points; for comparison, and for figures without symmetry.
    pub fn plane(&self) -> Plane {
        let points: [Vector3<f64>; NEIGHBOURS] = std::array::from_fn(|k| self.point(k));
        let centre = points.iter().sum::<Vector3<f64>>() / NEIGHBOURS as f64;
        let scatter: Matrix3<f64> = points
            .iter()
            .map(|p| (p - centre) * (p - centre).transpose())
            .sum();
        let eigen = scatter.symmetric_eigen();
        let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
        let normal = if normal.z < 0.0 { -normal } else { normal };
        let squares: f64 = points
            .iter()
            .map(|p| (p - centre).dot(&normal))
            .map(|d| d * d)
            .sum();
        Plane {
            normal,
            rms: libm::sqrt(squares / NEIGHBOURS as f64),
        }
    }

    /// Standard deviation of the least-squares normal \[rad\] where every height has the standard deviation
    /// `noise` \[mm\]: noise/(√2·S) on a level surface, less on an inclined one.
    pub fn normal_noise(&self, noise: f64) -> f64 {
        let [x, y] = self.gradient();
        // The same noise of slope turns the normal by 1/(1+g²) along the slope, by 1/√(1+g²) across it.
        let flat = 1.0 / (1.0 + x * x + y * y);
        noise / (2.0 * self.radius) * libm::sqrt(flat * flat + flat)
    }

    /// Standard deviation of one height \[mm\] as the ring itself shows it: what second order leaves unexplained,
    /// with three degrees of freedom. Roughness is in it, and so is any third order.
    #[cfg(test)]
    pub(crate) fn noise_seen(&self) -> f64 {
        libm::sqrt(self.rest_squared() / 3.0)
    }

    /// Sum of squared residuals of the surface of second order \[mm²\].
    fn rest_squared(&self) -> f64 {
        let Harmonics { c3, s3, c4, .. } = self.harmonics();
        4.0 * (c3 * c3 + s3 * s3) + 8.0 * c4 * c4
    }

    /// A warning if the ring shows more than second order that is
    /// 1. not explained by `noise`, the standard deviation of one height \[mm\] (chance of a false one 0.1 %), and
    /// 2. able to turn the normal by more than `limit` \[rad\]: 3·rest/S, as third order along one direction does.
    ///
    /// The rest takes in the fourth harmonic: a crease through the centre shows there only, and so does most of a
    /// step behind three of the points. A step of 20 times the noise shows wherever it lies. One ring cannot see
    /// third order of the form x(x²+y²), nor a crease through its centre midway between the points.
    pub fn unsmooth(&self, noise: f64, limit: f64) -> Option<Unsmooth> {
        let rest_squared = self.rest_squared();
        let rest = libm::sqrt(rest_squared) / 2.0;
        let normal_error = libm::atan(3.0 * rest / self.radius);
        (rest_squared > NOISE_LIMIT * noise * noise && normal_error > limit).then_some(Unsmooth {
            radius: self.radius,
            rest,
            normal_error,
        })
    }
}
