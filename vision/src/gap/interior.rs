//! Whether a dark run is a gap or the surface of a plate that is dark there: a scratch, a groove, a shadow.
//!
//! Whatever darkens a surface leaves it its texture, darker by the same factor; a gap has none. A veil over both adds
//! brightness and no texture. Texture is the variance of the brightness along the seam, and across it in runs wide enough.

use super::candidate::{Candidate, crossing, middle_value};
use super::roughness::{Course, Roughness};
use super::strip::Strip;
use super::{between, quantile};
use crate::report::ramp;
use std::ops::Range;

/// From an edge so far into the run its blur reaches, and its roughness \[mm\].
pub(super) const INSIDE_MM: f64 = 0.008;

/// Light above the darkest from which an edge reaches into a run, of the way up to the plate, and how far it reaches beyond
/// that \[mm\].
const LIT: f32 = 0.08;
const LIT_MM: f64 = 0.004;

/// From an edge so far onto the plate its blur and its bright lines reach, and how much of the plate is taken \[mm\].
const BESIDE_MM: f64 = 0.03;
const PLATE_MM: f64 = 0.25;

/// Share of the plate's columns darker than what counts as its light, and most columns that are looked at.
const LIGHT: f64 = 0.7;
const MOST_PLATE: usize = 256;

/// Farthest that differences of texture across the seam reach \[mm\].
const ACROSS_MM: f64 = 0.010;

/// Times that has to find room between the edges.
const ACROSS: usize = 3;

/// Columns that are judged together, at least \[mm\].
const WINDOW_MM: f64 = 0.010;

/// Darkest surface over the plate: scratches and grooves have 0.05 of its brightness or more; and how much of a surface's
/// brightness is not a veil's.
const DARKEST: f64 = 0.05;
const VEILED: f64 = 0.8;

/// Texture of a run beside a plate that shows none.
const HIDDEN: [f64; 2] = [0.0, f64::INFINITY];

/// Variance of the texture that a surface would have, in standard errors of the noise's, below which the two cannot be told apart.
const UNSURE: f64 = 0.4;

/// Variance over that of a surface at which a run is one, and is not: of a run that nothing is known of, and of one where a
/// gap is expected.
const SURFACE: [f64; 2] = [0.6, 0.3];
const EXPECTED: [f64; 2] = [0.9, 0.5];

/// The same of a run that is darker than any surface in the mean: what lies in gaps is dark and textured too.
const BLACK_SURFACE: [f64; 2] = [0.9, 0.6];

/// Brightness over the plate at which a run may be a surface, and is too dark for one.
const BLACKEST: [f64; 2] = [0.055, 0.052];

/// Brightness over the plate at which a run whose texture noise would hide is taken for a surface, and is not; and one that is
/// too narrow to show any, as light of its edges fills it.
const BLACK: [f64; 2] = [0.16, 0.12];
const NARROW_BLACK: [f64; 2] = [0.20, 0.16];

/// The same of one where a gap is expected.
const EXPECTED_BLACK: [f64; 2] = [0.5, 0.3];

/// Brightness and texture of a gap over those of a surface that are not the same thing.
const LIGHTER: f64 = 0.6;
const ROUGHER: f64 = 0.3;

/// What is inside a dark run, where it is emptiest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interior {
    /// Brightness over the plate.
    pub brightness: f64,
    /// Variance of its texture over that of the plate, and the standard error of what noise makes of it: 0 of a gap, the square
    /// of its factor of a darker surface. None of a run so narrow that the blur of its edges fills it.
    texture: Option<[f64; 2]>,
}

impl Interior {
    /// Inside `run`, in the emptiest window of this share of it.
    pub fn of(strip: &Strip, run: &Candidate, share: f64, pitch_mm: f64) -> Self {
        let course = Course::between_edges(strip, run);
        let unseen = Self {
            brightness: f64::from(middle_value(&strip.quiet[run.core[0]..=run.core[1]])),
            texture: None,
        };
        let inside = unlit(strip, run, pitch_mm);
        if inside.is_empty() {
            return unseen;
        }
        // Differences across are not to reach the edges.
        let reach = (ACROSS_MM / pitch_mm).round() as usize;
        let reach = reach.min((inside.len() - 1) / ACROSS);
        let across = (reach > 1).then_some(reach);
        let margin = across.unwrap_or(0);
        let inside = inside.start + margin..inside.end - margin;
        let window = (WINDOW_MM / pitch_mm).round() as usize;
        let window = window
            .max((share * inside.len() as f64) as usize)
            .clamp(1, inside.len());
        let straight = Course::straight(strip);
        let plate = beside(strip, run.edges, pitch_mm)
            .into_iter()
            .filter_map(|side| {
                let light = light(strip, side.clone())?;
                let of = Roughness::of(strip, side, &straight, across)?;
                Some((of.variance - of.noise) * (light / of.brightness).powi(2))
            })
            .reduce(f32::min);
        let Some(plate) = plate.filter(|plate| *plate > 0.0) else {
            return Self {
                texture: Some(HIDDEN),
                ..unseen
            };
        };
        let emptiest = (inside.start..=inside.end - window)
            .step_by((window / 4).max(1))
            .filter_map(|first| Roughness::of(strip, first..first + window, &course, across))
            .min_by(|a, b| (a.variance - a.noise).total_cmp(&(b.variance - b.noise)));
        let Some(emptiest) = emptiest else {
            return unseen;
        };
        let brightness = f64::from(emptiest.brightness);
        Self {
            brightness,
            texture: Some([emptiest.excess(), emptiest.error].map(|variance| f64::from(variance / plate))),
        }
    }

    /// Whether a run with this inside is so clearly a surface beside a gap with `gap` inside that the two are not mistaken. Of
    /// two runs that are `alike` texture is not enough: of many grooves one shows little by chance.
    pub fn is_surface_beside(&self, gap: &Self, alike: bool) -> bool {
        let lighter = gap.brightness < LIGHTER * self.brightness;
        let rougher = match (gap.texture_over(DARKEST), self.texture_over(DARKEST)) {
            (Some(gap), Some(own)) => !alike && gap < ROUGHER * own,
            _ => false,
        };
        self.emptiness(false) < 0.5 && gap.emptiness(false) >= 0.5 && (lighter || rougher)
    }

    /// Whether a run with this inside is seen to be empty, and darker than the other.
    pub fn is_emptier_than(&self, other: &Self) -> bool {
        self.is_seen() && self.emptiness(false) >= 0.5 && self.brightness < other.brightness
    }

    /// How sure it is that this is no surface: 0 to 1. Less is needed of what is `expected`: a run where the gap of the
    /// pictures before has to be, and as wide as that was.
    pub fn emptiness(&self, expected: bool) -> f64 {
        let blackness = ramp(self.brightness, BLACKEST[0], BLACKEST[1]);
        let texture = self.texture_over(DARKEST);
        let as_bright = self.texture_over(DARKEST.max(VEILED * self.brightness));
        if expected {
            let emptiness = match as_bright {
                Some(texture) => ramp(texture, EXPECTED[0], EXPECTED[1]),
                None => ramp(self.brightness, EXPECTED_BLACK[0], EXPECTED_BLACK[1]),
            };
            return emptiness.max(blackness);
        }
        match texture.or(as_bright) {
            Some(texture) => {
                let black = ramp(texture, BLACK_SURFACE[0], BLACK_SURFACE[1]);
                ramp(texture, SURFACE[0], SURFACE[1]).max(black.min(blackness))
            }
            None if self.texture.is_some() => ramp(self.brightness, BLACK[0], BLACK[1]),
            None => ramp(self.brightness, NARROW_BLACK[0], NARROW_BLACK[1]),
        }
    }

    /// Whether it shows if this is a surface.
    pub fn is_seen(&self) -> bool {
        self.texture_over(DARKEST).is_some()
    }

    /// Its texture over that of a surface which is `factor` of the plate's brightness; None if noise would hide that.
    fn texture_over(&self, factor: f64) -> Option<f64> {
        let [texture, error] = self.texture?;
        let surface = factor.powi(2);
        (surface >= UNSURE * error).then_some(texture / surface)
    }
}

/// The columns of a run about its darkest one that no light of its edges reaches.
fn unlit(strip: &Strip, run: &Candidate, pitch_mm: f64) -> Range<usize> {
    let quiet = &strip.quiet;
    let within = columns(strip, run.edges[0], run.edges[1]);
    let Some(darkest) = within.min_by(|a, b| quiet[*a].total_cmp(&quiet[*b])) else {
        return 0..0;
    };
    let level = between([quiet[darkest], 1.0], LIT);
    let [left, right] = [0, 1].map(|side| crossing(quiet, darkest, side, level).unwrap_or(run.edges[side]));
    let inset = LIT_MM / pitch_mm;
    let [left, right] = [left.max(run.edges[0]) + inset, right.min(run.edges[1]) - inset];
    if right < left {
        return 0..0;
    }
    columns(strip, left, right)
}

/// Brightness of columns that shadows and scratches do not darken.
fn light(strip: &Strip, columns: Range<usize>) -> Option<f32> {
    let mut values = [0.0; MOST_PLATE];
    let count = columns.len().min(MOST_PLATE);
    values[..count].copy_from_slice(&strip.quiet[columns.start..columns.start + count]);
    quantile(&mut values[..count], LIGHT)
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
