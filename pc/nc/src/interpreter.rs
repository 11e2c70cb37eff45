//! From blocks to paths: modal state, and what each motion means.

use super::arc;
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::lexer::Word;
use super::modal::Modal;
use super::nurbs::{OpenNurbs, Progress};
use super::outputs::{Pending, Spindle, dwell, output};
use super::parser::Block;
use super::program::{AXIS_WORDS, EXTENSION_WORDS, FeedRate, Motion, Plane, ProgramPath, Target, Way, Words};
use super::reading::RemainingBlocks;
use shared::io::AXES;

/// Choices of the operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Blocks that start with `/` are left out.
    pub block_delete: bool,
}

#[derive(Clone, Default)]
pub(super) struct Interpreter {
    modal: Modal,
    nurbs: Option<OpenNurbs>,
    /// The tip was given a place.
    placed: bool,
    /// Values programmed last, as far as they still hold; V1 and V2 are 0 before.
    known: Words,
    spindle: Spindle,
    pending: Vec<Pending>,
    /// s, and where it was programmed.
    dwell: Option<(f64, SourcePosition)>,
    paths: Vec<ProgramPath>,
    /// The next motion that feeds continues along the last path.
    open: bool,
    pub(super) ended: bool,
}

impl Interpreter {
    /// Carries out a block in the order of RS274/NGC: modes and feed, outputs, spindle, dwell, motion, end.
    pub(super) fn block(&mut self, block: &Block) -> Result<(), NcError> {
        if let Some(open) = &mut self.nurbs {
            if let Progress::Complete(way, words) = open.block(block)? {
                self.end_nurbs(Way::Nurbs(Box::new(way)), words);
            }
            return Ok(());
        }
        let own_motion = block.code(Group::Motion).map(|code| code.code);
        let modal = self.modal.motion.filter(|_| own_motion.is_none());
        let claims = Claims::of(block, modal)?;
        self.modal.block(block, &claims)?;
        let dwell = dwell(block, &claims)?;
        if let Some(pending) = output(block, &claims)? {
            self.wait(pending);
        }
        for pending in self.spindle.block(block)? {
            self.wait(pending);
        }
        if let Some((time, place)) = dwell {
            self.stand();
            let before = self.dwell.map_or(0.0, |(time, _)| time);
            self.dwell = Some((before + time, place));
            self.open = false;
        }
        let feeds = match block.code(Group::NonModal) {
            Some(code) if code.code == Code::MachineAxes => {
                self.axes_motion(block, code.place)?;
                false
            }
            _ => self.tip_motion(block, &claims)?,
        };
        if !feeds {
            self.modal.check_no_feed(block)?;
        }
        if let Some(code) = block.code(Group::Stop) {
            if let Some(stop) = self.spindle.end(code) {
                self.wait(stop);
            }
            self.stand();
            let waiting = self.pending.first().map(|pending| (pending.code, pending.place));
            if let Some((code, place)) = waiting.or(self.dwell.map(|(_, place)| ("G4", place))) {
                return Err(Problem::NoMotionAfter(code).at(place));
            }
            if let Some(open) = &self.nurbs {
                return Err(open.left_open(code.place));
            }
            self.ended = true;
        }
        Ok(())
    }

    /// The paths, if the program that ends at `last` is whole.
    pub(super) fn end(self, last: SourcePosition) -> Result<Vec<ProgramPath>, NcError> {
        if let Some(open) = &self.nurbs {
            return Err(open.left_open(last));
        }
        if !self.ended {
            return Err(Problem::NoEnd.at(last));
        }
        Ok(self.paths)
    }

    /// Keeps no more than `count` blocks of the last path; what reads the others again is made of the state between
    /// them.
    pub(super) fn trim(&mut self, count: usize, rest: impl FnOnce(Self) -> RemainingBlocks) {
        let Some(mut path) = self.paths.pop() else { return };
        if self.open && path.rest.is_none() && path.targets.len() >= count {
            let before = std::mem::take(&mut self.paths);
            let mut state = self.clone();
            self.paths = before;
            state.paths.push(path.without_blocks());
            path.rest = Some(rest(state));
        }
        if path.rest.is_some() {
            path.targets.truncate(count);
            let events = path.events.partition_point(|event| event.with_target < count);
            path.events.truncate(events);
        }
        self.paths.push(path);
    }

    /// The blocks that came to the first path since the last time, and whether more may come.
    pub(super) fn take_blocks(&mut self) -> (Option<ProgramPath>, bool) {
        let goes_on = self.open && self.paths.len() == 1;
        let taken = self.paths.first_mut().map(|path| {
            let without = path.without_blocks();
            std::mem::replace(path, without)
        });
        (taken, goes_on)
    }

    /// Keeps an event for the next motion. What takes effect at rest ends the path.
    fn wait(&mut self, pending: Pending) {
        self.open &= !pending.at_rest;
        self.pending.push(pending);
    }

    /// What waits and needs no motion takes effect while the machine stands.
    fn stand(&mut self) {
        let waiting = std::mem::take(&mut self.pending);
        let (now, later): (Vec<_>, Vec<_>) = waiting.into_iter().partition(|pending| pending.at_rest);
        self.pending = later;
        if !now.is_empty() {
            self.paths.push(ProgramPath {
                dwell_before_s: self.dwell.take().map_or(0.0, |(time, _)| time),
                motion: Motion::Stand,
                targets: Vec::new(),
                events: now.into_iter().map(|pending| pending.event(0)).collect(),
                rest: None,
            });
            self.open = false;
        }
    }

    /// G53: the axes named go to their coordinates, in axis space.
    fn axes_motion(&mut self, block: &Block, place: SourcePosition) -> Result<(), NcError> {
        if self.modal.motion != Some(Code::Rapid) {
            return Err(Problem::AxesNeedRapid.at(place));
        }
        if let Some(word) = EXTENSION_WORDS.iter().find_map(|w| block.word(w)) {
            return Err(Problem::Orphan(word.label()).at(word.place));
        }
        let words = Words::of(block);
        if words.axes.iter().all(Option::is_none) {
            let (code, word) = ("G53", "an axis word");
            return Err(Problem::Missing { code, word }.at(place));
        }
        if let Some(pending) = self.pending.iter().find(|pending| pending.opens()) {
            return Err(Problem::OnInAxes(pending.code).at(pending.place));
        }
        // In axis space the boards switch nothing on.
        self.stand();
        self.rapid(Way::Axes, words, place);
        // Where the tip is now, the program does not say.
        self.known.axes = [None; AXES];
        Ok(())
    }

    /// The motion of `block` in tip coordinates, if it has one; whether that feeds.
    fn tip_motion(&mut self, block: &Block, claims: &Claims) -> Result<bool, NcError> {
        let nurbs = block.code(Group::Motion).filter(|code| is_nurbs(code.code));
        let is_motion = |word: &&Word| {
            let address = word.address.as_str();
            let own = |code: Code| claims.word(code, address).is_some();
            AXIS_WORDS.contains(&address)
                || EXTENSION_WORDS.contains(&address)
                || self.modal.motion.is_some_and(own)
        };
        let first_word = block.words.iter().find(is_motion).map(|word| word.place);
        let Some(place) = nurbs.map(|code| code.place).or(first_word) else {
            return Ok(false);
        };
        let Some(mode) = self.modal.motion else {
            return Err(Problem::NoMotion.at(place));
        };
        if !self.modal.tip {
            return Err(Problem::NotTip.at(place));
        }
        let words = Words::of(block);
        let rapid = mode == Code::Rapid;
        let places = rapid && words.axes[..3].iter().all(Option::is_some);
        if !(self.placed || places) {
            return Err(Problem::FirstMotion.at(place));
        }
        self.modal.closed = false;
        if rapid {
            if self.learn(&words) {
                self.placed = true;
                self.rapid(Way::Line, words, place);
            }
            return Ok(false);
        }
        let feed = self.modal.feed_rate(block, mode, place)?;
        if is_nurbs(mode) {
            if mode == Code::UniformNurbs && self.modal.plane != Plane::Xy {
                return Err(Problem::NurbsPlane.at(place));
            }
            self.nurbs = Some(OpenNurbs::begin(block, claims, mode, place, feed)?);
            return Ok(true);
        }
        let way = match mode {
            Code::Feed => Way::Line,
            _ => Way::Arc(arc::way(claims, mode, self.modal.plane, place)?),
        };
        // An arc without a way is a full circle.
        if self.learn(&words) || way != Way::Line {
            self.feed_motion(way, words, feed, place);
        }
        Ok(true)
    }

    /// A complete NURBS. No motion continues after it.
    fn end_nurbs(&mut self, way: Way, words: Words) {
        let Some(open) = self.nurbs.take() else { return };
        self.learn(&words);
        self.feed_motion(way, words, open.feed, open.place);
        self.modal.closed = self.modal.motion == Some(Code::KnotNurbs);
        self.modal.motion = None;
    }

    fn rapid(&mut self, way: Way, words: Words, place: SourcePosition) {
        let target = Target {
            way,
            words,
            feed: None,
            control: self.modal.control,
            place,
        };
        self.start_path(Motion::Rapid, target);
        self.open = false;
    }

    /// Goes on along an open path, or starts one.
    fn feed_motion(&mut self, way: Way, words: Words, feed: FeedRate, place: SourcePosition) {
        let target = Target {
            way,
            words,
            feed: Some(feed),
            control: self.modal.control,
            place,
        };
        match self.paths.last_mut() {
            Some(path) if self.open => {
                let with_target = path.targets.len();
                path.targets.push(target);
                let waiting = self.pending.drain(..);
                path.events
                    .extend(waiting.map(|pending| pending.event(with_target)));
            }
            _ => self.start_path(Motion::Feed, target),
        }
        self.open = true;
    }

    fn start_path(&mut self, motion: Motion, target: Target) {
        self.paths.push(ProgramPath {
            dwell_before_s: self.dwell.take().map_or(0.0, |(time, _)| time),
            motion,
            targets: vec![target],
            events: self.pending.drain(..).map(|pending| pending.event(0)).collect(),
            rest: None,
        });
    }

    /// Takes up what `words` say; whether that is anything new.
    fn learn(&mut self, words: &Words) -> bool {
        let known = &mut self.known;
        let places = known.axes.iter_mut().chain(&mut known.extension);
        let said = words.axes.iter().chain(&words.extension);
        let mut new = false;
        for (place, value) in places.zip(said) {
            if value.is_some() && place != value {
                *place = *value;
                new = true;
            }
        }
        new
    }
}

fn is_nurbs(code: Code) -> bool {
    matches!(code, Code::UniformNurbs | Code::KnotNurbs)
}
