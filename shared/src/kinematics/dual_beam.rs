//! The dual-beam gantry: X Y Z, then C, B, A (SPEC 0.2, 0.3).

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Geometry of the dual-beam gantry \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct DualBeamConfig {
    /// C axis to B axis, in the frame that turns with C.
    pub o1_mm: [f64; 3],
    /// B axis to A axis, in the frame after B.
    pub o2_mm: [f64; 3],
    /// A axis to the virtual tip D, in the plate frame: (tx, ty, −L).
    pub o3_mm: [f64; 3],
}
