//! The next motion along a contour: the program is read ahead, in a copy, until it comes.

use crate::block::Block;
use crate::codes::{Code, Group};
use crate::interpreter::Interpreter;
use crate::pieces::Piece;
use crate::reader::Reader;

/// Most lines between two motions along a contour.
const MOST_LINES_BETWEEN: usize = 1000;
/// What reading ahead costs, in motions.
const COST: u64 = 16;

/// The motions along the contour that a copy has come to: that of the block which it began with, and the next one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Scout {
    seen: usize,
    last: Option<Piece>,
}

impl Scout {
    pub(super) fn see(&mut self, piece: Piece) {
        self.seen += 1;
        self.last = Some(piece);
    }
}

impl Reader {
    /// Looks at the motion along the contour after that of `block`, which is the next to be carried out.
    pub(crate) fn look_along_contour(&mut self, block: &Block) {
        if self.interpreter.leads_along_contour(block) {
            self.interpreter.motions += COST;
            self.interpreter.compensation.next = self.motion_along_contour(block);
        }
    }

    /// What is wrong ahead is told where it is carried out.
    fn motion_along_contour(&mut self, block: &Block) -> Option<Piece> {
        let mut ahead = self.copy_behind(block, |state| {
            state.compensation.scout = Some(Scout::default());
        })?;
        let mut goes_on = true;
        for _ in 0..MOST_LINES_BETWEEN {
            let compensation = &ahead.interpreter.compensation;
            let scout = compensation.scout?;
            if scout.seen == 2 {
                return scout.last;
            }
            if scout.seen == 0 || !compensation.is_on() || !goes_on {
                return None;
            }
            goes_on = ahead.block().ok()?;
        }
        None
    }
}

impl Interpreter {
    /// Whether a motion of `block` may be one along a contour.
    fn leads_along_contour(&self, block: &Block) -> bool {
        let begins = block
            .code(Group::Compensation)
            .is_some_and(|code| code.code != Code::CompensationOff);
        let compensation = &self.compensation;
        (begins || compensation.is_on()) && compensation.scout.is_none() && !block.words.is_empty()
    }
}
