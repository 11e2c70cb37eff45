//! Deviations of axes from where they should be, as an interferometer measures them.

use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most tables of a machine: positioning of X1, X2, Y, Z, A, B and C, and straightness and squareness of three axes in two
/// directions each, with room.
pub const DEVIATIONS: usize = 16;
/// Most points of a table.
pub const DEVIATION_POINTS: usize = 64;
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
