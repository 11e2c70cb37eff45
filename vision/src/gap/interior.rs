//! Whether a dark run is a gap or the surface of a plate that is dark there: a scratch, a groove, a shadow.
//!
//! Whatever darkens a surface leaves it its texture, darker by the same factor; a gap has none. A veil over both adds
//! brightness and no texture. Texture is the variance of the brightness along the seam, and across it in runs wide enough.

use super::candidate::{Candidate, middle_value};
use super::strip::Strip;
use crate::report::ramp;
use std::ops::Range;

/// From an edge so far into the run its blur reaches, and its roughness \[mm\].
pub(super) const INSIDE_MM: f64 = 0.008;

/// From an edge so far onto the plate its blur and its bright lines reach, and how much of the plate is taken \[mm\].
const BESIDE_MM: f64 = 0.03;
const PLATE_MM: f64 = 0.25;

/// Farthest that differences of texture across the seam reach \[mm\].
const ACROSS_MM: f64 = 0.010;

/// Columns that are judged together, at least \[mm\].
const WINDOW_MM: f64 = 0.010;

/// Columns that have to be left of a run after its edges for its texture to be seen.
const FEWEST: f64 = 1.5;

/// Darkest surface over the plate: scratches and grooves have 0.05 of its brightness or more; and how much of a surface's
/// brightness is not a veil's.
const DARKEST: f64 = 0.05;
const VEILED: f64 = 0.5;

/// Variance of the texture that a surface would have, in standard errors of the noise's, below which the two cannot be told apart.
const UNSURE: f32 = 3.0;

/// Standard errors over the noise that are taken for noise.
const MARGIN: f32 = 1.5;

/// Relative standard error of a variance from the median of n differences that overlap: this over √n.
const MEDIAN_ERROR: f32 = 2.9;

/// Variance over that of a surface at which a run is one, and is not: of a run that nothing is known of, and of one where a
/// gap is expected.
const SURFACE: [f64; 2] = [0.40, 0.10];
const EXPECTED: [f64; 2] = [0.9, 0.5];

/// Brightness over the plate at which a run may be a surface, with what lies over all of a picture, and is too dark for one.
const BLACKEST: [f64; 2] = [0.07, 0.05];

/// Brightness over the plate at which a run too narrow to show texture is taken for a surface, and is not; the same.
const BLACK: [f64; 2] = [0.28, 0.16];
const EXPECTED_BLACK: [f64; 2] = [0.5, 0.3];

/// Brightness and texture of a gap over those of a surface that are not the same thing.
const LIGHTER: f64 = 0.6;
const ROUGHER: f64 = 0.3;

/// What is inside a dark run, where it is darkest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interior {
    /// Brightness over the plate.
    pub brightness: f64,
    /// Variance of its texture over the least that a surface so dark would have: 0 of a gap. None of a run so narrow that the
    /// blur of its edges fills it, and where it would be lost in noise.
    pub texture: Option<f64>,
    /// Variance of the plate beside it, over the square of its brightness.
    pub plate: Option<f32>,
}

impl Interior {
    /// Inside `run`, where the darkest `share` of it is.
    pub fn of(strip: &Strip, run: &Candidate, share: f64, pitch_mm: f64) -> Self {
        let [left, right] = run.edges;
        let bottom = middle_value(&strip.quiet[run.core[0]..=run.core[1]]);
        let unseen = Self {
            brightness: f64::from(bottom),
            texture: None,
            plate: None,
        };
        let inset = INSIDE_MM / pitch_mm;
        let inside = columns(strip, left + inset, right - inset);
        if right - left < 2.0 * inset + FEWEST || inside.is_empty() {
            return unseen;
        }
        let reach = ((ACROSS_MM / pitch_mm).round() as usize).clamp(1, 1 + inside.len() / 4);
        // Differences across reach further.
        let across = inside.start + reach..inside.end.saturating_sub(reach);
        let [near, far] = [BESIDE_MM, BESIDE_MM + PLATE_MM].map(|mm| mm / pitch_mm);
        let all = 0..if across.is_empty() { 0 } else { strip.values.len() };
        let sides = [
            Roughness::of(strip, columns(strip, left - far, left - near), &all, reach),
            Roughness::of(strip, columns(strip, right + near, right + far), &all, reach),
        ];
        let plate = sides.into_iter().flatten().map(|side| side.variance - side.noise);
        let Some(plate) = plate.reduce(f32::min) else {
            return unseen;
        };
        let window = (WINDOW_MM / pitch_mm).round() as usize;
        let window = window
            .max((share * inside.len() as f64) as usize)
            .clamp(1, inside.len());
        let darkest = (inside.start..=inside.end - window)
            .filter_map(|first| Roughness::of(strip, first..first + window, &across, reach))
            .min_by(|a, b| a.brightness.total_cmp(&b.brightness));
        let Some(darkest) = darkest else {
            return unseen;
        };
        let brightness = f64::from(darkest.brightness);
        let least = (DARKEST.max(VEILED * brightness)).powi(2) * f64::from(plate);
        if least < f64::from(UNSURE * darkest.error()) {
            return Self { brightness, ..unseen };
        }
        Self {
            brightness,
            texture: Some(f64::from(darkest.excess()) / least),
            plate: Some(plate),
        }
    }

    /// Whether a run with this inside is so clearly a surface beside a gap with `gap` inside that the two are not mistaken.
    pub fn is_surface_beside(&self, gap: &Self) -> bool {
        let lighter = gap.brightness < LIGHTER * self.brightness;
        let rougher = match (gap.texture, self.texture) {
            (Some(gap), Some(own)) => gap < ROUGHER * own,
            _ => false,
        };
        self.emptiness(false) < 0.5 && gap.emptiness(false) >= 0.5 && (lighter || rougher)
    }

    /// How sure it is that this is no surface: 0 to 1. Less is needed of what is `expected`: a run where the gap of the
    /// pictures before has to be, and as wide as that was.
    pub fn emptiness(&self, expected: bool) -> f64 {
        let blackness = ramp(self.brightness, BLACKEST[0], BLACKEST[1]);
        let emptiness = match self.texture {
            Some(texture) if expected => ramp(texture, EXPECTED[0], EXPECTED[1]),
            Some(texture) => ramp(texture, SURFACE[0], SURFACE[1]),
            None if expected => ramp(self.brightness, EXPECTED_BLACK[0], EXPECTED_BLACK[1]),
            None => ramp(self.brightness, BLACK[0], BLACK[1]),
        };
        emptiness.max(blackness)
    }
}

/// The columns between two places.
pub(super) fn columns(strip: &Strip, from: f64, to: f64) -> Range<usize> {
    let count = strip.values.len() as f64;
    let first = from.ceil().clamp(0.0, count) as usize;
    first..((to.floor() + 1.0).clamp(0.0, count) as usize).max(first)
}

/// Roughness of some columns of the strip.
#[derive(Clone, Copy, Debug)]
struct Roughness {
    /// Mean brightness over the light.
    brightness: f32,
    /// Variance of the brightness, along the seam and, of the columns asked for, across.
    variance: f32,
    /// What of it noise makes.
    noise: f32,
    /// Differences of which it is the variance.
    count: f32,
}

impl Roughness {
    fn of(strip: &Strip, columns: Range<usize>, across: &Range<usize>, reach: usize) -> Option<Self> {
        let mut sum = Self {
            brightness: 0.0,
            variance: 0.0,
            noise: 0.0,
            count: 0.0,
        };
        let groups = strip.groups as f32;
        let mut count = 0.0;
        for column in columns.filter(|column| strip.seen[*column]) {
            let of = strip.texture(column, reach);
            let across = of.across.filter(|_| across.contains(&column));
            sum.brightness += of.brightness;
            sum.variance += of.along + across.unwrap_or(0.0);
            let sides = if across.is_some() { 2.0 } else { 1.0 };
            sum.noise += of.noise * sides;
            sum.count += groups * sides;
            count += 1.0;
        }
        (count > 0.0).then(|| Self {
            brightness: sum.brightness / count,
            variance: sum.variance / count,
            noise: sum.noise / count,
            count: sum.count,
        })
    }

    /// Standard error of the noise's variance.
    fn error(&self) -> f32 {
        MEDIAN_ERROR * self.noise / self.count.sqrt()
    }

    /// Variance that noise does not make.
    fn excess(&self) -> f32 {
        (self.variance - self.noise - MARGIN * self.error()).max(0.0)
    }
}

/// Texture of columns over the square of their brightness: of a surface that of the plate, however dark it is.
pub(super) fn relative_texture(strip: &Strip, columns: Range<usize>) -> Option<f32> {
    let of = Roughness::of(strip, columns.clone(), &columns, 1)?;
    Some(of.excess() / of.brightness.powi(2).max(f32::MIN_POSITIVE))
}
