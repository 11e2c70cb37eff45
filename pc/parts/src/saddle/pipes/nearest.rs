//! The point of a seam nearest to a given one: what a weld is judged by.

use super::SaddleCurve;
use super::closed::ROUND;
use nalgebra::Vector3;

/// Points of the round that are looked at first; a multiple of the parts of the curve.
const SCAN: usize = 256;

/// Newton steps or halvings from there.
const STEPS: usize = 60;

/// The point of a seam nearest to a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Its length \[mm\], from 0 to the length of the seam.
    pub s: f64,
    /// The point, in M \[mm\].
    pub point: Vector3<f64>,
    /// Distance from the given point \[mm\].
    pub distance: f64,
}

impl SaddleCurve {
    /// The point of the seam nearest to `main`, a point in M \[mm\].
    pub fn nearest(&self, main: &Vector3<f64>) -> Nearest {
        let distance = |u: f64| (self.at_parameter(u)[0] - main).norm();
        let scan_at = |i: usize| i as f64 * (ROUND / SCAN as f64);
        // Between two points of the scan the seam comes nearer by less than this.
        let nearer = self.longest_part();
        let mut least = (0.0, f64::INFINITY);
        let (mut before, mut here) = (distance(scan_at(SCAN - 1)), distance(0.0));
        for i in 0..SCAN {
            let after = distance(scan_at(i + 1));
            if here <= before && here <= after && here - nearer < least.1 {
                let u = self.foot(main, scan_at(i), ROUND / SCAN as f64);
                // At a corner the foot may be on the wrong side of it.
                for (u, distance) in [(u, distance(u)), (scan_at(i), here)] {
                    if distance < least.1 {
                        least = (u, distance);
                    }
                }
            }
            (before, here) = (here, after);
        }
        let u = least.0 - libm::floor(least.0 / ROUND) * ROUND;
        Nearest {
            s: self.length_to(u),
            point: self.at_parameter(u)[0],
            distance: least.1,
        }
    }

    /// The parameter within `step` of `u` where the seam is perpendicular to the way to `main`, coming
    /// nearer before and going away after: Newton, kept in by halving.
    fn foot(&self, main: &Vector3<f64>, u: f64, step: f64) -> f64 {
        let away = |u: f64| {
            let [point, slope] = self.at_parameter(u);
            (point - main).dot(&slope)
        };
        let (mut low, mut high, mut u) = (u - step, u + step, u);
        for _ in 0..STEPS {
            let now = away(u);
            if now > 0.0 {
                high = u;
            } else {
                low = u;
            }
            // A secant over a small way stands for the slope of `away`.
            let small = 1e-6 * step;
            let next = u - now * small / (away(u + small) - now);
            let next = if low < next && next < high {
                next
            } else {
                (low + high) / 2.0
            };
            if libm::fabs(next - u) <= 1e-15 * ROUND {
                return next;
            }
            u = next;
        }
        u
    }
}
