//! Whether a dark run continues beyond the strip, as a gap does and a blob does not.
//!
//! Out of focus the gap is wide and pale, but the light it lacks, ∫(1 − I/I0) du, stays.

use super::quantile;
use super::strip::BandLine;
use super::{Candidate, between};
use crate::layer::Layer;
use crate::report::ramp;

/// Distances from the band at which the run is looked for again \[mm along the rows\].
const DISTANCES_MM: [f64; 8] = [-0.30, -0.22, -0.16, -0.11, 0.11, 0.16, 0.22, 0.30];

/// Half the height of the rows taken there, and in the band \[mm\].
const ROWS_MM: f64 = 0.0105;
const BAND_MM: f64 = 0.05;

/// Columns beside the run from which the light is measured \[mm\], and the share of them darker than what counts as the light:
/// there may be scratches among them.
const BESIDE_MM: f64 = 0.1;
const LIGHT: f64 = 0.6;

/// Margin of the window beyond edge and blur \[mm\].
const MARGIN_MM: f64 = 0.012;

/// What a gap's missing light and its middle may differ by from those in the band: a share of it, what the texture beside it does
/// (three standard deviations of plates that are ground, rolled or blasted), pixels, and what the slant is not known by.
const AREA_SHARE: f64 = 0.12;
const AREA_MM: f64 = 0.012;
const MIDDLE_SHARE: f64 = 0.03;
const MIDDLE_MM: f64 = 0.014;
const PIXELS: f64 = 0.8;
const YAW: f64 = 0.035;

/// Light along the edges, of the width of a run, from which there are bright lines; and what of them is left out of the band.
const RIM: f64 = 0.15;

/// Light to one side of the run over that to the other, against the same in the band, below which the gap is there.
const SPATTER: f32 = 0.5;

/// At how many of the distances beyond this, ahead and behind \[mm\].
const FAR_MM: f64 = 0.14;
const DARK: u32 = 2;

/// How far off, over that, a run does not continue, and does.
const OFF: [f64; 2] = [1.5, 0.75];

/// Looks for a run beyond the strip.
#[derive(Clone, Debug)]
pub(crate) struct Continuity {
    /// tan α · tan(asin NA): radius of the blur a mm of row.
    blur: f64,
    /// Columns of the window, summed over rows.
    window: Vec<f32>,
}

/// Light that is missing, and where \[mm\].
#[derive(Clone, Copy, Debug)]
struct Deficit {
    area: f64,
    middle: f64,
    /// Light that is missing or too much, and where.
    unlike: f64,
    unlike_middle: f64,
    /// Light to the left and to the right.
    lights: [f32; 2],
}

impl Continuity {
    /// For pictures of this many columns.
    pub fn new(columns: usize, tilt_rad: f64, aperture: f64) -> Self {
        Self {
            blur: tilt_rad.tan() * aperture.asin().tan(),
            window: vec![0.0; columns],
        }
    }

    /// Share of the distances at which a gap of this slant continues.
    pub fn of(&mut self, layer: &Layer, line: BandLine, candidate: &Candidate, slant: f64) -> f64 {
        let width = candidate.width() * layer.pitch_mm;
        let Some(here) = self.deficit(layer, line, candidate, slant, 0.0, BAND_MM) else {
            return 0.0;
        };
        let g = layer.pitch_mm;
        // Bright lines along the edges are cut off where they saturate, and then show more light out of the band than in it.
        let rimmed = here.unlike - here.area > RIM * width;
        let (mut points, mut count) = (0.0, 0.0);
        let mut hidden = [[0; 2]; 2];
        for distance in DISTANCES_MM {
            let Some(there) = self.deficit(layer, line, candidate, slant, distance, ROWS_MM) else {
                continue;
            };
            let area = AREA_SHARE * here.area + AREA_MM + PIXELS * g;
            let middle = MIDDLE_SHARE * width + MIDDLE_MM + PIXELS * g + YAW * distance.abs();
            let mut off =
                ((there.area - here.area).abs() / area).max((there.middle - here.middle).abs() / middle);
            if rimmed && there.unlike > RIM * here.unlike {
                off = off.min((there.unlike_middle - here.middle).abs() / middle);
            }
            for (side, hidden) in hidden.iter_mut().enumerate() {
                let share = |lights: [f32; 2]| lights[side] / lights[1 - side].max(1.0);
                let dark = share(there.lights) < SPATTER * share(here.lights);
                hidden[usize::from(distance > 0.0)] += u32::from(dark && distance.abs() > FAR_MM);
            }
            count += 1.0;
            points += ramp(off, OFF[0], OFF[1]);
        }
        // A plate that is dark both ahead and behind is none: something bright hides the edge in the band.
        if count > 0.0 && !hidden.iter().any(|ways| ways.iter().all(|dark| *dark >= DARK)) {
            points / count
        } else {
            0.0
        }
    }

    /// Light missing at a distance from the band; its middle counts from the seam's line. None outside the picture.
    fn deficit(
        &mut self,
        layer: &Layer,
        line: BandLine,
        candidate: &Candidate,
        slant: f64,
        distance: f64,
        half_rows_mm: f64,
    ) -> Option<Deficit> {
        let g = layer.pitch_mm;
        let middle = candidate.middle() + slant * distance / g;
        let row = line.row(middle) + distance / g;
        let half_rows = (half_rows_mm / g).round();
        if row - half_rows < 0.0 || row + half_rows > layer.rows as f64 - 1.0 {
            return None;
        }
        let blur = self.blur * distance.abs();
        let half = candidate.width() / 2.0 + (blur + MARGIN_MM) / g;
        let beside = (BESIDE_MM / g).round().max(2.0);
        let first = (middle - half - beside).ceil().max(0.0) as usize;
        let last = (middle + half + beside).floor().min(layer.columns as f64 - 1.0) as usize;
        if last < first + 4 {
            return None;
        }
        let window = &mut self.window[..=last - first];
        window.fill(0.0);
        let rows =
            (row - half_rows).round() as usize..=((row + half_rows).round() as usize).min(layer.rows - 1);
        for row in rows {
            for (sum, pixel) in window.iter_mut().zip(&layer.row(row)[first..=last]) {
                *sum += f32::from(*pixel);
            }
        }
        let left = (middle - half).ceil().max(first as f64) as usize - first;
        let right = (middle + half).floor().min(last as f64) as usize - first;
        let lights = [side_light(&window[..left]), side_light(&window[right + 1..])];
        let lights = match lights {
            [Some(left), Some(right)] => [left, right],
            [Some(light), None] | [None, Some(light)] => [light, light],
            [None, None] => return None,
        };
        let (mut area, mut moment, mut unlike, mut unlike_moment) = (0.0, 0.0, 0.0, 0.0);
        for (k, value) in window[left..=right].iter().enumerate() {
            let share = (k as f32 + 0.5) / (right - left + 1) as f32;
            let missing = f64::from(1.0 - value / between(lights, share).max(1.0));
            area += missing;
            let off = (first + left + k) as f64 - middle;
            moment += missing * off;
            unlike += missing.abs();
            unlike_moment += missing.abs() * off;
        }
        let middle_of = |moment: f64, area: f64| {
            if area.abs() > 1e-3 {
                moment / area * g
            } else {
                f64::INFINITY
            }
        };
        Some(Deficit {
            area: area * g,
            middle: middle_of(moment, area),
            unlike: unlike * g,
            unlike_middle: middle_of(unlike_moment, unlike),
            lights,
        })
    }
}

/// Light of the columns to one side, if there are any.
fn side_light(values: &[f32]) -> Option<f32> {
    let mut sorted = [0.0; 64];
    let count = values.len().min(64);
    sorted[..count].copy_from_slice(&values[..count]);
    if count < 2 {
        None
    } else {
        quantile(&mut sorted[..count], LIGHT)
    }
}
