//! Both edges of the gap as lines, from all rows of the strip.

use super::candidate::{Candidate, middle_value, plateau, rise};
use super::strip::{GROUPS, Strip};
use super::{between, median};
use nalgebra::{Matrix3, Vector3};

/// Slant of the edges before they are seen: 0 ± this.
const SLANT_SIGMA: f64 = 0.05;

/// Residual up to which an edge belongs to its line \[mm\], or this many columns.
const INLIER_MM: f64 = 0.006;
const INLIER_COLUMNS: f64 = 0.6;

/// Smallest scale of the residuals \[columns\].
const SMALLEST_SCALE: f64 = 0.05;

/// Rounds of the fit.
const ROUNDS: usize = 6;

/// The gap on the band.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges {
    /// Column of its middle.
    pub middle: f64,
    /// Width \[columns\].
    pub width: f64,
    /// Slant against the rows of the straightened strip \[columns a row\].
    pub slant: f64,
    /// Share of the readings that belong to the lines.
    pub inliers: f64,
    /// Robust standard deviation of a reading \[columns\].
    pub residual: f64,
    /// Readings.
    pub readings: usize,
    /// Standard deviation of the slant.
    pub slant_sigma: f64,
}

/// Reads the edges of a candidate in every group of rows and fits two parallel lines, Cauchy-weighted.
pub(crate) fn fit_edges(strip: &Strip, candidate: &Candidate, pitch_mm: f64) -> Option<Edges> {
    let mut readings = [(0.0, 0.0, 0.0); 2 * GROUPS];
    let mut count = 0;
    for group in 0..strip.groups {
        let offset = strip.offset(group);
        for (side, sign) in [-0.5, 0.5].into_iter().enumerate() {
            if let Some(column) = read(strip, candidate, group, side, pitch_mm) {
                readings[count] = (column, sign, offset);
                count += 1;
            }
        }
    }
    let readings = &readings[..count];
    if count < strip.groups {
        return None;
    }
    let mut at = Vector3::new(candidate.middle(), candidate.width(), strip.slant);
    let mut residuals = [0.0_f32; 2 * GROUPS];
    let mut scale = 0.0;
    let mut slant_sigma = SLANT_SIGMA;
    for _ in 0..ROUNDS {
        for (to, (column, sign, offset)) in residuals.iter_mut().zip(readings) {
            *to = (column - at[0] - sign * at[1] - offset * at[2]).abs() as f32;
        }
        scale = (1.4826 * f64::from(median(&mut residuals[..count])?)).max(SMALLEST_SCALE);
        let mut matrix = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for (column, sign, offset) in readings {
            let row = Vector3::new(1.0, *sign, *offset);
            let residual = column - row.dot(&at);
            let weight = 1.0 / (1.0 + (residual / (2.0 * scale)).powi(2)) / (scale * scale);
            matrix += row * row.transpose() * weight;
            right += row * (weight * column);
        }
        matrix[(2, 2)] += SLANT_SIGMA.powi(-2);
        let inverse = matrix.try_inverse()?;
        slant_sigma = inverse[(2, 2)].sqrt();
        at = inverse * right;
    }
    let limit = (INLIER_MM / pitch_mm).max(INLIER_COLUMNS);
    let inliers = readings
        .iter()
        .filter(|(column, sign, offset)| (column - at[0] - sign * at[1] - offset * at[2]).abs() < limit)
        .count();
    Some(Edges {
        middle: at[0],
        width: at[1],
        slant: at[2],
        inliers: inliers as f64 / (2 * strip.groups) as f64,
        residual: scale,
        readings: count,
        slant_sigma,
    })
}

/// Column of an edge in one group of rows, at half level of the group itself.
fn read(strip: &Strip, candidate: &Candidate, group: usize, side: usize, pitch_mm: f64) -> Option<f64> {
    let columns = strip.values.len();
    let shift = strip.slant * strip.offset(group);
    let value = |column: usize| strip.values[column][group];
    let place = |column: f64| column.round().clamp(0.0, columns as f64 - 1.0) as usize;
    let core = candidate.core.map(|column| place(column as f64 + shift));
    let mut inside = [0.0; 64];
    let count = (core[1] - core[0] + 1).min(64);
    for (k, to) in inside[..count].iter_mut().enumerate() {
        *to = value(core[0] + k * (core[1] - core[0] + 1) / count);
    }
    let bottom = middle_value(&inside[..count]);
    let outside = plateau(value, columns, candidate.edges[side] + shift, side, pitch_mm)?;
    if outside <= bottom {
        return None;
    }
    // From a little inside: rough edges reach into the core.
    let inset = ((core[1] - core[0]) / 2).min(3);
    let from = if side == 0 {
        core[0] + inset
    } else {
        core[1] - inset
    };
    let reach = inset + (0.03 / pitch_mm).ceil() as usize;
    rise(value, columns, from, side, between([bottom, outside], 0.5), reach)
}
