//! Levels within a dark run: a gap beside a shadow or a chamfer, or with a lit wall.

use super::between;
use super::candidate::{Candidate, PLATEAU_MM, crossing, middle_value, plateau};
use super::interior::{INSIDE_MM, beside, columns};
use super::roughness::{has_texture, relative_texture};
use super::strip::Strip;
use std::ops::Range;

/// Light of the second level of a run over the darker one, of the way up to the plate.
const SECOND_LEVEL: f32 = 0.04;

/// The same of one that is told by its texture.
const FAINTEST: f32 = 0.015;

/// What a second level may differ by over its width, of what it differs by from the darker one.
const FLAT: f32 = 0.3;

/// Texture of a second level that is a surface, over that of the plate were it as dark.
const SURFACE: f32 = 0.4;

/// Way from a quarter to three quarters up a sharp edge: what lens and defocus make of it \[mm\], and columns.
const SHARP_MM: f64 = 0.004;
const SHARP_PIXELS: f64 = 0.6;

/// Plate whose brightness an edge should rise to: from an edge so far \[mm\].
const PLATE_MM: [f64; 2] = [0.04, 0.10];

/// Narrowest ledge inside a gap: what is narrower may be blur \[mm\].
const LEDGE_MM: f64 = 0.006;

/// Columns of the narrowest gap.
const NARROWEST: f64 = 2.0;

/// The gap without a shadow or a chamfer beside it, if it is one run with them: within a run of two levels the gap is the darker
/// one. A lit wall of the gap has no level of its own, as it fades, and is left in.
pub(crate) fn without_shadow(strip: &Strip, run: Candidate, pitch_mm: f64) -> Candidate {
    let mut gap = run;
    for side in 0..2 {
        if let Some((edge, level)) = inner_edge(strip, &gap, side, pitch_mm) {
            let mut inner = gap;
            (inner.edges[side], inner.levels[side]) = (edge, level);
            if inner.width() >= NARROWEST {
                gap = inner;
            }
        }
    }
    if gap.edges == run.edges {
        return run;
    }
    let quiet = &strip.quiet;
    let inset = (INSIDE_MM / pitch_mm).min((gap.width() - NARROWEST) / 2.0);
    let inside = columns(strip, gap.edges[0] + inset, gap.edges[1] - inset);
    if inside.is_empty() {
        return run;
    }
    gap.core = [inside.start, inside.end - 1];
    let bottom = middle_value(&quiet[inside]);
    let light = |side: usize| {
        plateau(
            |column| quiet[column],
            quiet.len(),
            gap.edges[side],
            side,
            pitch_mm,
        )
    };
    let light = light(0).unwrap_or(0.0).min(light(1).unwrap_or(0.0)).max(0.01);
    gap.depth = f64::from((1.0 - bottom / light).clamp(0.0, 1.0));
    gap
}

/// Where the darker level of a run ends on a side, and the brightness there. None if there is one level only.
fn inner_edge(strip: &Strip, run: &Candidate, side: usize, pitch_mm: f64) -> Option<(f64, f32)> {
    let quiet = &strip.quiet;
    let skip = (INSIDE_MM / pitch_mm).round() as usize;
    let [left, right] = [
        run.edges[0].ceil() as usize + skip,
        (run.edges[1].floor() as usize).checked_sub(skip)?,
    ];
    let inside = quiet.get(left..=right)?;
    let cut = left + step_of(inside)?;
    // The blur of the inner edge reaches into both.
    let (outer, inner) = match side {
        0 => (left..cut.saturating_sub(skip), (cut + skip).min(right)..right + 1),
        _ => (
            cut + skip..right + 1,
            left..cut.saturating_sub(skip).max(left + 1),
        ),
    };
    if outer.len() < 2 || inner.is_empty() {
        return None;
    }
    let near = (PLATEAU_MM / pitch_mm).round().max(2.0) as usize;
    let (first, last) = (
        outer.start..(outer.start + near).min(outer.end),
        outer.end.saturating_sub(near).max(outer.start)..outer.end,
    );
    let ends = [middle_value(&quiet[first]), middle_value(&quiet[last])];
    let (at_gap, at_plate) = if side == 0 {
        (ends[1], ends[0])
    } else {
        (ends[0], ends[1])
    };
    let bottom = middle_value(&quiet[inner.clone()]);
    let (level, flat) = (
        at_gap - bottom,
        (at_plate - at_gap).abs() < FLAT * (at_gap - bottom),
    );
    let scale = (1.0 - bottom).max(0.05);
    if level < FAINTEST * scale {
        return None;
    }
    let textured = |columns: Range<usize>| is_surface(strip, run, columns, pitch_mm);
    let second = if level < SECOND_LEVEL * scale {
        textured(outer) == Some(true) && textured(inner) == Some(false)
    } else {
        flat || textured(outer) == Some(true)
    };
    if !second {
        return None;
    }
    // From the dark side of the step.
    let from = if side == 0 {
        cut + skip
    } else {
        cut.saturating_sub(skip)
    };
    let level = (at_gap + bottom) / 2.0;
    Some((crossing(quiet, from.clamp(left, right), side, level)?, level))
}

/// The place at which a line is best cut into two levels.
fn step_of(line: &[f32]) -> Option<usize> {
    let all: f32 = line.iter().sum();
    let (mut sum, mut best) = (0.0, (0.0, None));
    for (k, value) in line.iter().enumerate().take(line.len().checked_sub(1)?) {
        sum += value;
        let (before, after) = ((k + 1) as f32, (line.len() - k - 1) as f32);
        let apart = (sum / before - (all - sum) / after).powi(2) * before * after;
        if apart > best.0 {
            best = (apart, Some(k + 1));
        }
    }
    best.1
}

/// How much brighter the gap is next to its edges than where it is darkest, of the way up to the plate; None of a gap too narrow
/// to tell.
pub(crate) fn unevenness(quiet: &[f32], candidate: &Candidate, blur_mm: f64, pitch_mm: f64) -> Option<f64> {
    let [left, right] = candidate.edges;
    let (skip, count) = (
        (INSIDE_MM + blur_mm) / pitch_mm,
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

/// Width of what is brighter than the rest of the gap, next to its left and right edge, where [`unevenness`] is more than
/// `least` \[mm\]: a lit wall of the gap, a part of its shadow, or a surface that is dark.
pub(crate) fn ledges(strip: &Strip, gap: &Candidate, blur_mm: f64, least: f64, pitch_mm: f64) -> [f64; 2] {
    let quiet = &strip.quiet;
    let [first, last] = [gap.edges[0].ceil(), gap.edges[1].floor()].map(|edge| edge.max(0.0) as usize);
    let inside = (first..=last).filter_map(|column| Some((column, *quiet.get(column)?)));
    let Some((from, bottom)) = inside.min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return [0.0; 2];
    };
    let level = between([bottom, 1.0], least as f32);
    [0, 1].map(|side| {
        let begins = crossing(quiet, from, side, level).unwrap_or(gap.edges[side]);
        let width = (gap.edges[side] - begins).abs() * pitch_mm - INSIDE_MM - blur_mm;
        if width < LEDGE_MM { 0.0 } else { width }
    })
}

/// Brightness next to an edge, and that of the plate farther out if it is more.
fn lights(quiet: &[f32], gap: &Candidate, side: usize, pitch_mm: f64) -> Option<[f32; 2]> {
    let ledge = plateau(
        |column| quiet[column],
        quiet.len(),
        gap.edges[side],
        side,
        pitch_mm,
    )?;
    let [near, far] = PLATE_MM.map(|mm| mm / pitch_mm);
    let [from, to] = if side == 0 {
        [gap.edges[0] - far, gap.edges[0] - near]
    } else {
        [gap.edges[1] + near, gap.edges[1] + far]
    };
    let plate = quiet.get(from.max(0.0) as usize..(to.max(0.0) as usize).min(quiet.len()));
    let plate = plate
        .filter(|plate| !plate.is_empty())
        .map_or(ledge, middle_value);
    Some([ledge, ledge.max(plate)])
}

/// How far it is from a quarter of the way up an edge to three quarters, beyond what the lens and pixels make of a sharp one, left
/// and right \[mm\]. A lit wall, a chamfer or a rolled edge is soft, and where it begins is not known better than that.
pub(crate) fn softness(strip: &Strip, gap: &Candidate, pitch_mm: f64) -> [f64; 2] {
    let quiet = &strip.quiet;
    let bottom = middle_value(&quiet[gap.core[0]..=gap.core[1]]);
    [0, 1].map(|side| {
        let from = gap.core[side];
        let at = |share: f32, top: f32| crossing(quiet, from, side, between([bottom, top], share));
        // A ledge of less light beside the gap may be its wall, or a shadow or a chamfer of the plate.
        let way = lights(quiet, gap, side, pitch_mm)
            .and_then(|[ledge, plate]| Some((at(0.75, plate)? - at(0.25, ledge)?).abs()));
        (way.unwrap_or(0.0) * pitch_mm - SHARP_MM - SHARP_PIXELS * pitch_mm).max(0.0)
    })
}

/// Whether columns in a run have the texture of the plate; None if that could not be seen there.
fn is_surface(strip: &Strip, run: &Candidate, columns: Range<usize>, pitch_mm: f64) -> Option<bool> {
    let plates = beside(strip, run.edges, pitch_mm).into_iter();
    let plate = plates.filter_map(|plate| relative_texture(strip, plate));
    has_texture(strip, columns, SURFACE * plate.reduce(f32::min)?)
}
