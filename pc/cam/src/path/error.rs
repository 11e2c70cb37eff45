//! Why a program path cannot be run on this machine.

use super::{CAPACITY, FeedTooHigh, MAX_EVENTS, WeldError};
use crate::attitude::AttitudeError;
use config::table::FARTHEST_MM;
use curves::SplineError;
use curves::nurbs::NurbsError;
use nc::{NcError, SourcePosition};
use shared::geometry::{Arc, ArcError, PoseError};
use shared::io::AXIS_NAMES;
use shared::kinematics::KinematicsError;
use thiserror::Error;

/// Why a program path cannot be run on this machine.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PathError {
    /// The program cannot be read again.
    #[error(transparent)]
    Program(#[from] NcError),
    /// A motion that is out of all proportion.
    #[error(
        "{place}: the way there is {length:.0} mm long, and no machine goes farther than {FARTHEST_MM} mm at once: correct \
         the word, or the machine file"
    )]
    TooFar {
        /// Where in the program.
        place: SourcePosition,
        /// How long \[mm\].
        length: f64,
    },
    /// A word of an axis or slide that the machine does not have.
    #[error("{place}: {machine} has no {word}; its words are {fitted}, and X Y Z of the tip")]
    NotFitted {
        /// Where in the program.
        place: SourcePosition,
        /// The word.
        word: &'static str,
        /// The machine.
        machine: String,
        /// What it has.
        fitted: String,
    },
    /// The program was read for another start.
    #[error(
        "{place}: the program goes on from where the tip is when it begins, and was read for another place"
    )]
    OtherStart {
        /// Where it first does.
        place: SourcePosition,
    },
    /// Nothing that moves.
    #[error("the program does not move the machine")]
    Empty,
    /// M3, M4, M5 or S on a machine without a spindle.
    #[error(
        "{place}: {code} needs a spindle, and {machine} has none: switch its beams with M62 P, M63 P and M67 E Q, or have M3, M4, M5 and S do it: laser in [program] of the machine file"
    )]
    NoSpindle {
        /// Where in the program.
        place: SourcePosition,
        /// The code.
        code: &'static str,
        /// The machine.
        machine: String,
    },
    /// A beam, output or input that the machine does not have, or tracking.
    #[error("{place}: {machine} has no {output}")]
    NoOutput {
        /// Where in the program.
        place: SourcePosition,
        /// What is missing.
        output: String,
        /// The machine.
        machine: String,
    },
    /// A rotary axis that does not come to stand as the program says.
    #[error("{place}: {axis} would come to {reached:.3}°, not to {programmed:.3}°: {advice}")]
    Turned {
        /// Where in the program.
        place: SourcePosition,
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
        "{place}: {axis} would have to jump from {from:.1} to {to:.1} mm (or °): the tool passes a pole or half a turn there; go around it, in smaller pieces, or turn the axis with G53 G0"
    )]
    Jump {
        /// Where in the program.
        place: SourcePosition,
        /// The axis.
        axis: &'static str,
        /// Where it is (mm or °).
        from: f64,
        /// Where it would be (mm or °).
        to: f64,
    },
    /// No arc between these ends.
    #[error("{place}: no arc here: {source}")]
    Arc {
        /// Where in the program.
        place: SourcePosition,
        /// Why.
        source: ArcError,
    },
    /// No curve by these control points, weights and knots.
    #[error("{place}: no NURBS here: {source}")]
    Nurbs {
        /// Where in the program.
        place: SourcePosition,
        /// Why.
        source: NurbsError,
    },
    /// A NURBS that does not begin where the tip is.
    #[error(
        "{place}: the first control point is {distance:.4} mm from where the tip is; move there first, or leave its X Y Z out"
    )]
    NurbsStart {
        /// Where in the program.
        place: SourcePosition,
        /// How far \[mm\].
        distance: f64,
    },
    /// A NURBS that stands still or turns sharply on its way.
    #[error(
        "{place}: the NURBS has a corner of {degrees:.1}° after {s:.3} mm; end it there and write the rest as another one"
    )]
    NurbsCorner {
        /// Where in the program.
        place: SourcePosition,
        /// The corner \[°\].
        degrees: f64,
        /// Where on the curve \[mm\].
        s: f64,
    },
    /// A NURBS with control points at one place.
    #[error("{place}: the NURBS has no direction after {s:.3} mm: move control points that coincide apart")]
    NurbsStands {
        /// Where in the program.
        place: SourcePosition,
        /// Where on the curve \[mm\].
        s: f64,
    },
    /// R for an arc whose ends are the same.
    #[error("{place}: R does not define the centre of a full circle; use I J K")]
    CircleByRadius {
        /// Where in the program.
        place: SourcePosition,
    },
    /// R that does not reach.
    #[error(
        "{place}: half the distance of the arc's ends is {half:.4} mm, and R is less than that by {:.4} mm; {limit:.4} mm is \
         allowed here ({}); correct R or the end",
        half - radius,
        Arc::RADIUS_LIMITS
    )]
    SmallRadius {
        /// Where in the program.
        place: SourcePosition,
        /// R, however long the arc \[mm\].
        radius: f64,
        /// Half the distance of the ends in the plane of the arc \[mm\].
        half: f64,
        /// By how much R may be less \[mm\].
        limit: f64,
    },
    /// An axis would leave its travel.
    #[error(
        "{place}: axis {axis} would have to go to {position:.3}, {beyond:.3} beyond its travel ({min}…{max} {unit})"
    )]
    Travel {
        /// Where in the program.
        place: SourcePosition,
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
    /// A V slide cannot follow that fast, and the planner of the motion board does not slow down for slides.
    #[error("{0}; lower F to that, for the machine does not slow down for a slide")]
    Slide(FeedTooHigh),
    /// The speed must be constant, and an axis does not allow it.
    #[error("{0}; lower F to that, for the speed must be constant with the beam on")]
    NotConstant(FeedTooHigh),
    /// M4, where nothing turns the spindle the other way.
    #[error(
        "{place}: the spindle of {machine} turns clockwise only: write M3, or name the output that turns it the other way by spindle_reverse in [program] of the machine file"
    )]
    SpindleSense {
        /// Where in the program.
        place: SourcePosition,
        /// The machine.
        machine: String,
    },
    /// The spindle is not that fast.
    #[error("{place}: {rpm} r/min is more than the maximum of the spindle, {largest} r/min")]
    SpindleSpeed {
        /// Where in the program.
        place: SourcePosition,
        /// Wanted.
        rpm: f64,
        /// Speed at +10 V.
        largest: f64,
    },
    /// A beam cannot give that much.
    #[error("{place}: {watt} W is more than the maximum of beam {}, {largest} W", side + 1)]
    Power {
        /// Where in the program.
        place: SourcePosition,
        /// 0 or 1.
        side: u8,
        /// Wanted.
        watt: f64,
        /// Power at +10 V.
        largest: f64,
    },
    /// A weld cannot be made with its weld data.
    #[error(transparent)]
    Weld(#[from] WeldError),
    /// An analog output cannot give that much.
    #[error("{place}: {value} is more than the maximum of analog output {}, {largest}", output + 1)]
    Level {
        /// Where in the program.
        place: SourcePosition,
        /// 0 or 1.
        output: u8,
        /// Wanted.
        value: f64,
        /// Value at +10 V.
        largest: f64,
    },
    /// The speed must be positive.
    #[error("{place}: a feed of {mm_min} mm/min is not possible")]
    NoFeed {
        /// Where in the program.
        place: SourcePosition,
        /// The feed.
        mm_min: f64,
    },
    /// A block that never ends.
    #[error(
        "{place}: with a feed of {mm_min:e} mm/min the {length:.3} mm to here take longer than a day: correct F"
    )]
    TooSlow {
        /// Where in the program.
        place: SourcePosition,
        /// The feed.
        mm_min: f64,
        /// Length of the block \[mm\].
        length: f64,
    },
    /// One speed for a path with several feeds.
    #[error(
        "{place}: the path has several feeds, which one speed cannot replace; leave the speed out, or write one F"
    )]
    SeveralFeeds {
        /// Where its path begins.
        place: SourcePosition,
    },
    /// A feed of a V slide alone.
    #[error(
        "{place}: nothing but a V slide moves, for which there is no feed; move it with G0, or together with the tip"
    )]
    NoTravel {
        /// Where in the program.
        place: SourcePosition,
    },
    /// A corner within a smooth path.
    #[error(
        "{place}: a corner of {degrees:.0}° within a path, which must be smooth; stop at the corner with G61.1"
    )]
    Corner {
        /// Where in the program.
        place: SourcePosition,
        /// Its angle.
        degrees: f64,
    },
    /// Two points between which the head would turn by half a turn.
    #[error("{place}: the head cannot turn there: {source}")]
    Attitude {
        /// Where in the program.
        place: SourcePosition,
        /// Why.
        source: AttitudeError,
    },
    /// The pose has no solution.
    #[error("{place}: the machine cannot take this pose: {source}")]
    Kinematics {
        /// Where in the program.
        place: SourcePosition,
        /// Why.
        source: KinematicsError,
    },
    /// The channels are no pose.
    #[error("{place}: the path does not define a pose there: {source}")]
    Pose {
        /// Where in the program.
        place: SourcePosition,
        /// Why.
        source: PoseError,
    },
    /// No spline through the points.
    #[error("{place}: no smooth curve through these points: {source}")]
    Spline {
        /// Where in the program.
        place: SourcePosition,
        /// Why.
        source: SplineError,
    },
    /// More knots than the boards hold.
    #[error("{place}: the path has {knots} points, the boards hold {CAPACITY}; use fewer blocks")]
    TooLong {
        /// Where its path begins.
        place: SourcePosition,
        /// How many.
        knots: usize,
    },
    /// More events than the motion board holds.
    #[error(
        "{place}: the path has {events} outputs and changes of F, at most {MAX_EVENTS} are possible; use fewer"
    )]
    TooManyEvents {
        /// Where its path begins.
        place: SourcePosition,
        /// How many.
        events: usize,
    },
}

impl PathError {
    /// Axis slot `axis` stands at `reached` instead of `programmed` \[°\].
    pub(super) fn turned(place: SourcePosition, axis: usize, programmed: f64, reached: f64) -> Self {
        let turns = (reached - programmed) / 360.0;
        let advice = if (turns - turns.round()).abs() < 1e-6 {
            "a block turns the short way; write it as several blocks of less than 180°"
        } else {
            "the position of this axis follows from the tip; correct the word, or X Y Z"
        };
        Self::Turned {
            place,
            axis: AXIS_NAMES[axis],
            programmed,
            reached,
            advice,
        }
    }
}
