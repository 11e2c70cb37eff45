//! Where the gap ends within a picture: where a plate ends, or where something closes the gap.
//!
//! Every row shows another place along travel. Away from the sharp band it is blurred, by 0.1 mm a mm at an aperture of 0.1, but as
//! bright as in focus: plates that end fall from their brightness to that of the gap, a gap that closes rises from its own. Both go
//! half way where they end, however blurred. Anything else that is dark or bright on the seam (spatter, scratches, shadows of
//! dirt) is short.

mod appearance;
mod course;

use crate::detector::Detector;
use crate::layer::Layer;
use crate::report::{Form, Measured};
use appearance::{GapLine, Profile, Rows};
use course::{Course, Rule, Step};

/// How a gap ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndKind {
    /// One plate ends there, or both.
    Plate,
    /// Something closes it there, such as a tack.
    Closed,
}

/// The end of a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapEnd {
    /// How it ends.
    pub kind: EndKind,
    /// a of the end \[mm\].
    pub travel_mm: f64,
    /// u of the middle of the gap there \[mm\].
    pub lateral_mm: f64,
    /// n of the plates there \[mm\].
    pub height_mm: f64,
    /// Standard deviation of `travel_mm` \[mm\].
    pub sigma_mm: f64,
}

/// Height of the rows that are taken together \[mm along the rows\], and most of them.
const BIN_MM: f64 = 0.0138;
const MOST: usize = 256;

/// Rows around the band that show what plates and gap look like \[mm along the rows\].
const NEAR_MM: f64 = 0.12;

/// Plate beside the gap that is looked at, and what is left out beside gap and blur \[mm\]: most of a tack.
const PLATE_MM: f64 = 0.2;
const CLEAR_MM: f64 = 0.1;

/// What is left out beside gap and blur where it is looked for a tack that is wider than the gap \[mm\], and its brightness over the
/// plates': there is none between the first two, and one outside the others.
const FLANK_MM: f64 = 0.02;
const BARE: [f64; 2] = [0.85, 1.2];
const COVERED: [f64; 2] = [0.7, 1.4];

/// Share of the gap's width in whose middle it is looked at.
const MIDDLE: f64 = 0.5;

/// Way along travel for which a plate has to be missing, and a gap closed \[mm\]: spatter is up to 0.4 mm wide, and nothing else
/// takes a whole plate away.
const MISSING_MM: f64 = 0.2;
const CLOSED_MM: f64 = 0.4;

/// Way along travel before the end that is compared with it \[mm\].
const BEFORE_MM: f64 = 0.16;

/// A plate is there from the first of these shares of its brightness near the band, and missing below the other.
const PLATE: [f64; 2] = [0.6, 0.25];

/// A gap is open between the first two, of what it has near the band, blurred, and closed outside the other two.
const OPEN: [f64; 2] = [0.75, 1.3];
const CLOSED: [f64; 2] = [0.68, 1.7];

/// Share by which the plates may be brighter or darker than near the band where a gap is seen to be closed: more is light.
const LIGHT: f64 = 0.25;

/// Share of its darkness near the band that a blurred gap has to keep: what is fainter cannot be told from texture.
const FAINT: f64 = 0.35;

/// Share of a step that is made within its blur: light that changes along the seam takes longer.
const SHARP: f64 = 0.7;
/// Share of a step by which what is as far on the other side of the band differs from it: lines along the edges look alike there.
const APART: f64 = 0.6;
/// Way along travel on either side of the blur in which it is looked for \[mm\].
const SHARP_MM: f64 = 0.08;

/// Least share of the brighter plate's brightness at which the darker one can be told from the gap.
const DIM: f64 = 0.15;

/// Standard deviation of an end in a picture without noise \[mm\], and what the height of the plate is not known to, for each mm from
/// the band.
const FLOOR_MM: f64 = 0.004;
const SLOPE: f64 = 0.01;

/// Where a plate is missing nearer to the band than this, its height is not known as well, to the other where it ends at the band
/// \[mm\].
const SPOILT_MM: [f64; 2] = [0.18, 0.04];

/// Bins to either side over which the light is taken.
const SMOOTH: usize = 5;

/// Two ends that are nearer are the same \[mm\].
const SAME_MM: f64 = 0.12;

/// The mean of what is known.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let known = values.filter(|value| !value.is_nan());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

impl Detector {
    /// Where the gap of the picture that was measured last ends in it, `measured` being that gap: behind the band (a less than that
    /// of the band) and ahead of it. None where it goes on to the border of the picture, and where that cannot be told: ends within
    /// 0.2 mm of the border, closed ones within 0.4 mm.
    pub fn gap_ends(&self, measured: &Measured) -> [Option<GapEnd>; 2] {
        if measured.form != Form::Gap || measured.width_mm <= 0.0 {
            return [None; 2];
        }
        let layer = self.layer();
        let g = layer.pitch_mm;
        let (sin, cos) = self.optics.tilt_rad.sin_cos();
        let bin = ((BIN_MM / g).round() as usize)
            .max(layer.rows.div_ceil(MOST))
            .max(1);
        let blur = self.optics.tilt_rad.tan() * self.optics.aperture.asin().tan();
        let line = GapLine {
            row: (measured.height_mm / sin - layer.origin_mm[0]) / g,
            column: (measured.lateral_mm - layer.origin_mm[1]) / g,
            slant: measured.yaw_rad.tan() / cos,
            tilt: measured.roll * sin,
            half: measured.width_mm / 2.0 / g,
            blur,
        };
        let rows = Rows::of(layer, &line, bin);
        let band = (line.row / bin as f64).floor();
        if !(0.0..rows.count as f64).contains(&band) {
            return [None; 2];
        }
        let band = band as usize;
        let near = (NEAR_MM / g / bin as f64).round().max(1.0) as usize;
        let near = band.saturating_sub(near)..(band + near + 1).min(rows.count);
        let Some(courses) = Courses::new(layer, &rows, &line, bin, near) else {
            return [None; 2];
        };
        // Along the gap a row further is so far further along travel.
        let per_row = g * (1.0 - measured.roll * line.slant * sin) / cos;
        let beside_mm = (measured.width_mm / 2.0 + CLEAR_MM + PLATE_MM / 2.0) / 2.0;
        [false, true].map(|ahead| {
            let rule = Rule {
                band: if ahead { band } else { rows.count - 1 - band },
                per_mm: 1.0 / (bin as f64 * per_row),
                blur,
            };
            let (kind, step, of_one) = courses.end(&rule, ahead)?;
            let rows_on = step.place * bin as f64 - 0.5;
            let row = if ahead {
                rows_on
            } else {
                (rows.count * bin) as f64 - 1.0 - rows_on
            };
            let way = (row - line.row) * per_row;
            let lateral_mm = measured.lateral_mm + (row - line.row) * line.slant * g;
            Some(GapEnd {
                kind,
                travel_mm: measured.travel_mm + way,
                lateral_mm,
                height_mm: measured.height_mm + measured.roll * (lateral_mm - measured.lateral_mm),
                sigma_mm: (step.sigma / rule.per_mm)
                    .hypot(FLOOR_MM)
                    .hypot(SLOPE * way)
                    .hypot(SPOILT_MM[1] * (1.0 - way.abs() / SPOILT_MM[0]).max(0.0))
                    // A plate that ends alone may end square to the seam or to travel.
                    .hypot(if of_one {
                        beside_mm * measured.yaw_rad.tan()
                    } else {
                        0.0
                    })
                    .hypot(measured.sigma.height_mm * sin / cos),
            })
        })
    }
}

/// Both plates and the gap along the seam, as shares of what they are near the band, each with its weight.
struct Courses {
    plates: [Option<[[f32; 2]; MOST]>; 2],
    gap: [[f32; 2]; MOST],
    flanks: [[f32; 2]; MOST],
    count: usize,
}

impl Courses {
    /// Those of a picture; none if near the band there is nothing to compare with.
    fn new(
        layer: &Layer,
        rows: &Rows,
        line: &GapLine,
        bin: usize,
        near: std::ops::Range<usize>,
    ) -> Option<Self> {
        let near_band_of =
            |values: &[f32; MOST]| mean(values[near.clone()].iter().map(|value| f64::from(*value)));
        let floor = near_band_of(&rows.middle)?;
        let lights = [&rows.left, &rows.right].map(near_band_of);
        let brightest = lights.iter().flatten().copied().fold(0.0, f64::max) - floor;
        let plate = |values: &[f32; MOST], light: Option<f64>| {
            let light = light.filter(|light| light - floor > DIM * brightest)?;
            let mut course = [[0.0; 2]; MOST];
            for (to, value) in course.iter_mut().zip(&values[..rows.count]) {
                if !value.is_nan() {
                    *to = [(f64::from(*value) - floor) as f32 / (light - floor) as f32, 1.0];
                }
            }
            Some(course)
        };
        let plates = [plate(&rows.left, lights[0]), plate(&rows.right, lights[1])];
        let profile = Profile::of(layer, line, near.start * bin..near.end * bin);
        let both = |left: f64, right: f64| match (left.is_nan(), right.is_nan()) {
            (true, _) => right,
            (_, true) => left,
            _ => (left + right) / 2.0,
        };
        let [left, right] = lights.map(|light| light.unwrap_or(f64::NAN));
        let near_band = both(left, right);
        let beside_gap = rows.flanks.each_ref().map(near_band_of);
        let (mut gap, mut flanks) = ([[0.0; 2]; MOST], [[0.0; 2]; MOST]);
        for (k, to) in gap[..rows.count].iter_mut().enumerate() {
            let row = (k * bin) as f64 + (bin as f64 - 1.0) / 2.0;
            let open = profile.blurred(line.blur * (row - line.row).abs());
            let around = k.saturating_sub(SMOOTH)..(k + SMOOTH + 1).min(rows.count);
            let beside = around.map(|k| both(f64::from(rows.left[k]), f64::from(rows.right[k])));
            let light = mean(beside).unwrap_or(f64::NAN);
            if let [Some(left), Some(right)] = beside_gap
                && (light / near_band - 1.0).abs() < LIGHT
            {
                // A tack covers both: what differs less counts.
                let share =
                    |k_side: usize, near: f64| f64::from(rows.flanks[k_side][k]) / near * near_band / light;
                let [left, right] = [share(0, left), share(1, right)];
                let nearer = if (left - 1.0).abs() < (right - 1.0).abs() {
                    left
                } else {
                    right
                };
                if !(left.is_nan() || right.is_nan()) {
                    flanks[k] = [nearer as f32, 1.0];
                }
            }
            let lacks = light - f64::from(rows.middle[k]);
            // What an open gap lacks, of light that is brighter here, or that has more light over it.
            let wanted = near_band - open;
            let brighter = wanted * (light - floor) / (near_band - floor);
            let plain = wanted > FAINT * (near_band - floor) && (light / near_band - 1.0).abs() < LIGHT;
            if !(plain && lacks.is_finite()) {
                continue;
            }
            let [brighter, added] = [lacks / brighter, lacks / wanted];
            let share = if (brighter - 1.0).abs() < (added - 1.0).abs() {
                brighter
            } else {
                added
            };
            *to = [share as f32, (wanted / (near_band - floor)).powi(2) as f32];
        }
        Some(Self {
            plates,
            gap,
            flanks,
            count: rows.count,
        })
    }

    /// The nearest end on one side of the band, and whether only one plate shows it.
    fn end(&self, rule: &Rule, ahead: bool) -> Option<(EndKind, Step, bool)> {
        let course = |values: &[[f32; 2]; MOST]| {
            let mut values = *values;
            if !ahead {
                values[..self.count].reverse();
            }
            Course::new(&values[..self.count])
        };
        let plates = self.plates.each_ref().map(|plate| {
            let plate = course(plate.as_ref()?);
            plate.step(rule, MISSING_MM, |x| x > PLATE[0], |x| x < PLATE[1], false)
        });
        let same = SAME_MM * rule.per_mm;
        let gone = match plates {
            [Some(left), Some(right)] if (left.place - right.place).abs() < same => {
                let both = Step {
                    place: (left.place + right.place) / 2.0,
                    sigma: left.sigma.hypot(right.sigma) / 2.0,
                };
                Some((both, false))
            }
            [Some(left), Some(right)] if right.place < left.place => Some((right, true)),
            [left, right] => left.or(right).map(|step| (step, true)),
        };
        let step = |values: &[[f32; 2]; MOST], there: [f64; 2], gone: [f64; 2]| {
            let within = |x: f64, [least, most]: [f64; 2]| (least..most).contains(&x);
            course(values).step(rule, CLOSED_MM, |x| within(x, there), |x| !within(x, gone), true)
        };
        let closed = match (step(&self.gap, OPEN, CLOSED), step(&self.flanks, BARE, COVERED)) {
            (Some(gap), Some(flanks)) if flanks.place < gap.place - same => Some(flanks),
            (gap, flanks) => gap.or(flanks),
        };
        match (gone, closed) {
            // Where a plate ends there is no gap to close.
            (Some((gone, _)), Some(closed)) if closed.place < gone.place - CLOSED_MM * rule.per_mm => {
                Some((EndKind::Closed, closed, false))
            }
            (Some((gone, of_one)), _) => Some((EndKind::Plate, gone, of_one)),
            (None, closed) => Some((EndKind::Closed, closed?, false)),
        }
    }
}
