//! Why a saddle cannot be welded as its part file says.

use super::pipes::SaddleError;
use config::RangeError;
use thiserror::Error;

/// Why a saddle cannot be welded as its part file says. Reads as one sentence that names the key.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SaddlePartError {
    /// A dimension is missing, and no points were taught to find it from.
    #[error("{key} is missing: give it, or teach points (taught = \"points.csv\") to find it from")]
    Missing {
        /// The key.
        key: &'static str,
    },
    /// A key has a value that makes no sense.
    #[error(transparent)]
    Value(#[from] RangeError),
    /// No passes.
    #[error("no passes: add [[saddle.passes]] with radial_mm, axial_mm, speed_mm_s and power_w")]
    NoPasses,
    /// The pipes make no seam.
    #[error("{key}: {source}")]
    Pipes {
        /// The key that decides it.
        key: &'static str,
        /// Why.
        source: SaddleError,
    },
    /// The seam does not go around the branch.
    #[error(
        "branch_diameter_mm, offset_mm: the branch ends {reach_mm:.2} mm beside the main axis, past or at the rim of the \
         main pipe at {main_mm:.2} mm, so no seam goes around it for the waist to follow: make it smaller or move it in"
    )]
    NotAround {
        /// r + |δ|.
        reach_mm: f64,
        /// R.
        main_mm: f64,
    },
    /// No machine for a saddle.
    #[error("machine {machine} does not turn about a pipe: a saddle needs kinematics.pipe-welder")]
    Machine {
        /// Its name.
        machine: String,
    },
    /// The waist has not enough travel.
    #[error(
        "axis C would have to go from {from:.1}° to {to:.1}°, but its travel is {min:.1}…{max:.1}°: change start_deg, \
         or shorten overlap_mm ({span:.1}° are needed in all)"
    )]
    Waist {
        /// Where the first pass that does not fit begins \[°\].
        from: f64,
        /// Where it ends \[°\].
        to: f64,
        /// `to` − `from`.
        span: f64,
        /// Travel.
        min: f64,
        /// Travel.
        max: f64,
    },
    /// The tip would hit the main pipe on its way around.
    #[error(
        "planning.safe_height_mm of the machine is {safe_mm}, but the main pipe reaches to {needed_mm:.1} mm there: \
         raise it"
    )]
    SafeHeight {
        /// What the machine file says.
        safe_mm: f64,
        /// What is needed.
        needed_mm: f64,
    },
    /// The seam bends too sharply to continue without a stop.
    #[error(
        "branch_diameter_mm, offset_mm: the seam bends by {degrees:.0}° between two points, too near to tangent"
    )]
    Sharp {
        /// Angle of the bend \[°\].
        degrees: f64,
    },
    /// The points of the program do not hold the seam.
    #[error(
        "pass {pass}: the smooth path through the points of the program leaves the saddle by {distance_mm:.4} mm, \
         the bound is {bound_mm} mm: the pipes are too near to tangent"
    )]
    Coarse {
        /// The first pass is 1.
        pass: usize,
        /// Largest distance.
        distance_mm: f64,
        /// Bound.
        bound_mm: f64,
    },
    /// The program is not of this part.
    #[error("the program has {paths} welds and the part {passes} passes: plan it again")]
    Passes {
        /// Welding paths of the program.
        paths: usize,
        /// Passes of the part.
        passes: usize,
    },
}

/// Why no saddle comes from taught points. Reads as one sentence.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TaughtError {
    /// Fewer points than unknowns.
    #[error(
        "{points} taught points, but {needed} are needed at least to find the place of the machine and {keys}: teach \
         more, or give dimensions"
    )]
    TooFew {
        /// How many there are.
        points: usize,
        /// How many are needed.
        needed: usize,
        /// Keys that are not given.
        keys: String,
    },
    /// All points nearly the same.
    #[error(
        "the taught points are all at one place, within {spread_mm:.2} mm: teach them all around the branch"
    )]
    OnePlace {
        /// Largest distance of two of them.
        spread_mm: f64,
    },
    /// Collinear.
    #[error(
        "the taught points lie on a line: all are within {off_line_mm:.2} mm of it over its {spread_mm:.1} mm; teach \
         them all around the branch"
    )]
    OnLine {
        /// Largest distance from the line through the two farthest.
        off_line_mm: f64,
        /// Distance of these two.
        spread_mm: f64,
    },
    /// The unknowns do not follow from the points.
    #[error(
        "the taught points do not determine the saddle: teach them all around the branch, or give dimensions"
    )]
    Undetermined,
    /// The points do not hold the seam everywhere.
    #[error(
        "the taught points leave the seam open by ±{unsure_mm:.2} mm at waist {waist_deg:.0}°, {within_mm} mm are \
         allowed: teach points there, or give dimensions"
    )]
    Unsure {
        /// Two standard deviations.
        unsure_mm: f64,
        /// Where.
        waist_deg: f64,
        /// Allowed (taught_within_mm).
        within_mm: f64,
    },
    /// No pipes make these points.
    #[error("no saddle of two pipes lies near the taught points: check the dimensions given")]
    NoSaddle,
    /// A point is off.
    #[error(
        "line {line}: this taught point is {worst_mm:.2} mm from the best saddle, {within_mm} mm are allowed (rms of all \
         {rms_mm:.2} mm, on average {outside_mm:.2} mm outside the branch): teach it again, or check the dimensions"
    )]
    Poor {
        /// Line of the worst point.
        line: usize,
        /// Its distance.
        worst_mm: f64,
        /// Of all points.
        rms_mm: f64,
        /// Mean radius of the points minus that of the branch.
        outside_mm: f64,
        /// Allowed (taught_within_mm).
        within_mm: f64,
    },
}

impl SaddlePartError {
    /// `source` with the key of the part file that decides it.
    pub(super) fn of_pipes(source: SaddleError) -> Self {
        let key = match source {
            SaddleError::ParallelAxes { .. } => "angle_deg",
            SaddleError::Radius { pipe: "main", .. } => "main_diameter_mm",
            SaddleError::Radius { .. } => "branch_diameter_mm",
            SaddleError::NotFinite => "angle_deg, offset_mm",
            SaddleError::Apart { .. } => "offset_mm",
            SaddleError::NoIntersection { .. }
            | SaddleError::TangentPipes { .. }
            | SaddleError::VerticalTangent { .. } => "branch_diameter_mm, offset_mm",
        };
        Self::Pipes { key, source }
    }
}
