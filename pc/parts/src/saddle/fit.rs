//! The saddle that taught points lie on, by least squares (mathematics 1.5).
//!
//! Around the branch the seam is, up to small terms, z = z₀ + a cosθ + b sinθ + c cos2θ: the offset makes a, the
//! angle b, the radius of the main pipe c, and where the machine stands z₀ and the zero of θ. So from points all
//! around all of them can be found. A point is worth one of these unknowns, and one more point is asked for, so
//! that there is something to check by; the radius of the branch shows in every point besides.

use super::error::TaughtError;
use super::least_squares::{ANGLE, BRANCH, LIFT, MAIN, OFFSET, Problem, TURN, UNKNOWNS, Values, height};
use super::seam::Placement;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Keys of the unknowns δ, β, R.
const KEYS: [&str; 3] = ["offset_mm", "angle_deg", "main_diameter_mm"];

/// Points that are not further apart than this part of their radius are at one place.
const ONE_PLACE: f64 = 0.1;
/// Points whose distance from a line is less than this part of their spread are on the line: 14° of a circle.
const ON_LINE: f64 = 0.03;
/// Fits whose sums of squares differ by less than so many variances of the noise cannot be distinguished.
const ALIKE: f64 = 9.0;
/// Noise of a taught point at least \[mm\]: what hands and eyes are good for.
const NOISE: f64 = 0.05;
/// Two standard deviations are called sure.
const SURE: f64 = 2.0;
/// Waists at which the fitted seam is asked how sure it is.
const ASKED: usize = 72;

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
    let off_line = points
        .iter()
        .map(|point| (point - from).cross(&chord).norm() / spread_mm);
    let off_line_mm = off_line.fold(0.0, f64::max);
    if off_line_mm < ON_LINE * spread_mm {
        return Err(TaughtError::OnLine {
            off_line_mm,
            spread_mm,
        });
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
