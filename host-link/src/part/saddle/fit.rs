//! The saddle that taught points lie on, by least squares (SPEC 1.5).
//!
//! Around the branch the seam is, up to small terms, z = z₀ + a cosθ + b sinθ + c cos2θ: the offset makes a, the
//! angle b, the radius of the main pipe c, and where the machine stands z₀ and the zero of θ. So from points all
//! around all of them can be found. A point is worth one of these unknowns, and one more point is asked for, so
//! that there is something to check by; the radius of the branch shows in every point besides.

use super::error::TaughtError;
use super::seam::Placement;
use nalgebra::{SMatrix, SVector, Vector3};
use shared::units::wrap;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Unknowns: z₀, θ₀, δ, β, R, r.
const UNKNOWNS: usize = 6;
const LIFT: usize = 0;
const TURN: usize = 1;
const OFFSET: usize = 2;
const ANGLE: usize = 3;
const MAIN: usize = 4;
const BRANCH: usize = 5;
/// Their names for people, from δ on.
const KEYS: [&str; 4] = ["offset_mm", "angle_deg", "main_diameter_mm", "branch_diameter_mm"];

/// Points that are not further apart than this part of their radius are at one place.
const ONE_PLACE: f64 = 0.1;
/// Points that are not further aside than this part of their spread are on a line: 14° of a circle.
const ON_LINE: f64 = 0.03;

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
/// Fits whose sums of squares differ by less than so many variances of the noise cannot be told apart.
const ALIKE: f64 = 9.0;
/// Noise of a taught point at least \[mm\]: what hands and eyes are good for.
const NOISE: f64 = 0.05;
/// Two standard deviations are called sure.
const SURE: f64 = 2.0;
/// Waists at which the fitted seam is asked how sure it is.
const ASKED: usize = 72;

type Values = SVector<f64, UNKNOWNS>;
type Normal = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// What the part file says; the rest is to be found (mm, rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Known {
    pub main_radius: Option<f64>,
    pub branch_radius: Option<f64>,
    pub angle: Option<f64>,
    pub offset: Option<f64>,
}

/// The saddle nearest to the points (mm, rad).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fit {
    pub main_radius: f64,
    pub branch_radius: f64,
    pub angle: f64,
    pub offset: f64,
    pub placement: Placement,
    /// Two standard deviations of z₀, θ₀, δ, β, R, r; 0 of what was known.
    pub sure: [f64; UNKNOWNS],
    /// The same of the seam, where it is largest \[mm\].
    pub seam_sure: f64,
    /// That waist \[rad\].
    pub least_sure_at: f64,
    /// Of each point from the seam \[mm\].
    pub distances: Vec<f64>,
}

impl Fit {
    /// Whether the seam is sure to `within` \[mm\] everywhere.
    pub fn check_sure(&self, within: f64) -> Result<(), TaughtError> {
        if self.seam_sure <= within {
            return Ok(());
        }
        Err(TaughtError::Unsure {
            unsure_mm: self.seam_sure,
            waist_deg: self.least_sure_at.to_degrees(),
            within_mm: within,
        })
    }
}

/// Points of the tip against one set of unknowns.
struct Problem<'a> {
    points: &'a [Vector3<f64>],
    /// Which are to be found.
    free: [bool; UNKNOWNS],
}

/// Height of the seam over its foot, and its derivatives.
struct Height {
    /// Over θ \[mm/rad\].
    slope: f64,
    value: f64,
    /// Over the unknowns.
    gradient: Values,
}

/// `None` where the branch passes beside the main pipe.
fn height(values: &Values, waist: f64) -> Option<Height> {
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
    fn masked(&self, row: Values) -> Values {
        row.zip_map(&SVector::from(self.free), |x, free| if free { x } else { 0.0 })
    }

    /// Of each point from the seam.
    fn distances(&self, values: &Values) -> Option<Vec<f64>> {
        let points = self.points.iter();
        points
            .map(|point| residuals(values, point).map(|[along, radial]| libm::hypot(along.0, radial.0)))
            .collect()
    }

    /// Sum of squares, normal matrix and gradient at `values`; `None` where there is no seam.
    fn normal(&self, values: &Values) -> Option<(f64, Normal, Values)> {
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
    fn solve(&self, known: &Known) -> Vec<(f64, Values)> {
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

impl Known {
    fn free(&self) -> [bool; UNKNOWNS] {
        [
            true,
            true,
            self.offset.is_none(),
            self.angle.is_none(),
            self.main_radius.is_none(),
            self.branch_radius.is_none(),
        ]
    }
}

/// What no fit can come from.
fn check_points(points: &[Vector3<f64>], free: &[bool; UNKNOWNS]) -> Result<(), TaughtError> {
    let needed = 1 + free[..BRANCH].iter().filter(|&&free| free).count();
    if points.len() < needed {
        let keys = KEYS.iter().zip(&free[OFFSET..BRANCH]);
        let keys: Vec<_> = keys.filter_map(|(key, free)| free.then_some(*key)).collect();
        return Err(TaughtError::TooFew {
            points: points.len(),
            needed,
            keys: if keys.is_empty() {
                "nothing more".to_owned()
            } else {
                keys.join(" and ")
            },
        });
    }
    let pairs = || (0..points.len()).flat_map(|i| (0..i).map(move |j| (points[i], points[j])));
    let farthest = pairs().max_by(|a, b| (a.0 - a.1).norm().total_cmp(&(b.0 - b.1).norm()));
    let (from, to) = farthest.unwrap_or_default();
    let chord = to - from;
    let spread_mm = chord.norm();
    let radius = points.iter().map(|point| point.xy().norm()).sum::<f64>() / points.len() as f64;
    if spread_mm < ONE_PLACE * radius {
        return Err(TaughtError::OnePlace { spread_mm });
    }
    let aside = points
        .iter()
        .map(|point| (point - from).cross(&chord).norm() / spread_mm);
    let aside_mm = aside.fold(0.0, f64::max);
    if aside_mm < ON_LINE * spread_mm {
        return Err(TaughtError::OnLine { aside_mm, spread_mm });
    }
    Ok(())
}

/// Fits what is not `known` to the `points` of the tip \[mm\], in the frame of the machine.
pub(super) fn fit(points: &[Vector3<f64>], known: &Known) -> Result<Fit, TaughtError> {
    let free = known.free();
    check_points(points, &free)?;
    let problem = Problem { points, free };
    let ends = problem.solve(known);
    let &(sum, values) = ends.first().ok_or(TaughtError::NoSaddle)?;
    let (_, normal, _) = problem.normal(&values).ok_or(TaughtError::NoSaddle)?;

    let unknowns = free.iter().filter(|&&free| free).count();
    let spare = 2 * points.len() - unknowns;
    let variance = (sum / spare as f64).max(NOISE * NOISE);
    let covariance = normal.cholesky().ok_or(TaughtError::Undetermined)?.inverse() * variance;
    let sure = |row: &Values| SURE * libm::sqrt((row.transpose() * covariance * row)[0].max(0.0));
    let one = |i: usize| Values::from_fn(|row, _| if row == i && free[i] { 1.0 } else { 0.0 });

    // What the noise leaves open, and what other fits say that are as good.
    let alike = ends.partition_point(|(other, _)| *other <= sum + ALIKE * variance);
    let mut open = (0.0, 0.0);
    for asked in 0..ASKED {
        let waist = asked as f64 * TAU / ASKED as f64;
        let Some(here) = height(&values, waist) else {
            continue;
        };
        let unsure = ends[..alike].iter().map(|(_, other)| {
            height(other, waist).map_or(f64::INFINITY, |there| (there.value - here.value).abs())
        });
        let unsure = unsure.fold(sure(&problem.masked(here.gradient)), f64::max);
        if unsure > open.0 {
            open = (unsure, waist);
        }
    }
    Ok(Fit {
        main_radius: values[MAIN],
        branch_radius: values[BRANCH],
        angle: values[ANGLE],
        offset: values[OFFSET],
        placement: Placement {
            turn: values[TURN],
            lift: values[LIFT],
        },
        sure: std::array::from_fn(|i| sure(&one(i))),
        seam_sure: open.0,
        least_sure_at: open.1,
        distances: problem.distances(&values).ok_or(TaughtError::NoSaddle)?,
    })
}
