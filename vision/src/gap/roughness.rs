//! Roughness of a surface: how much its brightness varies along lines in the strip, and from line to line.

use super::candidate::{Candidate, rise};
use super::median;
use super::strip::{GROUPS, Strip};
use std::ops::Range;

/// Share of the groups, those in which a run is widest, that are looked at inside it.
const WIDEST: f64 = 0.5;

/// Most lines that are looked at; of more, evenly spread ones.
const LINES: usize = 128;

/// Relative standard error of a variance that is the median of those of n lines, of m values each: this over √(n·m).
const ERROR: f32 = 1.8;

/// Variance of the lower half of normal numbers, over theirs.
const HALF: f32 = 0.39;

/// A line along the seam: its columns in some groups of the strip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// From the column of the line to its column in a group.
    shifts: [isize; GROUPS],
    /// The groups.
    groups: [usize; GROUPS],
    count: usize,
    /// Whether only the darker half of its values counts.
    darker: bool,
}

impl Course {
    /// Straight through all groups, with the strip's slant.
    pub fn straight(strip: &Strip) -> Self {
        Self {
            shifts: std::array::from_fn(|group| shift(strip, group).round() as isize),
            groups: std::array::from_fn(|group| group),
            count: strip.groups,
            darker: false,
        }
    }

    /// Between the edges of a run, in the groups in which it is widest; and how wide it is in the narrowest of them
    /// \[columns\]. Light that spreads from rough edges into the run is the same along such a line.
    pub fn between_edges(strip: &Strip, run: &Candidate) -> (Self, f64) {
        let reach = run.width().ceil() as usize + 2;
        let columns = strip.values.len();
        let mut course = Self::straight(strip);
        let mut widths = [0.0; GROUPS];
        for group in 0..strip.groups {
            let shift = shift(strip, group);
            let core = (run.middle() + shift).round().clamp(0.0, columns as f64 - 1.0) as usize;
            let value = |column: usize| strip.values[column][group];
            let [left, right] = [0, 1].map(|side| {
                rise(value, columns, core, side, run.levels[side], reach).unwrap_or(run.edges[side] + shift)
            });
            widths[group] = right - left;
            course.shifts[group] = ((left + right) / 2.0 - run.middle()).round() as isize;
        }
        let groups = &mut course.groups[..strip.groups];
        groups.sort_unstable_by(|a, b| widths[*b].total_cmp(&widths[*a]));
        course.count =
            ((WIDEST * strip.groups as f64).ceil() as usize).clamp(4.min(strip.groups), strip.groups);
        let narrowest = widths[course.groups[course.count - 1]];
        (course, narrowest)
    }

    /// In all groups, but only the darker half of its values.
    pub fn darker(self, strip: &Strip) -> Self {
        Self {
            count: strip.groups,
            darker: true,
            ..self
        }
    }

    /// The same groups, straight with the strip's slant.
    pub fn straightened(&self, strip: &Strip) -> Self {
        Self {
            shifts: Self::straight(strip).shifts,
            ..*self
        }
    }

    /// Mean of a line's values and their variance about a straight rise: light changes across the picture.
    fn scatter(&self, values: &mut [f32]) -> (f32, f32) {
        if self.darker {
            values.sort_unstable_by(f32::total_cmp);
            let half = &values[..values.len().div_ceil(2)];
            let count = half.len() as f32;
            let mean = half.iter().sum::<f32>() / count;
            let squares = half.iter().map(|value| (value - mean).powi(2)).sum::<f32>();
            return (mean, squares / (count - 1.0));
        }
        let count = values.len() as f32;
        let mean = values.iter().sum::<f32>() / count;
        let place = self.groups[..self.count].iter().sum::<usize>() as f32 / count;
        let (mut squares, mut rise, mut spread) = (0.0, 0.0, 0.0);
        for (value, group) in values.iter().zip(&self.groups) {
            let (off, along) = (value - mean, *group as f32 - place);
            squares += off * off;
            rise += off * along;
            spread += along * along;
        }
        (mean, (squares - rise * rise / spread).max(0.0) / (count - 2.0))
    }

    /// Brightness of the line at a column in each of its groups.
    fn values(&self, strip: &Strip, column: usize) -> [f32; GROUPS] {
        let last = strip.values.len() as isize - 1;
        let mut values = [0.0; GROUPS];
        for (value, group) in values.iter_mut().zip(&self.groups[..self.count]) {
            let from = (column as isize + self.shifts[*group]).clamp(0, last);
            *value = strip.values[from as usize][*group];
        }
        values
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
        let (mut along, mut beside) = ([0.0; LINES], [0.0; LINES]);
        let (mut brightness, mut noise, mut lines) = (0.0, 0.0, 0);
        let values = course.count as f32;
        let every = columns.len().div_ceil(LINES).max(1);
        for column in columns.step_by(every).filter(|column| strip.seen[*column]) {
            let mut own = course.values(strip, column);
            let own = &mut own[..course.count];
            let (mean, variance) = course.scatter(own);
            along[lines] = variance;
            if let Some(reach) = across {
                let [left, right] = [column.saturating_sub(reach), column + reach]
                    .map(|column| course.values(strip, column.min(strip.values.len() - 1)));
                let bends = own.iter().zip(left).zip(right);
                beside[lines] = bends
                    .map(|((own, left), right)| (left - 2.0 * own + right).powi(2))
                    .sum::<f32>()
                    / (6.0 * values);
            }
            brightness += mean;
            noise += strip.noise(column, mean) * if course.darker { HALF } else { 1.0 };
            lines += 1;
        }
        let along = median(&mut along[..lines])?;
        let beside = median(&mut beside[..lines])?;
        let sides = if across.is_some() { 2.0 } else { 1.0 };
        let count = lines as f32;
        let noise = sides * noise / count;
        Some(Self {
            brightness: brightness / count,
            variance: along + beside,
            noise,
            error: ERROR * noise / (count * sides * values).sqrt(),
        })
    }

    /// Variance that noise does not make.
    pub fn excess(&self) -> f32 {
        (self.variance - self.noise - self.error).max(0.0)
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
