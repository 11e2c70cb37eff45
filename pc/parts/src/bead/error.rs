//! Why no program can be planned for a bead.

use super::window::WindowError;
use cam::path::CAPACITY;
use config::RangeError;
use curves::SplineError;
use curves::nurbs::{DiscretiseError, NurbsError};
use thiserror::Error;

/// Why no program can be planned for a bead. Reads as one sentence.
#[derive(Debug, Error)]
pub(super) enum BeadError {
    #[error("a bead has one curve: give either nurbs_file or the table [bead.nurbs]")]
    OneCurve,
    #[error("cannot read {path}: {source}")]
    Read { path: String, source: std::io::Error },
    #[error("{path}: {source}")]
    Json { path: String, source: serde_json::Error },
    /// Of degree, control points, weights and knots.
    #[error("{place}, {key}: {source}")]
    Nurbs {
        place: String,
        key: &'static str,
        source: NurbsError,
    },
    #[error(
        "{place}: the curve has no direction at parameter {u} near ({x:.3}, {y:.3}, {z:.3}) mm; move control points \
         that coincide there apart"
    )]
    NoDirection {
        place: String,
        u: f64,
        x: f64,
        y: f64,
        z: f64,
    },
    #[error(
        "layer {layer} is no smooth curve through {points} points: it needs 2 to 511 of them, and turns by at most 20° from \
         one to the next; round its sharpest bend, or make two beads"
    )]
    NotSmooth { layer: usize, points: usize },
    #[error(
        "{place}: a kink of {degrees:.1}° at parameter {u} near ({x:.3}, {y:.3}, {z:.3}) mm; a bead runs without a \
         stop, so round it with a radius, or make two beads"
    )]
    Kink {
        place: String,
        degrees: f64,
        u: f64,
        x: f64,
        y: f64,
        z: f64,
    },
    #[error(
        "{place}: the curve is {length:.0} mm long, and a path of {CAPACITY} points takes {most:.0} mm at most; correct \
         control_points_mm, or make several beads"
    )]
    TooLong { place: String, length: f64, most: f64 },
    #[error(transparent)]
    Value(#[from] RangeError),
    #[error(
        "neither the part (window_mm_s) nor the machine (process) has a process window; give window_mm_s"
    )]
    NoWindow,
    #[error("window_mm_s: {0}")]
    Window(WindowError),
    #[error("{0}")]
    Cut(DiscretiseError),
    #[error("no smooth curve through the points: {0}")]
    Spline(SplineError),
    #[error(
        "the bead needs more than the {CAPACITY} points that the boards hold: after {places} points the worst \
         place is still near ({x:.3}, {y:.3}, {z:.3}) mm; split the bead in two, or round its sharp corners"
    )]
    TooManyPoints { places: usize, x: f64, y: f64, z: f64 },
    #[error(
        "the path through the points is {distance:.4} mm off the NURBS near ({x:.3}, {y:.3}, {z:.3}) mm; this is a \
         defect of the planner, please report it"
    )]
    Inexact { distance: f64, x: f64, y: f64, z: f64 },
    #[error(
        "the machine cannot keep the process window in {corners} corners, and the boards change the speed in {most} at \
         most; round the corners, or widen window_mm_s"
    )]
    TooManySlow { corners: usize, most: usize },
    #[error(
        "lead_mm and overlap_mm together are {ends:.1} mm, but the closed bead is only {length:.1} mm long; shorten \
         them"
    )]
    EndsTooLong { ends: f64, length: f64 },
    #[error(
        "lead_mm is {lead}, but the tip needs {needed:.2} mm to reach {speed:.2} mm/s before the arc burns; lengthen it"
    )]
    LeadTooShort { lead: f64, needed: f64, speed: f64 },
    #[error(
        "the turntable would have to turn from {from:.0}° to {to:.0}°, more than its travel of {min:.0}° to {max:.0}°; \
         plan it with attitude = \"constant\""
    )]
    Turntable { from: f64, to: f64, min: f64, max: f64 },
    #[error("the highest point of the bead is at {top:.1} mm, but safe_height_mm must be {clearance} mm above it, at \
             least {} mm", top + clearance)]
    SafeHeight { top: f64, clearance: f64 },
    #[error(
        "the curve stands upright {t:.2} mm after its start, so there is no travel for the turntable to follow; plan it \
             with attitude = \"constant\""
    )]
    Upright { t: f64 },
}
