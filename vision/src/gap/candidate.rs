//! Dark runs along the strip: what may be the gap.

use super::interior::Interior;
use super::{between, median};

/// Most candidates.
const MOST: usize = 12;

/// Brightness over the light below which a run begins.
const DARK: f32 = 0.65;

/// Share of its depth up to which a run is its core.
const CORE: f32 = 0.25;

/// Columns of plate whose brightness counts beside an edge \[mm\], and what of them the blur takes \[mm\].
pub(super) const PLATEAU_MM: f64 = 0.015;
const BLUR_MM: f64 = 0.006;

/// What a run counts that has a plate's texture, over one that is empty.
const TEXTURED: f64 = 0.1;

/// Width that two runs may differ by that are alike: a share of it, and columns.
const ALIKE: f64 = 0.2;
const ALIKE_COLUMNS: f64 = 0.5;

/// A dark run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Candidate {
    /// Columns of its edges, at half level.
    pub edges: [f64; 2],
    /// Brightness at its edges, left and right.
    pub levels: [f32; 2],
    /// First and last column of its core.
    pub core: [usize; 2],
    /// Depth over the brightness beside it.
    pub depth: f64,
    /// What is inside it.
    pub interior: Interior,
    /// Whether it lies where the gap of the pictures before has to be, and is as wide.
    pub expected: bool,
    /// How it continues outside the strip, 0 to 1.
    pub continuity: f64,
    /// Its rank.
    pub score: f64,
}

impl Candidate {
    /// Column of its middle.
    pub fn middle(&self) -> f64 {
        (self.edges[0] + self.edges[1]) / 2.0
    }

    /// Width \[columns\].
    pub fn width(&self) -> f64 {
        self.edges[1] - self.edges[0]
    }
}

/// The candidates of a strip.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    list: [Candidate; MOST],
    count: usize,
}

impl Candidates {
    /// Those in a line of brightness over the light, of pixels of this size.
    pub fn find(&mut self, quiet: &[f32], pitch_mm: f64) {
        self.count = 0;
        let mut column = 0;
        while column < quiet.len() && self.count < MOST {
            if quiet[column] >= DARK {
                column += 1;
                continue;
            }
            let length = quiet[column..].iter().take_while(|value| **value < DARK).count();
            if let Some(candidate) = measure(quiet, [column, column + length - 1], pitch_mm) {
                self.list[self.count] = candidate;
                self.count += 1;
            }
            column += length;
        }
    }

    /// The candidates.
    pub fn list_mut(&mut self) -> &mut [Candidate] {
        &mut self.list[..self.count]
    }

    /// The best by score, those that are empty before those that are not; and the best of the others but for what is clearly a
    /// surface beside it.
    pub fn best(&self) -> Option<(Candidate, Option<Candidate>)> {
        let list = &self.list[..self.count];
        let rank = |candidate: &Candidate| {
            candidate.score * (TEXTURED + candidate.interior.emptiness(candidate.expected))
        };
        let best = (0..list.len()).max_by(|a, b| rank(&list[*a]).total_cmp(&rank(&list[*b])))?;
        let gap = &list[best];
        let others = (0..list.len()).filter(|other| {
            let run = &list[*other];
            let alike = (run.width() - gap.width()).abs() < ALIKE * gap.width() + ALIKE_COLUMNS;
            *other != best && !run.interior.is_surface_beside(&gap.interior, alike)
        });
        let likeness = |run: &Candidate| {
            // What is seen to be empty is not passed over for what is merely dark.
            let emptier = !gap.interior.is_seen() && run.interior.is_emptier_than(&gap.interior);
            if emptier {
                run.score.max(gap.score)
            } else {
                run.score
            }
        };
        let second = others
            .map(|other| Candidate {
                score: likeness(&list[other]),
                ..list[other]
            })
            .max_by(|a, b| a.score.total_cmp(&b.score));
        Some((list[best], second))
    }
}

/// Core, depth and edges of a run. None if an edge is not in the picture.
fn measure(quiet: &[f32], run: [usize; 2], pitch_mm: f64) -> Option<Candidate> {
    let darkest = quiet[run[0]..=run[1]].iter().copied().fold(1.0, f32::min);
    let limit = darkest + CORE * (1.0 - darkest);
    let core_start = (run[0]..=run[1]).find(|column| quiet[*column] <= limit)?;
    let core_end = (run[0]..=run[1]).rev().find(|column| quiet[*column] <= limit)?;
    let core = [core_start, core_end];
    let bottom = middle_value(&quiet[core[0]..=core[1]]);
    let mut edges = [0.0; 2];
    let (mut plateaus, mut levels) = ([1.0; 2], [1.0; 2]);
    for side in 0..2 {
        let first = crossing(quiet, core[side], side, (bottom + 1.0) / 2.0);
        let first = first.unwrap_or(run[side] as f64);
        plateaus[side] = plateau(|column| quiet[column], quiet.len(), first, side, pitch_mm)?;
        levels[side] = between([bottom, plateaus[side]], 0.5);
        edges[side] = crossing(quiet, core[side], side, levels[side])?;
    }
    let beside = plateaus[0].min(plateaus[1]);
    Some(Candidate {
        edges,
        levels,
        core,
        depth: f64::from((1.0 - bottom / beside.max(0.05)).clamp(0.0, 1.0)),
        interior: Interior::default(),
        expected: false,
        continuity: 0.0,
        score: 0.0,
    })
}

/// Median of a few values.
pub(super) fn middle_value(values: &[f32]) -> f32 {
    let mut sorted = [0.0; 64];
    let count = values.len().min(64);
    // Of many, evenly spread ones will do.
    for (k, to) in sorted[..count].iter_mut().enumerate() {
        *to = values[k * values.len() / count];
    }
    median(&mut sorted[..count]).unwrap_or(1.0)
}

/// Brightness just outside an edge. None if the picture ends there.
pub(super) fn plateau(
    value: impl Fn(usize) -> f32,
    columns: usize,
    edge: f64,
    side: usize,
    pitch_mm: f64,
) -> Option<f32> {
    let count = ((PLATEAU_MM / pitch_mm).round() as usize).clamp(2, 16);
    let skip = (BLUR_MM / pitch_mm).max(0.7);
    let mut values = [0.0; 16];
    let mut taken = 0;
    for k in 0..count {
        let column = if side == 0 {
            (edge - skip).floor() - k as f64
        } else {
            (edge + skip).ceil() + k as f64
        };
        if column >= 0.0 && column < columns as f64 {
            values[taken] = value(column as usize);
            taken += 1;
        }
    }
    median(&mut values[..taken])
}

/// Where the line first rises over a level, from a column to the left (0) or right (1).
pub(super) fn crossing(line: &[f32], from: usize, side: usize, level: f32) -> Option<f64> {
    rise(|column| line[column], line.len(), from, side, level, line.len())
}

/// As [`crossing`], of values by column, over no more than `reach` columns.
pub(super) fn rise(
    value: impl Fn(usize) -> f32,
    columns: usize,
    from: usize,
    side: usize,
    level: f32,
    reach: usize,
) -> Option<f64> {
    let mut column = from;
    for _ in 0..reach {
        let next = if side == 0 {
            column.checked_sub(1)?
        } else {
            column + 1
        };
        if next >= columns {
            return None;
        }
        let (here, there) = (value(column), value(next));
        if there >= level {
            let share = if there > here {
                f64::from((level - here) / (there - here))
            } else {
                0.5
            };
            let share = share.clamp(0.0, 1.0);
            return Some(column as f64 + share * (next as f64 - column as f64));
        }
        column = next;
    }
    None
}
