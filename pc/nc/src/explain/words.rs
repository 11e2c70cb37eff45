//! Numbers and coordinates as people read them.

use crate::modal::INCH;
use shared::io::{AXES, AXIS_NAMES};

/// Figures are rounded to so many decimals: finer than what machines here resolve (mm, degrees).
const DECIMALS: i32 = 5;

/// A number without decimals that say nothing.
pub(super) fn figure(number: f64) -> String {
    let scale = 10f64.powi(DECIMALS);
    let rounded = (number * scale).round() / scale;
    // No -0.
    let rounded = if rounded == 0.0 { 0.0 } else { rounded };
    if rounded.is_finite() {
        format!("{rounded}")
    } else {
        format!("{number:e}")
    }
}

/// X Y Z in mm or inches and A B C in degrees, of \[mm\] and \[deg\]: those that there are.
pub(super) fn coordinates(at: &[Option<f64>; AXES], inches: bool) -> String {
    let unit = if inches { "in" } else { "mm" };
    let scale = if inches { INCH } else { 1.0 };
    let lengths = named(&at[..3], &AXIS_NAMES[..3], scale);
    let angles = named(&at[3..], &AXIS_NAMES[3..], 1.0);
    let parts = [(lengths, unit), (angles, "deg")];
    let parts = parts.into_iter().filter(|(words, _)| !words.is_empty());
    parts
        .map(|(words, unit)| format!("{words} {unit}"))
        .collect::<Vec<_>>()
        .join(", ")
}

fn named(values: &[Option<f64>], names: &[&str], scale: f64) -> String {
    let said = names.iter().zip(values);
    let said = said.filter_map(|(name, value)| value.map(|value| format!("{name}{}", figure(value / scale))));
    said.collect::<Vec<_>>().join(" ")
}
