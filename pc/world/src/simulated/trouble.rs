//! What befalls simulated boards from outside, for tests of what they make of it.

use super::{Node, SimulatedBoards};
use shared::io::{MotionFeedback, SlideFeedback};
use shared::protocol::Role;

/// Something that goes wrong, and stays so.
#[derive(Clone, Copy, Debug)]
pub enum Trouble {
    /// Inputs of the motion board read otherwise than its machine is.
    MotionInputs(fn(&mut MotionFeedback)),
    /// The same of the tracker board.
    TrackerInputs(fn(&mut SlideFeedback)),
    /// The tracker's processor stands still, and its outputs stay as they are.
    TrackerFrozen,
    /// The network cable of a board is out.
    CutOff(Role),
    /// The session of the PC ends on both boards.
    SessionEnded,
}

impl SimulatedBoards {
    /// Lets something go wrong from now on.
    pub fn befall(&mut self, trouble: Trouble) {
        match trouble {
            Trouble::MotionInputs(change) => self.motion.meddle = Some(change),
            Trouble::TrackerInputs(change) => self.tracker.meddle = Some(change),
            Trouble::TrackerFrozen => self.tracker.frozen = true,
            Trouble::CutOff(role) => self.cut_off = Some(role),
            Trouble::SessionEnded => {
                self.motion.controller.session_ended();
                self.tracker.controller.session_ended();
            }
        }
    }

    /// Whether nothing gets to `node`, or away from it.
    pub(super) fn cut_off(&self, node: Node) -> bool {
        matches!(node, Node::Board(role) if self.cut_off == Some(role))
    }
}
