//! Blocks that are too short for a motion of their own, as programs have them whose numbers were rounded: each is joined to
//! the straight block after it, or to the one before it.

use super::block::moves_nothing;
use super::targets::RestState;
use super::{PathError, Planner, Tip};
use nc::{Move, PathControl, ProgramPath, Way, Words};
use std::collections::VecDeque;
use std::sync::Arc;

/// Moves, their short ones joined to others. What begins with a short one begins with the next that is given, which is
/// where it is. Short ones in a row are no longer short once they lead away together.
///
/// One stays by itself, and stands for a micrometre of path, where both neighbours are arcs or NURBS, and where a path
/// ends and something is switched.
pub(super) struct ShortBlocks<M> {
    planner: Arc<Planner>,
    moves: M,
    /// Where the move in hand ends.
    tip: Tip,
    /// The last one that is not short.
    in_hand: Option<Move>,
    /// Short ones after it, as one, and where they lead.
    short: Option<(Move, Tip)>,
    ready: VecDeque<Move>,
    ended: bool,
}

impl<M: Iterator<Item = Result<Move, PathError>>> ShortBlocks<M> {
    /// `moves` from where the machine stands.
    pub(super) fn new(planner: Arc<Planner>, moves: M, from: &RestState) -> Self {
        Self {
            planner,
            moves,
            tip: from.tip,
            in_hand: None,
            short: None,
            ready: VecDeque::new(),
            ended: false,
        }
    }

    fn take(&mut self, mut next: Move) -> Result<(), PathError> {
        let before = self.short.as_ref().map_or(&self.tip, |(_, tip)| tip);
        let tip = self.planner.next_tip(&next.target, before)?;
        let straight = next.target.way == Way::Line;
        if let Some((short, _)) = self.short.take_if(|(_, at)| straight || *at == self.tip) {
            next.target.words = both(&short.target.words, &next.target.words);
            begin_with(&mut next, &short);
        }
        if straight && moves_nothing(&self.tip, &tip) {
            self.short = Some((next, tip));
            return Ok(());
        }
        if let Some((short, _)) = self.short.take() {
            self.end_with(short, Some(&mut next));
        }
        self.tip = tip;
        self.ready.extend(self.in_hand.replace(next));
        Ok(())
    }

    /// Joins `short` to the move in hand, if that is straight, and there is a `next` one with which its outputs can begin;
    /// else it is one by itself.
    fn end_with(&mut self, short: Move, next: Option<&mut Move>) {
        let has_place = next.is_some() || short.events.is_empty();
        match &mut self.in_hand {
            Some(before) if before.target.way == Way::Line && has_place => {
                let target = &mut before.target;
                target.words = both(&target.words, &short.target.words);
                if short.target.control == PathControl::ExactStop {
                    target.control = PathControl::ExactStop;
                }
                next.into_iter().for_each(|next| begin_with(next, &short));
            }
            _ => self.ready.extend(self.in_hand.replace(short)),
        }
    }

    fn finish(&mut self) {
        self.ended = true;
        if let Some((short, at)) = self.short.take() {
            let nothing = short.events.is_empty() && at == self.tip && self.in_hand.is_some();
            if !nothing {
                self.end_with(short, None);
            }
        }
        self.ready.extend(self.in_hand.take());
    }
}

impl<M: Iterator<Item = Result<Move, PathError>>> Iterator for ShortBlocks<M> {
    type Item = Result<Move, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.ready.is_empty() && !self.ended {
            let taken = match self.moves.next() {
                Some(next) => next.and_then(|next| self.take(next)),
                None => {
                    self.finish();
                    Ok(())
                }
            };
            if let Err(error) = taken {
                (self.ended, self.in_hand, self.short) = (true, None, None);
                return Some(Err(error));
            }
        }
        self.ready.pop_front().map(Ok)
    }
}

/// The words of two blocks one after the other.
fn both(first: &Words, then: &Words) -> Words {
    Words {
        axes: std::array::from_fn(|i| then.axes[i].or(first.axes[i])),
        extension: std::array::from_fn(|i| then.extension[i].or(first.extension[i])),
    }
}

/// What begins with `short` begins with `next`.
fn begin_with(next: &mut Move, short: &Move) {
    next.events.splice(0..0, short.events.iter().copied());
}

impl Planner {
    /// `path`, of which all blocks are kept, with its short blocks joined to others.
    pub(super) fn without_short_blocks(
        &self,
        path: ProgramPath,
        from: &RestState,
    ) -> Result<ProgramPath, PathError> {
        let mut joined = ProgramPath {
            targets: Vec::with_capacity(path.targets.len()),
            events: Vec::with_capacity(path.events.len()),
            ..path.clone()
        };
        let moves = Arc::new(path).moves().map(|next| next.map_err(PathError::from));
        for next in ShortBlocks::new(Arc::new(self.clone()), moves, from) {
            let Move { target, events } = next?;
            let with_target = joined.targets.len();
            joined.targets.push(target);
            joined.events.extend(events.into_iter().map(|mut event| {
                event.with_target = with_target;
                event
            }));
        }
        Ok(joined)
    }
}
