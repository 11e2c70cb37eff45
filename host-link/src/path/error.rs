//! Why a program path cannot be run on this machine.

use super::CAPACITY;
use shared::geometry::{ArcError, AttitudeError, PoseError, SplineError};
use shared::io::AXIS_NAMES;
use shared::kinematics::KinematicsError;
use shared::motion::MAX_EVENTS;
use thiserror::Error;

/// Why a program path cannot be run on this machine.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PathError {
    /// A word of an axis or slide that the machine does not have.
    #[error("line {line}: {machine} has no {word}; its words are {fitted}, and X Y Z of the tip")]
    NotFitted {
        /// Line of the program.
        line: u32,
        /// The word.
        word: &'static str,
        /// The machine.
        machine: String,
        /// What it has.
        fitted: String,
    },
    /// The first motion of the tip leaves something open.
    #[error(
        "line {line}: the first motion of the tip must say how all axes of {machine} stand: {missing} missing"
    )]
    Incomplete {
        /// Line of the program.
        line: u32,
        /// Words that it needs.
        missing: String,
        /// The machine.
        machine: String,
    },
    /// A beam that the machine does not have, or tracking.
    #[error("line {line}: {machine} has no {output}")]
    NoOutput {
        /// Line of the program.
        line: u32,
        /// What is missing.
        output: String,
        /// The machine.
        machine: String,
    },
    /// A rotary axis that does not come to stand as the program says.
    #[error("line {line}: {axis} would come to {reached:.3}°, not to {programmed:.3}°: {advice}")]
    Turned {
        /// Line of the program.
        line: u32,
        /// The axis.
        axis: &'static str,
        /// Where it should stand \[°\].
        programmed: f64,
        /// Where it would stand \[°\].
        reached: f64,
        /// What to do.
        advice: &'static str,
    },
    /// An axis would be here and, at once, there.
    #[error(
        "line {line}: {axis} would have to jump from {from:.1} to {to:.1} mm (or °): the tool passes a pole or half a turn there; go around it, in smaller pieces, or turn the axis with G53 G0"
    )]
    Jump {
        /// Line of the program.
        line: u32,
        /// The axis.
        axis: &'static str,
        /// Where it is (mm or °).
        from: f64,
        /// Where it would be (mm or °).
        to: f64,
    },
    /// No arc between these ends.
    #[error("line {line}: no arc here: {source}")]
    Arc {
        /// Line of the program.
        line: u32,
        /// Why.
        source: ArcError,
    },
    /// R for an arc whose ends are the same.
    #[error("line {line}: R tells no centre for a full circle; use I J")]
    CircleByRadius {
        /// Line of the program.
        line: u32,
    },
    /// R that does not reach.
    #[error(
        "line {line}: the ends of the arc are {distance:.4} mm apart, so R must be at least half of that, not {radius}"
    )]
    SmallRadius {
        /// Line of the program.
        line: u32,
        /// R \[mm\].
        radius: f64,
        /// Distance of the ends in the XY plane \[mm\].
        distance: f64,
    },
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
    /// One speed for a path with several feeds.
    #[error(
        "line {line}: the path has several feeds, one speed cannot take their place; leave the speed out, or write one F"
    )]
    SeveralFeeds {
        /// First line of the path.
        line: u32,
    },
    /// G1 without travel of the tip.
    #[error("line {line}: G1 must move the tip; turn axes alone with G0")]
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
    #[error("line {line}: the path has {knots} points, the boards hold {CAPACITY}; use fewer blocks")]
    TooLong {
        /// First line of the path.
        line: u32,
        /// How many.
        knots: usize,
    },
    /// More events than the motion board holds.
    #[error(
        "line {line}: the path has {events} M62, M63, M67 and changes of F, the motion board holds {MAX_EVENTS}; use fewer"
    )]
    TooManyEvents {
        /// First line of the path.
        line: u32,
        /// How many.
        events: usize,
    },
}

impl PathError {
    /// Axis slot `axis` stands at `reached` instead of `programmed` \[°\].
    pub(super) fn turned(line: u32, axis: usize, programmed: f64, reached: f64) -> Self {
        let turns = (reached - programmed) / 360.0;
        let advice = if (turns - turns.round()).abs() < 1e-6 {
            "a block turns the short way; write it as several blocks of less than 180°"
        } else {
            "the tip decides how this axis stands; correct the word, or X Y Z"
        };
        Self::Turned {
            line,
            axis: AXIS_NAMES[axis],
            programmed,
            reached,
            advice,
        }
    }
}
