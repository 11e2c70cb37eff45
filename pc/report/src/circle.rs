//! Plot of a circular test.

use crate::ReportError;
use crate::draw::{AS_CURVES, Curve, POINTS, Panel, figure};
use commission::{REVERSALS_DEG, Turn};
use std::path::Path;

/// Width and height of the two panels together.
const SIZE: (u32, u32) = (1280, 660);
/// Radius of the programmed circle in the first panel, and that of the farthest place from it.
const CIRCLE: f64 = 1.0;
const FARTHEST: f64 = 0.4;

/// Draws turns in both directions into the file at `path`: at the left round the programmed circle, with the distances from it
/// magnified, at the right these over the angle.
///
/// # Errors
/// The file cannot be written.
pub fn write_circle(path: &Path, title: &str, turns: &[Turn; 2]) -> Result<(), ReportError> {
    let most = turns.iter().flat_map(Turn::course).map(|(_, off)| off.abs());
    let most_um = 1e3 * most.fold(1e-4, f64::max);
    let round = |turn: &Turn| {
        let place = |(angle, off): (f64, f64)| {
            let (sin, cos) = f64::to_radians(angle).sin_cos();
            let radius = CIRCLE + FARTHEST * 1e3 * off / most_um;
            (radius * cos, radius * sin)
        };
        // A plot would keep the highest and the lowest of many, and a circle goes to all sides.
        let step = turn.places.len().div_ceil(POINTS).max(1);
        turn.course().step_by(step).map(place).collect()
    };
    let over_angle = |turn: &Turn| {
        let mut course: Vec<_> = turn.course().map(|(angle, off)| (angle, 1e3 * off)).collect();
        course.sort_by(|a, b| a.0.total_cmp(&b.0));
        course
    };
    let curves = |points: &dyn Fn(&Turn) -> Vec<(f64, f64)>| {
        let [there, back] = turns;
        vec![Curve::new("G3", points(there)), Curve::new("G2", points(back))]
    };
    let nominal = (0..=360).map(|angle| {
        let (sin, cos) = f64::from(angle).to_radians().sin_cos();
        (CIRCLE * cos, CIRCLE * sin)
    });
    let panels = [
        Some(Panel {
            title: format!(
                "{most_um:.1} µm from the dashed circle are drawn as {:.0} % of its radius",
                100.0 * FARTHEST
            ),
            curves: curves(&round),
            least: AS_CURVES,
            dashed: vec![nominal.collect()],
            to_scale: true,
            ..Panel::default()
        }),
        Some(Panel {
            title: "Distance from the programmed circle".to_owned(),
            x: "angle [°]",
            y: "outwards [µm]",
            curves: curves(&over_angle),
            least: AS_CURVES,
            places: REVERSALS_DEG.iter().map(|at| (*at, String::new())).collect(),
            ..Panel::default()
        }),
    ];
    figure(path, title, SIZE, (1, 2), &panels).map_err(|e| ReportError::new(path, e))
}
