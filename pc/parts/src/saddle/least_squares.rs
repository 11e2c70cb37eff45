//! Least squares for a saddle: its height around the branch, and the descent to the best of all saddles.

use super::fit::Known;
use nalgebra::{SMatrix, SVector, Vector3};
use shared::units::wrap;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Unknowns: z₀, θ₀, δ, β, R, r.
pub(super) const UNKNOWNS: usize = 6;
pub(super) const LIFT: usize = 0;
pub(super) const TURN: usize = 1;
pub(super) const OFFSET: usize = 2;
pub(super) const ANGLE: usize = 3;
pub(super) const MAIN: usize = 4;
pub(super) const BRANCH: usize = 5;

/// Where the search begins: turns of the machine, and main radii in branch radii if that is not known.
const TURNS: usize = 12;
const MAIN_RATIOS: [f64; 3] = [1.5, 3.0, 8.0];
const ROUNDS: usize = 200;
/// A step smaller than this is the last (mm, rad).
const SETTLED: f64 = 1e-11;
/// Fits of this ratio are the same curve, seen from its other side.
const SAME: f64 = 1.0 + 1e-6;
/// A sum of squares that is rounding only \[mm²\].
const EXACT: f64 = 1e-12;

pub(super) type Values = SVector<f64, UNKNOWNS>;
type Normal = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Points of the tip against one set of unknowns.
pub(super) struct Problem<'a> {
    pub points: &'a [Vector3<f64>],
    /// Which are to be found.
    pub free: [bool; UNKNOWNS],
}

/// Height of the seam over its foot, and its derivatives.
pub(super) struct Height {
    /// Over θ \[mm/rad\].
    slope: f64,
    pub value: f64,
    /// Over the unknowns.
    pub gradient: Values,
}

/// The height at a waist; `None` where the branch passes beside the main pipe.
pub(super) fn height(values: &Values, waist: f64) -> Option<Height> {
    let [lift, turn, offset, angle, main, branch] = (*values).into();
    let (sin_b, cos_b) = libm::sincos(angle);
    let (sin, cos) = libm::sincos(waist - turn);
    let x = branch * cos + offset;
    let w = libm::sqrt((main - x) * (main + x));
    // NaN where there is no seam.
    if !(w > 0.0 && sin_b > 0.0 && branch > 0.0 && main > 0.0) {
        return None;
    }
    let slope = (branch * sin * x / w - branch * cos * cos_b) / sin_b;
    let mut gradient = Values::zeros();
    gradient[LIFT] = 1.0;
    gradient[TURN] = -slope;
    gradient[OFFSET] = -x / (w * sin_b);
    gradient[ANGLE] = (branch * sin - w * cos_b) / (sin_b * sin_b);
    gradient[MAIN] = main / (w * sin_b);
    gradient[BRANCH] = -(x * cos / w + sin * cos_b) / sin_b;
    Some(Height {
        slope,
        value: lift + (w - branch * sin * cos_b) / sin_b,
        gradient,
    })
}

/// How far `point` is from the seam: across it on the wall of the branch, and outwards; each with its row.
fn residuals(values: &Values, point: &Vector3<f64>) -> Option<[(f64, Values); 2]> {
    let height = height(values, libm::atan2(point.y, point.x))?;
    // From the height to the distance across.
    let across = 1.0 / libm::hypot(1.0, height.slope / values[BRANCH]);
    let outwards = Values::from_fn(|row, _| if row == BRANCH { 1.0 } else { 0.0 });
    Some([
        ((point.z - height.value) * across, height.gradient * across),
        (point.xy().norm() - values[BRANCH], outwards),
    ])
}

impl Problem<'_> {
    /// `row` without what is known.
    pub fn masked(&self, row: Values) -> Values {
        row.zip_map(&SVector::from(self.free), |x, free| if free { x } else { 0.0 })
    }

    /// Of each point from the seam.
    pub fn distances(&self, values: &Values) -> Option<Vec<f64>> {
        let points = self.points.iter();
        points
            .map(|point| residuals(values, point).map(|[along, radial]| libm::hypot(along.0, radial.0)))
            .collect()
    }

    /// Sum of squares, normal matrix and gradient at `values`; `None` where there is no seam.
    pub fn normal(&self, values: &Values) -> Option<(f64, Normal, Values)> {
        let (mut sum, mut normal, mut gradient) = (0.0, Normal::zeros(), Values::zeros());
        let mut add = |residual: f64, row: Values| {
            let row = self.masked(row);
            sum += residual * residual;
            normal += row * row.transpose();
            gradient += row * residual;
        };
        for point in self.points {
            let [(along, along_row), (radial, radial_row)] = residuals(values, point)?;
            add(along, along_row);
            add(radial, radial_row);
        }
        for i in (0..UNKNOWNS).filter(|&i| !self.free[i]) {
            normal[(i, i)] = 1.0;
        }
        Some((sum, normal, gradient))
    }

    /// Levenberg–Marquardt from `values`: the sum of squares and where it is least.
    fn descend(&self, mut values: Values) -> Option<(f64, Values)> {
        let (mut sum, mut normal, mut gradient) = self.normal(&values)?;
        let mut damping = 1e-3;
        for _ in 0..ROUNDS {
            let damped = normal + Normal::from_diagonal(&normal.diagonal()) * damping;
            let step = damped.cholesky()?.solve(&gradient);
            match self.normal(&(values + step)) {
                Some(better) if better.0 <= sum => {
                    values += step;
                    (sum, normal, gradient) = better;
                    damping *= 0.1;
                }
                _ => damping *= 10.0,
            }
            if step.amax() < SETTLED {
                break;
            }
        }
        Some((sum, values))
    }

    /// Where descents from many beginnings end, the best first; of equal ones that which turns the machine least.
    pub fn solve(&self, known: &Known) -> Vec<(f64, Values)> {
        let mean =
            |of: fn(&Vector3<f64>) -> f64| self.points.iter().map(of).sum::<f64>() / self.points.len() as f64;
        let branch = known.branch_radius.unwrap_or(mean(|point| point.xy().norm()));
        let mains = match known.main_radius {
            Some(main) => vec![main],
            None => MAIN_RATIOS.map(|ratio| ratio * branch).to_vec(),
        };
        let mut ends = Vec::new();
        for main in mains {
            for turn in 0..TURNS {
                let mut values = Values::zeros();
                values[TURN] = turn as f64 * TAU / TURNS as f64;
                values[OFFSET] = known.offset.unwrap_or(0.0);
                values[ANGLE] = known.angle.unwrap_or(FRAC_PI_2);
                values[MAIN] = main;
                values[BRANCH] = branch;
                values[LIFT] =
                    mean(|point| point.z) - height(&values, 0.0).map_or(main, |height| height.value);
                ends.extend(self.descend(values));
            }
        }
        for (_, values) in &mut ends {
            values[TURN] = wrap(values[TURN]);
        }
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = ends.first().map_or(0.0, |(sum, _)| *sum);
        let equal = ends.partition_point(|(sum, _)| *sum <= least * SAME + EXACT);
        ends[..equal].sort_by(|a, b| a.1[TURN].abs().total_cmp(&b.1[TURN].abs()));
        ends
    }
}
