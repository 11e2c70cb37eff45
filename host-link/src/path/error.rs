//! Why a program path cannot be run on this machine.

use super::CAPACITY;
use shared::geometry::{AttitudeError, PoseError, SplineError};
use shared::kinematics::KinematicsError;
use shared::motion::MAX_EVENTS;
use thiserror::Error;

/// Why a program path cannot be run on this machine.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PathError {
    /// An axis would leave its travel.
    #[error(
        "line {line}: axis {axis} would have to go to {position:.3}, {beyond:.3} beyond its travel ({min}…{max} {unit})"
    )]
    Travel {
        /// Line of the program.
        line: u32,
        /// Axis or V slide.
        axis: &'static str,
        /// Where it would go.
        position: f64,
        /// By how much too far.
        beyond: f64,
        /// Travel.
        min: f64,
        /// Travel.
        max: f64,
        /// mm or °.
        unit: &'static str,
    },
    /// An axis cannot follow that fast.
    #[error(
        "line {line}: the feed of {feed:.0} mm/min is too high, the {quantity} of {axis} allows {largest:.0} mm/min"
    )]
    Feed {
        /// Line of the program.
        line: u32,
        /// Wanted \[mm/min\].
        feed: f64,
        /// Possible \[mm/min\].
        largest: f64,
        /// Axis or V slide.
        axis: &'static str,
        /// Speed or acceleration.
        quantity: &'static str,
    },
    /// A beam cannot give that much.
    #[error("line {line}: {watt} W are more than beam {} gives, at most {largest} W", side + 1)]
    Power {
        /// Line of the program.
        line: u32,
        /// 0 or 1.
        side: u8,
        /// Wanted.
        watt: f64,
        /// Power at +10 V.
        largest: f64,
    },
    /// The speed must be positive.
    #[error("a feed of {0} mm/min is not possible")]
    NoFeed(f64),
    /// G1 without travel of the tip.
    #[error("line {line}: G1 must move the tip; turn the head alone with G0")]
    NoTravel {
        /// Line of the program.
        line: u32,
    },
    /// A corner within a smooth path.
    #[error(
        "line {line}: a corner of {degrees:.0}° within a path, which must be smooth; stop at the corner with G61.1"
    )]
    Corner {
        /// Line of the program.
        line: u32,
        /// Its angle.
        degrees: f64,
    },
    /// Two points between which the head would turn by half a turn.
    #[error("line {line}: the head cannot turn there: {source}")]
    Attitude {
        /// Line of the program.
        line: u32,
        /// Why.
        source: AttitudeError,
    },
    /// The pose has no solution.
    #[error("line {line}: the machine cannot take this pose: {source}")]
    Kinematics {
        /// Line of the program.
        line: u32,
        /// Why.
        source: KinematicsError,
    },
    /// The channels are no pose.
    #[error("line {line}: the path is no pose there: {source}")]
    Pose {
        /// Line of the program.
        line: u32,
        /// Why.
        source: PoseError,
    },
    /// No spline through the points.
    #[error("line {line}: no smooth curve through these points: {source}")]
    Spline {
        /// Line of the program.
        line: u32,
        /// Why.
        source: SplineError,
    },
    /// More knots than the boards hold.
    #[error("line {line}: the path has {knots} points, the boards hold {CAPACITY}; use fewer G1 blocks")]
    TooLong {
        /// First line of the path.
        line: u32,
        /// How many.
        knots: usize,
    },
    /// More events than the motion board holds.
    #[error(
        "line {line}: the path has {events} M62, M63 and M67, the motion board holds {MAX_EVENTS}; use fewer"
    )]
    TooManyEvents {
        /// First line of the path.
        line: u32,
        /// How many.
        events: usize,
    },
}
