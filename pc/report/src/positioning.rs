//! Plot of a test of positioning accuracy.

use crate::ReportError;
use crate::draw::{AS_CURVES, Curve, Panel, figure};
use commission::{Positioning, Target};
use std::path::Path;

/// Width and height.
const SIZE: (u32, u32) = (960, 480);

/// Draws the deviations of all approaches, and their means, over the targets into the file at `path`. Deviations are told in `unit`, of which
/// `scale` are in one of the machine file; the axis may be rotary.
///
/// # Errors
/// The file cannot be written.
pub fn write_positioning(
    path: &Path,
    title: &str,
    (rotary, unit, scale): (bool, &str, f64),
    positioning: &Positioning,
) -> Result<(), ReportError> {
    let mean_of = |deviations: &[f64]| deviations.iter().sum::<f64>() / deviations.len() as f64;
    let curve = |name: &str, of: &dyn Fn(&Target) -> f64| {
        let points = positioning
            .targets()
            .iter()
            .map(|target| (target.at, scale * of(target)));
        Curve::new(name, points.collect())
    };
    let run = |side: usize, run: usize| {
        let points = positioning.targets().iter().filter_map(|target| {
            let off = target.deviations[side].get(run)?;
            Some((target.at, scale * off))
        });
        points.collect::<Vec<_>>()
    };
    let runs = positioning
        .targets()
        .iter()
        .map(|target| target.deviations[0].len());
    let runs = runs.max().unwrap_or(0);
    let panel = Panel {
        title: format!("Actual place less target [{unit}]; dashed: single runs"),
        x: if rotary { "target [°]" } else { "target [mm]" },
        y: if rotary { "deviation" } else { "deviation [µm]" },
        curves: vec![
            curve("mean from below", &|target| mean_of(&target.deviations[0])),
            curve("mean from above", &|target| mean_of(&target.deviations[1])),
            curve("mean of both, for the table", &Target::mean),
        ],
        least: AS_CURVES,
        dashed: (0..runs).flat_map(|k| [run(0, k), run(1, k)]).collect(),
        ..Panel::default()
    };
    figure(path, title, SIZE, (1, 1), &[Some(panel)]).map_err(|e| ReportError::new(path, e))
}
