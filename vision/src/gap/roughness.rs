//! Roughness of a surface: how much its brightness varies along lines in the strip, and from line to line.

use super::candidate::{Candidate, rise};
use super::median;
use super::strip::{GROUPS, Strip};
use std::ops::Range;

/// Most lines that are looked at; of more, evenly spread ones.
const LINES: usize = 64;

/// How far apart along a line the brightness is compared \[mm along the rows\]: an exposure smears by up to that.
const LAG_MM: f64 = 0.02;

/// Share of the squared differences that counts, the least ones: a rough edge reaches into the others. Their mean in normal
/// numbers over the variance, and the relative standard error that n of them have, over 1/√n.
const KEPT: f64 = 0.75;
const KEPT_MEAN: f32 = 0.3684;
const ERROR: f32 = 2.15;

/// What the noise may differ by, over it, where it is about as large as the steps of the camera.
const WHOLE_STEPS: f32 = 0.3;

/// A line along the seam: from its column in the band to its column in each group of the strip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course([isize; GROUPS]);

impl Course {
    /// Straight, with the strip's slant.
    pub fn straight(strip: &Strip) -> Self {
        Self(std::array::from_fn(|group| shift(strip, group).round() as isize))
    }

    /// Between the edges of a run: light that spreads from rough edges into the run is the same along such a line.
    pub fn between_edges(strip: &Strip, run: &Candidate) -> Self {
        let reach = run.width().ceil() as usize + 2;
        let columns = strip.values.len();
        let mut course = Self::straight(strip);
        for group in 0..strip.groups {
            let shift = shift(strip, group);
            let core = (run.middle() + shift).round().clamp(0.0, columns as f64 - 1.0) as usize;
            let value = |column: usize| strip.values[column][group];
            let [left, right] = [0, 1].map(|side| {
                rise(value, columns, core, side, run.levels[side], reach).unwrap_or(run.edges[side] + shift)
            });
            course.0[group] = ((left + right) / 2.0 - run.middle()).round() as isize;
        }
        course
    }

    /// Brightness of the line at a column in each group.
    fn values(&self, strip: &Strip, column: usize) -> [f32; GROUPS] {
        let last = strip.values.len() as isize - 1;
        std::array::from_fn(|group| {
            let from = (column as isize + self.0[group]).clamp(0, last);
            strip.values[from as usize][group]
        })
    }
}

/// Columns from the band's to those of a group.
fn shift(strip: &Strip, group: usize) -> f64 {
    strip.slant * strip.offset(group)
}

/// Roughness of some lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roughness {
    /// Mean brightness over the light.
    pub brightness: f32,
    /// Variance of the brightness along the lines and, if asked for, across.
    pub variance: f32,
    /// What of it noise makes.
    pub noise: f32,
    /// Standard error of that.
    pub error: f32,
}

impl Roughness {
    /// Of the lines at these columns; across them by differences over `across` columns. None if they are not in the picture.
    pub fn of(strip: &Strip, columns: Range<usize>, course: &Course, across: Option<usize>) -> Option<Self> {
        let groups = strip.groups;
        let lag = strip.groups_of(LAG_MM).clamp(1, groups - 1);
        let (mut along, mut beside) = (Differences::new(), Differences::new());
        let (mut brightness, mut noise, mut lines) = (0.0, 0.0, 0.0);
        let every = columns.len().div_ceil(LINES).max(1);
        for column in columns.step_by(every).filter(|column| strip.seen[*column]) {
            let own = course.values(strip, column);
            let own = &own[..groups];
            for (before, after) in own.iter().zip(&own[lag..]) {
                along.add((after - before) / 2_f32.sqrt());
            }
            if let Some(reach) = across {
                let [left, right] = [column.saturating_sub(reach), column + reach]
                    .map(|column| course.values(strip, column.min(strip.values.len() - 1)));
                for ((own, left), right) in own.iter().zip(left).zip(right) {
                    beside.add((left - 2.0 * own + right) / 6_f32.sqrt());
                }
            }
            let mean = own.iter().sum::<f32>() / groups as f32;
            brightness += mean;
            noise += strip.noise(column, mean);
            lines += 1.0;
        }
        let variance = along.variance()? + beside.variance().unwrap_or(0.0);
        let noise = if across.is_some() { 2.0 } else { 1.0 } * noise / lines;
        Some(Self {
            brightness: brightness / lines,
            variance,
            noise,
            error: noise * (ERROR / ((along.count + beside.count) as f32).sqrt()).hypot(WHOLE_STEPS),
        })
    }

    /// Variance that noise does not make.
    pub fn excess(&self) -> f32 {
        (self.variance - self.noise - self.error).max(0.0)
    }
}

/// Differences of brightness, each with the variance of one value.
struct Differences {
    list: [f32; LINES * GROUPS],
    count: usize,
}

impl Differences {
    fn new() -> Self {
        Self {
            list: [0.0; LINES * GROUPS],
            count: 0,
        }
    }

    fn add(&mut self, difference: f32) {
        self.list[self.count] = difference;
        self.count += 1;
    }

    /// Variance about their median, from the least ones: light changes across the picture.
    fn variance(&mut self) -> Option<f32> {
        let list = &mut self.list[..self.count];
        let middle = median(list)?;
        list.iter_mut()
            .for_each(|value| *value = (*value - middle).powi(2));
        let kept = ((KEPT * self.count as f64).round() as usize).clamp(1, self.count);
        list.select_nth_unstable_by(kept - 1, f32::total_cmp);
        Some(list[..kept].iter().sum::<f32>() / kept as f32 / KEPT_MEAN)
    }
}

/// Texture of columns over the square of their brightness: of a surface that of the plate, however dark it is.
pub(super) fn relative_texture(strip: &Strip, columns: Range<usize>) -> Option<f32> {
    let of = Roughness::of(strip, columns, &Course::straight(strip), None)?;
    Some(of.excess() / of.brightness.powi(2).max(f32::MIN_POSITIVE))
}

/// Whether columns have at least this texture over the square of their brightness; None if noise would hide it.
pub(super) fn has_texture(strip: &Strip, columns: Range<usize>, least: f32) -> Option<bool> {
    let of = Roughness::of(strip, columns, &Course::straight(strip), None)?;
    let least = least * of.brightness.powi(2);
    (least > of.error).then(|| of.excess() > least)
}
