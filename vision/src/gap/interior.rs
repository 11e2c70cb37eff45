//! Whether a dark run is a gap or the surface of a plate that is dark there: a scratch, a groove, a shadow.
//!
//! Whatever darkens a surface leaves it its texture, darker by the same factor; a gap has none. A veil over both adds
//! brightness and no texture. Texture is the variance of the brightness along the seam, in the columns of the strip.

use super::candidate::{Candidate, middle_value};
use super::strip::Strip;
use crate::report::ramp;

/// From an edge so far into the run its blur reaches, and its roughness \[mm\].
pub(super) const INSIDE_MM: f64 = 0.010;

/// From an edge so far onto the plate its blur and its bright lines reach, and how much of the plate is taken \[mm\].
const BESIDE_MM: f64 = 0.03;
const PLATE_MM: f64 = 0.25;

/// Columns that are judged together \[mm\].
const WINDOW_MM: f64 = 0.010;

/// Columns that have to be left of a run after its edges for its texture to be seen.
const FEWEST: f64 = 1.5;

/// What is taken for noise over what the noise is: both are seen in few pixels.
const NOISE: f32 = 1.5;

/// Least variance of a plate, over the square of its brightness: below it there is no texture to compare with.
const LEAST: f32 = 1e-5;

/// Texture over the plate's at which a run is a surface, and is not: scratches and grooves have 0.05 of the plate's brightness
/// or more.
const SURFACE: [f64; 2] = [0.04, 0.02];

/// Brightness over the plate at which a run too narrow to show texture is taken for a surface, and is not.
const BLACK: [f64; 2] = [0.10, 0.05];

/// Brightness and texture of a gap over those of a surface that are not the same thing.
const LIGHTER: f64 = 0.6;
const ROUGHER: f64 = 0.3;

/// What is inside a dark run, where it is darkest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interior {
    /// Brightness over the plate.
    pub brightness: f64,
    /// Texture over that of the plate: a surface that is darker by a factor has that factor, a gap 0. None of a run so narrow
    /// that the blur of its edges fills it.
    pub texture: Option<f64>,
    /// Variance of the plate beside it, over the square of its brightness.
    pub plate: Option<f32>,
}

impl Interior {
    /// Inside `run`. None if there is no plate beside it.
    pub fn of(strip: &Strip, run: &Candidate, pitch_mm: f64) -> Option<Self> {
        let [left, right] = run.edges;
        let bottom = middle_value(&strip.quiet[run.core[0]..=run.core[1]]);
        let inset = INSIDE_MM / pitch_mm;
        if right - left < 2.0 * inset + FEWEST {
            return Some(Self {
                brightness: f64::from(bottom),
                texture: None,
                plate: None,
            });
        }
        let [near, far] = [BESIDE_MM, BESIDE_MM + PLATE_MM].map(|mm| mm / pitch_mm);
        let beside = |from: f64, to: f64| mean(strip, columns(strip, from, to), 1.0).map(|of| of[0]);
        let sides = [beside(left - far, left - near), beside(right + near, right + far)];
        let plate = sides.into_iter().flatten().reduce(f32::min)?.max(LEAST);
        let all = columns(strip, left + inset, right - inset);
        let window = ((WINDOW_MM / pitch_mm).round() as usize).clamp(1, all.len());
        let darkest = (all.start..=all.end - window)
            .filter_map(|first| mean(strip, first..first + window, NOISE))
            .min_by(|a, b| a[1].total_cmp(&b[1]))?;
        Some(Self {
            brightness: f64::from(darkest[1]),
            texture: Some(f64::from((darkest[0].max(0.0) / plate).sqrt())),
            plate: Some(plate),
        })
    }

    /// Whether a run with this inside is so clearly a surface beside a gap with `gap` inside that the two are not mistaken.
    pub fn is_surface_beside(&self, gap: &Self) -> bool {
        let lighter = gap.brightness < LIGHTER * self.brightness;
        let rougher = match (gap.texture, self.texture) {
            (Some(gap), Some(own)) => gap < ROUGHER * own,
            _ => false,
        };
        self.emptiness() < 0.5 && gap.emptiness() >= 0.5 && (lighter || rougher)
    }

    /// How sure it is that this is no surface: 0 to 1.
    pub fn emptiness(&self) -> f64 {
        match self.texture {
            Some(texture) => ramp(texture, SURFACE[0], SURFACE[1]),
            None => ramp(self.brightness, BLACK[0], BLACK[1]),
        }
    }
}

/// The columns between two places.
pub(super) fn columns(strip: &Strip, from: f64, to: f64) -> std::ops::Range<usize> {
    let count = strip.values.len() as f64;
    let first = from.ceil().clamp(0.0, count) as usize;
    first..((to.floor() + 1.0).clamp(0.0, count) as usize).max(first)
}

/// Mean texture of columns, with `noise` times what the camera's noise adds taken away, and their mean brightness.
fn mean(strip: &Strip, columns: std::ops::Range<usize>, noise: f32) -> Option<[f32; 2]> {
    let (mut texture, mut brightness, mut count) = (0.0, 0.0, 0.0);
    for column in columns.filter(|column| strip.seen[*column]) {
        let of = strip.texture(column);
        texture += of.variance - noise * of.noise;
        brightness += of.brightness;
        count += 1.0;
    }
    (count > 0.0).then(|| [texture / count, brightness / count])
}

/// Texture of columns over the square of their brightness: of a surface that of the plate, however dark it is.
pub(super) fn relative_texture(strip: &Strip, columns: std::ops::Range<usize>) -> Option<f32> {
    let [texture, brightness] = mean(strip, columns, NOISE)?;
    Some(texture.max(0.0) / brightness.powi(2).max(f32::MIN_POSITIVE))
}
