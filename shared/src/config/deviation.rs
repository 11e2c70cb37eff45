//! Deviations of axes from where they should be, as an interferometer measures them.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most tables of a machine: positioning of X1, X2, Y, Z, A, B and C, and straightness and squareness of three axes in two
/// directions each, with room.
pub const DEVIATIONS: usize = 16;
/// Most points of a table.
pub const DEVIATION_POINTS: usize = 64;
/// Most points of all tables of a machine.
pub const DEVIATION_POINTS_IN_ALL: usize = 640;
/// Largest deviation (mm or degrees): where there is more, something is built or measured wrong.
pub const MOST_DEVIATION: f64 = 1.0;
/// Steepest change of one along its axis: 10 mm/m.
pub const STEEPEST_DEVIATION: f64 = 0.01;

/// By how much a motor is beside its place, as a function of the coordinate of an axis: of its own axis its positioning
/// deviation, of another one straightness and squareness (ISO 230-1, ISO 230-2). Beyond its ends a table stays as it is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct DeviationConfig {
    /// Axis along which it was measured, as in [`crate::io::AXIS_NAMES`].
    pub axis: u8,
    /// Motor whose place deviates, as in [`crate::io::MOTOR_NAMES`].
    pub motor: u8,
    /// Coordinate of the axis at the first point (mm or degrees).
    pub from: f64,
    /// Distance of two points (mm or degrees).
    pub step: f64,
    /// Actual place less target at each point (mm or degrees, of the motor).
    pub values: Vec<f32, DEVIATION_POINTS>,
}

impl DeviationConfig {
    /// The deviation with the axis at `coordinate` (mm or degrees).
    pub fn at(&self, coordinate: f64) -> f64 {
        let place = (coordinate - self.from) / self.step;
        let [value, _] = smooth(self.values.len(), |point| f64::from(self.values[point]), place);
        value
    }
}

/// Value and slope at `place` of a curve through so many `points`, two at least, one apart from the next: by Catmull and Rom's cubics,
/// with one-sided differences at both ends, and as at the ends beyond them.
pub(crate) fn smooth(points: usize, value: impl Fn(usize) -> f64, place: f64) -> [f64; 2] {
    let last = points - 1;
    // What is not a number stays at the first point.
    if place.is_nan() || place <= 0.0 {
        return [value(0), 0.0];
    }
    if place >= last as f64 {
        return [value(last), 0.0];
    }
    let point = place as usize;
    let t = place - point as f64;
    let (p0, p1) = (value(point), value(point + 1));
    let rise = p1 - p0;
    let m0 = match point {
        0 => rise,
        _ => 0.5 * (p1 - value(point - 1)),
    };
    let m1 = if point + 1 == last {
        rise
    } else {
        0.5 * (value(point + 2) - p0)
    };
    let (b, c) = (3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise);
    [p0 + t * (m0 + t * (b + t * c)), m0 + t * (2.0 * b + t * 3.0 * c)]
}
