//! Cutter compensation: G40, G41, G42, G41.1 and G42.1.
//!
//! The interpreter's place of the tip is that of the contour, as it is programmed. Where the tip goes beside it is made here of each
//! motion and the next one in the plane, which is looked for ahead.

mod ahead;
mod beside;
mod limits;
mod offset;
mod radius;

use super::block::Block;
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::offsets::Coordinates;
use super::pieces::Piece;
use super::program::{FeedRate, Plane, Way, Words};
use ahead::Scout;
use nalgebra::Vector2;
use offset::OffsetPiece;

/// G41 or G42 with a radius.
#[derive(Clone, Copy, Debug)]
struct Side {
    /// How far to the left of the contour the tip goes \[mm\].
    offset: f64,
    plane: Plane,
    code: &'static str,
    line: u32,
}

/// What holds, and how far the contour has come.
#[derive(Clone, Debug, Default)]
pub(super) struct Compensation {
    side: Option<Side>,
    /// Where the tip is in the plane, if not where the program says \[mm\].
    aside: Option<(Plane, Vector2<f64>)>,
    /// The last motion along the contour.
    before: Option<OffsetPiece>,
    /// The one after that of the block that is carried out.
    next: Option<Piece>,
    scout: Option<Scout>,
    corners: radius::Corners,
}

impl Compensation {
    /// Whether the tip goes beside the contour.
    pub(super) fn is_on(&self) -> bool {
        self.side.is_some()
    }

    /// How far to the left of the contour the tip goes \[mm\].
    pub(super) fn left(&self) -> Option<f64> {
        self.side.map(|side| side.offset)
    }

    /// Where the tip is in the plane, if not where the program says \[mm\].
    pub(super) fn aside(&self) -> Option<(Plane, [f64; 2])> {
        self.aside.map(|(plane, place)| (plane, [place.x, place.y]))
    }
}

impl Interpreter {
    /// G40, G41 and G42 of a block, and what must not stand beside them.
    pub(super) fn compensate(&mut self, block: &Block, claims: &Claims) -> Result<(), NcError> {
        self.compensation.corners.block(block);
        let code = block.code(Group::Compensation);
        if code.is_some_and(|code| code.code == Code::CompensationOff) {
            // From the end of the contour it goes on from beside it.
            (self.compensation.side, self.compensation.before) = (None, None);
        } else if let Some(code) = code {
            self.check_off(code.name, code.place)?;
            let offset = self.offset(*code, block, claims)?;
            self.compensation.side = (offset != 0.0).then_some(Side {
                offset,
                plane: self.modal.plane,
                code: code.name,
                line: code.place.line,
            });
        }
        self.check_beside_contour(block)
    }

    /// A motion from `from` to where the tip is now by the words, as a rapid without a feed.
    pub(super) fn go(
        &mut self,
        block: &Block,
        (way, words): (Way, Words),
        from: Option<Coordinates>,
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        if let Some(side) = self.compensation.side {
            return self.go_beside(block, side, (way, words), from, feed, place);
        }
        if self.compensation.aside.is_some() {
            return self.go_back(way, words, feed, place);
        }
        match feed {
            Some(feed) => self.feed_to_corner(block, (way, words), from, feed, place),
            None => {
                self.rapid(way, words, place)?;
                self.has_come(from);
                Ok(())
            }
        }
    }

    /// Whether the tip is not where the program says: the next motion leads there even if it says nothing new.
    pub(super) fn has_to_come_back(&self) -> bool {
        self.compensation.side.is_none() && self.compensation.aside.is_some()
    }

    /// Whether an axis is not where the program says.
    pub(super) fn is_beside(&self, axis: usize) -> bool {
        let aside = self.compensation.aside;
        aside.is_some_and(|(plane, _)| plane.axes().contains(&axis))
    }

    /// The first motion after G40.
    fn go_back(
        &mut self,
        way: Way,
        mut words: Words,
        feed: Option<FeedRate>,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let Some((plane, _)) = self.compensation.aside else {
            return Ok(());
        };
        if way != Way::Line {
            let (code, why) = (
                "G40",
                "the first motion after it is straight, and leads away from the contour",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        if plane.axes().iter().all(|axis| words.axes[*axis].is_none()) {
            let text = "the first motion after G40 leads to the programmed place in the plane, as on LinuxCNC, also where it names no axis of that: other controllers wait for one that does";
            self.tell_once(text.to_owned(), place);
        }
        for axis in plane.axes() {
            words.axes[axis] = Some(self.at[axis]);
        }
        self.compensation.aside = None;
        self.emit(way, words, feed, place)
    }
}
