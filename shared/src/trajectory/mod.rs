//! The path (where) and the speed along it (when).
//!
//! The motion board runs [`Element`]s through the [`Planner`], which looks ahead. [`Path`] is what the tracker board
//! looks places up in, and what planners on the PC begin with. [`RestToRest`] is one way by itself, as in homing.

pub(crate) mod curve;
mod element;
mod path;
mod planner;
mod reference;
mod rest_to_rest;
mod speed;

pub use curve::{ArcLengthCurve, CurveNumbers, NoCurve, PARAMETER_COEFFICIENTS};
pub use element::{Cubic, Element, Join, SHAPED, Shape, Tolerance};
pub use path::{Knot, Path, PathError, PathPoint, PathSpace};
pub use planner::{
    LONGEST_PATH, Output, PlanLimits, Planner, Planning, Played, Player, PlayerAccess, PushError, Way,
};
pub use reference::{ReferenceError, Unreachable, at_unit_speed, axes_at};
pub use rest_to_rest::RestToRest;
pub use speed::{SpeedLimits, SpeedState};

/// Channels of a path: position (3), T (3), N (3), V slide extensions (2).
pub const CHANNELS: usize = 11;

/// Elements that the planner of the motion board holds.
pub const ELEMENTS: usize = 128;
/// Places of the path at which it plans the speed.
pub const NODES: usize = 256;
/// The planner of the motion board, in step.
pub type BoardPlanner = Planner<ELEMENTS, NODES>;
/// The half of it that its path tick has.
pub type BoardPlayer = Player<ELEMENTS, NODES>;
/// The other half, a task of its own.
pub type BoardPlanning = Planning<NODES>;
