//! Whether a dark run is a gap or the surface of a plate that is dark there: a scratch, a groove, a shadow.
//!
//! Whatever darkens a surface leaves it its texture, darker by the same factor; a gap has none. A veil over both adds
//! brightness and no texture. Texture is the variance of the brightness along the seam, and across it in runs wide enough.

use super::candidate::{Candidate, middle_value};
use super::roughness::{Course, Roughness};
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

/// Columns away from its edges up to which a run is so narrow that light of the plates reaches all of them.
const NARROW: usize = 5;

/// Times that has to find room between the edges.
const ACROSS: usize = 3;

/// Columns that are judged together, at least \[mm\].
const WINDOW_MM: f64 = 0.010;

/// Darkest surface over the plate: scratches and grooves have 0.05 of its brightness or more; and how much of a surface's
/// brightness is not a veil's.
const DARKEST: f64 = 0.05;
const VEILED: f64 = 0.8;

/// Variance of the texture that a surface would have, in standard errors of the noise's, below which the two cannot be told apart.
const UNSURE: f32 = 1.2;

/// Variance over that of a surface at which a run is one, and is not: of a run that nothing is known of, and of one where a
/// gap is expected.
const SURFACE: [f64; 2] = [0.45, 0.20];
const EXPECTED: [f64; 2] = [0.9, 0.5];

/// Brightness over the plate at which a run may be a surface, with what lies over all of a picture, and is too dark for one.
const BLACKEST: [f64; 2] = [0.055, 0.052];

/// Brightness over the plate at which a run too narrow to show texture is taken for a surface, and is not; the same.
const BLACK: [f64; 2] = [0.19, 0.14];
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
}

impl Interior {
    /// Inside `run`, where the darkest `share` of it is.
    pub fn of(strip: &Strip, run: &Candidate, share: f64, pitch_mm: f64) -> Self {
        let bottom = middle_value(&strip.quiet[run.core[0]..=run.core[1]]);
        let unseen = Self {
            brightness: f64::from(bottom),
            texture: None,
        };
        let inset = INSIDE_MM / pitch_mm;
        let (course, narrowest) = Course::between_edges(strip, run);
        let room = narrowest / 2.0 - inset;
        let inside = columns(strip, run.middle() - room, run.middle() + room);
        if room < 0.0 || inside.is_empty() {
            return unseen;
        }
        // Differences across are not to reach the edges.
        let reach = (ACROSS_MM / pitch_mm).round() as usize;
        let reach = reach.min((inside.len() - 1) / ACROSS);
        let across = (reach > 1).then_some(reach);
        let course = if inside.len() < NARROW {
            course.darker(strip)
        } else {
            course
        };
        let straight = course.straightened(strip);
        let plate = beside(strip, run.edges, pitch_mm)
            .into_iter()
            .filter_map(|side| Roughness::of(strip, side, &straight, across))
            .map(|side| side.variance - side.noise)
            .reduce(f32::min);
        let Some(plate) = plate else {
            return unseen;
        };
        let margin = across.unwrap_or(0);
        let inside = inside.start + margin..inside.end - margin;
        let window = (WINDOW_MM / pitch_mm).round() as usize;
        let window = window
            .max((share * inside.len() as f64) as usize)
            .clamp(1, inside.len());
        let darkest = (inside.start..=inside.end - window)
            .step_by((window / 4).max(1))
            .filter_map(|first| Roughness::of(strip, first..first + window, &course, across))
            .min_by(|a, b| a.brightness.total_cmp(&b.brightness));
        let Some(darkest) = darkest else {
            return unseen;
        };
        let brightness = f64::from(darkest.brightness);
        let least = (DARKEST.max(VEILED * brightness)).powi(2) * f64::from(plate);
        if least < f64::from(UNSURE * darkest.error) {
            return Self { brightness, ..unseen };
        }
        let texture = f64::from(darkest.excess()) / least;
        Self {
            brightness,
            texture: Some(texture),
        }
    }

    /// Whether a run with this inside is so clearly a surface beside a gap with `gap` inside that the two are not mistaken. Of
    /// two runs that are `alike` texture is not enough: of many grooves one shows little by chance.
    pub fn is_surface_beside(&self, gap: &Self, alike: bool) -> bool {
        let lighter = gap.brightness < LIGHTER * self.brightness;
        let rougher = match (gap.texture, self.texture) {
            (Some(gap), Some(own)) => !alike && gap < ROUGHER * own,
            _ => false,
        };
        self.emptiness(false) < 0.5 && gap.emptiness(false) >= 0.5 && (lighter || rougher)
    }

    /// Whether a run with this inside is seen to be empty, and darker than the other.
    pub fn is_emptier_than(&self, other: &Self) -> bool {
        self.texture.is_some() && self.emptiness(false) >= 0.5 && self.brightness < other.brightness
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

/// The plate left and right of a run, where the blur of its edges and bright lines along them do not reach.
pub(super) fn beside(strip: &Strip, edges: [f64; 2], pitch_mm: f64) -> [Range<usize>; 2] {
    let [left, right] = edges;
    let [near, far] = [BESIDE_MM, BESIDE_MM + PLATE_MM].map(|mm| mm / pitch_mm);
    [
        columns(strip, left - far, left - near),
        columns(strip, right + near, right + far),
    ]
}

/// The columns between two places.
pub(super) fn columns(strip: &Strip, from: f64, to: f64) -> Range<usize> {
    let count = strip.values.len() as f64;
    let first = from.ceil().clamp(0.0, count) as usize;
    first..((to.floor() + 1.0).clamp(0.0, count) as usize).max(first)
}
