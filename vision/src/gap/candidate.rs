//! Dark runs along the strip: what may be the gap.

use super::{between, median};

/// Most candidates.
const MOST: usize = 12;

/// Brightness over the light below which a run begins.
const DARK: f32 = 0.65;

/// Share of its depth up to which a run is its core.
const CORE: f32 = 0.25;

/// Columns of plate whose brightness counts beside an edge \[mm\], and what of them the blur takes \[mm\].
const PLATEAU_MM: f64 = 0.015;
const BLUR_MM: f64 = 0.006;

/// Light of the second level of a run over the darker one, of the way up to the plate; and what it may differ by over its width.
const SECOND_LEVEL: f64 = 0.04;
const FLAT: f32 = 0.3;

/// From an edge so far into the gap its blur reaches, and its roughness \[mm\].
const INSIDE_MM: f64 = 0.010;

/// A dark run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Candidate {
    /// Columns of its edges, at half level.
    pub edges: [f64; 2],
    /// First and last column of its core.
    pub core: [usize; 2],
    /// Depth over the brightness beside it.
    pub depth: f64,
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

    /// The best by score, and the second.
    pub fn best(&self) -> Option<(Candidate, Option<Candidate>)> {
        let list = &self.list[..self.count];
        let best = (0..list.len()).max_by(|a, b| list[*a].score.total_cmp(&list[*b].score))?;
        let others = (0..list.len()).filter(|other| *other != best);
        let second = others.max_by(|a, b| list[*a].score.total_cmp(&list[*b].score));
        Some((list[best], second.map(|second| list[second])))
    }
}

impl Candidate {
    /// The gap without a shadow or a chamfer beside it, if it is one run with them: within a run of two levels the gap is the
    /// darker one. A lit wall of the gap has no level of its own, as it fades, and is left in.
    pub fn split(self, quiet: &[f32], pitch_mm: f64) -> Self {
        let mut split = self;
        for side in 0..2 {
            if let Some((edge, core)) = inner_edge(quiet, &self, side, pitch_mm) {
                split.edges[side] = edge;
                split.core[side] = core;
            }
        }
        if split.core[0] > split.core[1] || split.edges == self.edges {
            return self;
        }
        let bottom = middle_value(&quiet[split.core[0]..=split.core[1]]);
        let beside = [0, 1].map(|side| {
            plateau(
                |column| quiet[column],
                quiet.len(),
                split.edges[side],
                side,
                pitch_mm,
            )
            .unwrap_or(0.0)
        });
        let beside = beside[0].min(beside[1]).max(0.01);
        split.depth = f64::from((1.0 - bottom / beside).clamp(0.0, 1.0));
        split
    }
}

/// Where the darker level of a run ends on a side, and the last column of its core there; None if there is one level only.
fn inner_edge(quiet: &[f32], run: &Candidate, side: usize, pitch_mm: f64) -> Option<(f64, usize)> {
    let [left, right] = [run.edges[0].ceil() as usize, run.edges[1].floor() as usize];
    let darkest = (left..=right).min_by(|a, b| smoothed(quiet, *a).total_cmp(&smoothed(quiet, *b)))?;
    let bottom = smoothed(quiet, darkest);
    let (skip, sign) = (
        (INSIDE_MM / pitch_mm).round() as isize,
        if side == 0 { 1 } else { -1 },
    );
    // Just inside the edge, where its blur does not reach.
    let outer = [left, right][side] as isize + sign * skip;
    if (darkest as isize - outer) * sign <= 0 {
        return None;
    }
    let level = smoothed(quiet, outer as usize);
    if f64::from((level - bottom) / (1.0 - bottom).max(0.05)) < SECOND_LEVEL {
        return None;
    }
    let half = (level + bottom) / 2.0;
    let edge = crossing(quiet, darkest, side, half)?;
    // It has a level of its own: near the inner edge it is what it is near the outer one.
    let near = edge.round() as isize - sign * skip;
    let flat = (outer - near) * sign <= 0
        && (smoothed(quiet, near as usize) - level).abs() < FLAT * (level - bottom);
    let core = crossing(quiet, darkest, side, bottom + CORE * (level - bottom))?;
    flat.then_some((edge, core.round() as usize))
}

/// Mean of a column and its neighbours.
fn smoothed(line: &[f32], column: usize) -> f32 {
    let around = &line[column.saturating_sub(1)..(column + 2).min(line.len())];
    around.iter().sum::<f32>() / around.len() as f32
}

/// How much brighter the gap is next to its edges than where it is darkest, of the way up to the plate; None of a gap too narrow
/// to tell.
pub(crate) fn unevenness(quiet: &[f32], candidate: &Candidate, pitch_mm: f64) -> Option<f64> {
    let [left, right] = candidate.edges;
    let (skip, count) = (
        INSIDE_MM / pitch_mm,
        (PLATEAU_MM / pitch_mm / 2.0).round().max(2.0),
    );
    let ends = [(left + skip).ceil(), (right - skip).floor() - count + 1.0];
    if ends[1] - ends[0] < count {
        return None;
    }
    let level = |start: f64| {
        let start = start as usize;
        middle_value(&quiet[start..start + count as usize])
    };
    let (mut darkest, mut at) = (f32::INFINITY, ends[0]);
    while at <= ends[1] {
        darkest = darkest.min(level(at));
        at += 1.0;
    }
    let brightest = level(ends[0]).max(level(ends[1]));
    Some(f64::from((brightest - darkest) / (1.0 - darkest).max(0.05)))
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
    let mut plateaus = [1.0; 2];
    for side in 0..2 {
        let first = crossing(quiet, core[side], side, (bottom + 1.0) / 2.0);
        let first = first.unwrap_or(run[side] as f64);
        plateaus[side] = plateau(|column| quiet[column], quiet.len(), first, side, pitch_mm)?;
        edges[side] = crossing(quiet, core[side], side, between([bottom, plateaus[side]], 0.5))?;
    }
    let beside = plateaus[0].min(plateaus[1]);
    Some(Candidate {
        edges,
        core,
        depth: f64::from((1.0 - bottom / beside.max(0.05)).clamp(0.0, 1.0)),
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
fn crossing(line: &[f32], from: usize, side: usize, level: f32) -> Option<f64> {
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
