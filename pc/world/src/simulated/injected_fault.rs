//! Faults that tests inject into simulated boards.

use super::{Node, SimulatedBoards};
use shared::io::{MotionFeedback, SlideFeedback};
use shared::protocol::Role;

/// A fault from outside the boards; it is permanent.
#[derive(Clone, Copy, Debug)]
pub enum InjectedFault {
    /// The inputs of the motion board are changed by this function after they were read.
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
    /// Injects `fault` from now on.
    pub fn inject(&mut self, fault: InjectedFault) {
        match fault {
            InjectedFault::MotionInputs(change) => self.motion.changed_inputs = Some(change),
            InjectedFault::TrackerInputs(change) => self.tracker.changed_inputs = Some(change),
            InjectedFault::TrackerFrozen => self.tracker.frozen = true,
            InjectedFault::CutOff(role) => self.cut_off = Some(role),
            InjectedFault::SessionEnded => {
                self.motion.controller.session_ended();
                self.tracker.controller.session_ended();
            }
        }
    }

    /// Whether `node` is disconnected: nothing is received from it or sent to it.
    pub(super) fn cut_off(&self, node: Node) -> bool {
        matches!(node, Node::Board(role) if self.cut_off == Some(role))
    }
}
