//! Why a friction-stir part cannot be planned or judged.

use config::RangeError;
use shared::geometry::{ArcError, LineError};
use thiserror::Error;

/// Why a friction-stir part cannot be planned or judged. Reads as one sentence that names the key or the segment
/// (the first one is 1).
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StirError {
    /// A key has a value that makes no sense.
    #[error(transparent)]
    Value(#[from] RangeError),
    /// C cannot change its rate quickly enough where segments join.
    #[error(
        "where an arc begins or ends C would be {off_deg:.3}° off the heading, {limit_deg}° are allowed: travel_mm_min \
         is {travel_mm_min}, and may be {:.0} at most for these radii",
        largest_mm_min.floor()
    )]
    Joins {
        /// How far it is off \[°\].
        off_deg: f64,
        /// How far it may be \[°\].
        limit_deg: f64,
        /// The feed \[mm/min\].
        travel_mm_min: f64,
        /// The largest that keeps the limit \[mm/min\].
        largest_mm_min: f64,
    },
    /// No segments.
    #[error(
        "contour has no segments: add {{ line_to = [x, y] }} or {{ arc_to = [x, y], centre = [x, y], turn = \"ccw\" }}"
    )]
    NoSegments,
    /// Neither line nor arc.
    #[error(
        "segment {segment} is neither a line nor an arc: give line_to alone, or arc_to with centre and turn (\"ccw\" \
         or \"cw\")"
    )]
    Form {
        /// Number of the segment.
        segment: usize,
    },
    /// A line that leads nowhere.
    #[error("segment {segment}: {source}")]
    Line {
        /// Number of the segment.
        segment: usize,
        /// Why.
        source: LineError,
    },
    /// An arc that does not exist.
    #[error("segment {segment}: {source}")]
    Arc {
        /// Number of the segment.
        segment: usize,
        /// Why.
        source: ArcError,
    },
    /// Two segments do not join smoothly.
    #[error(
        "segment {segment} leaves the one before at a corner of {degrees:.3}°, at most {limit_deg}° can be followed: \
         the tool cannot turn on the spot; move the point where they meet, or put an arc between that touches both"
    )]
    Corner {
        /// Number of the second segment.
        segment: usize,
        /// The angle, positive to the left.
        degrees: f64,
        /// Largest angle.
        limit_deg: f64,
    },
    /// The pin would leave the plate.
    #[error(
        "segment {segment} brings the tool, {tool_mm} mm wide, to {beyond_mm:.3} mm beyond the edge of the plate: \
         move the contour or the plate"
    )]
    OffPlate {
        /// Number of the segment.
        segment: usize,
        /// Diameter of the tool.
        tool_mm: f64,
        /// How far its rim is off the plate.
        beyond_mm: f64,
    },
    /// The safe height is not above the plate.
    #[error(
        "planning.safe_height_mm of the machine is {safe_mm}, but the pin starts at {top_mm} mm: raise it, or lower the \
         plate or clearance_mm"
    )]
    SafeHeight {
        /// What the machine file says.
        safe_mm: f64,
        /// Height of the approach.
        top_mm: f64,
    },
    /// Another kind of machine.
    #[error(
        "machine {machine} has no pin with tilt and rotation axes: friction-stir welding needs kinematics.stir-gantry"
    )]
    Machine {
        /// Its name.
        machine: String,
    },
    /// No spindle.
    #[error("machine {machine} has no spindle: add [beams.1] with the largest speed as power_at_10v_w")]
    NoSpindle {
        /// Its name.
        machine: String,
    },
    /// The spindle would stop in the plate.
    #[error(
        "the spindle of machine {machine} stops between two motions, with the pin in the plate: set stays_on_at_rest = \
         true and min_speed_mm_s = 0 in [beams.1]"
    )]
    SpindleStops {
        /// Its name.
        machine: String,
    },
    /// The spindle is too slow.
    #[error("spindle_r_min is {wanted}, the spindle of the machine turns at {largest} r/min at most")]
    SpindleSpeed {
        /// What the part wants.
        wanted: f64,
        /// What there is.
        largest: f64,
    },
    /// B cannot lean that far.
    #[error("tilt_deg is {tilt}: axis B would have to stand at {b}°, but its travel is {min:.1}…{max:.1}°")]
    Tilt {
        /// What the part wants.
        tilt: f64,
        /// Where B would stand.
        b: f64,
        /// Travel.
        min: f64,
        /// Travel.
        max: f64,
    },
    /// C ends within the contour.
    #[error(
        "segment {segment}: from {from:.3}° at the start of the weld, axis C would have to go on to {to:.3}°, but its \
         travel is {min:.1}…{max:.1}°: turn the part on the table, start elsewhere, or say rewind = true, which lifts \
         the pin where C ends, turns C back and plunges again (there must be 1 mm to weld before that)"
    )]
    Travel {
        /// Number of the segment.
        segment: usize,
        /// C where the pin plunges.
        from: f64,
        /// C at the end of the segment.
        to: f64,
        /// Travel.
        min: f64,
        /// Travel.
        max: f64,
    },
    /// C cannot even point there.
    #[error(
        "segment {segment}: axis C cannot stand at {c:.3}° nor a turn from there, its travel is {min:.1}…{max:.1}°: turn the part on the table"
    )]
    Heading {
        /// Number of the segment.
        segment: usize,
        /// Where C would stand.
        c: f64,
        /// Travel.
        min: f64,
        /// Travel.
        max: f64,
    },
    /// The run was not one of this part.
    #[error(
        "the program stirs {run_mm:.3} mm, the contour of the part is {part_mm:.3} mm long: plan it again"
    )]
    OtherProgram {
        /// What was run.
        run_mm: f64,
        /// What the part says.
        part_mm: f64,
    },
    /// Nothing to judge.
    #[error("the spindle never turned while the pin travelled along the contour: nothing was welded")]
    NothingWelded,
}
