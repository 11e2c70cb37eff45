//! From blocks to paths: modal state, and what each motion means.

use super::arc;
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Place, Problem};
use super::lexer::Word;
use super::nurbs::{OpenNurbs, Progress};
use super::outputs::{Pending, Spindle, dwell, output};
use super::parser::{Block, Parsed, parse};
use super::program::{FeedRate, Motion, PathControl, Plane, Program, ProgramPath, Target, Way, Words};
use shared::io::{AXES, SIDES};

/// Choices of the operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Blocks that start with `/` are left out.
    pub block_delete: bool,
}

/// Reads a whole program.
///
/// Consecutive blocks that feed make one path, and every G0 one of its own. M62, M63 and M67 take effect at the start
/// of the next motion; M3, M4, M5, M64, M65 and M68 end a path and take effect at rest; G4 ends a path and delays the
/// next one.
pub fn interpret(text: &str, options: Options) -> Result<Program, NcError> {
    let mut reader = Interpreter::default();
    let mut percent_open = None;
    let mut percent_closed = false;
    let mut seen = false;
    let mut last = Place { line: 1, column: 1 };
    for (index, content) in text.lines().enumerate() {
        let line = index as u32 + 1;
        let first = Place { line, column: 1 };
        match parse(content, line)? {
            Parsed::Blank => continue,
            _ if percent_closed => return Err(Problem::AfterEnd.at(first)),
            Parsed::Percent(place) if !seen => percent_open = Some(place),
            Parsed::Percent(place) => {
                if percent_open.is_none() {
                    return Err(Problem::Percent.at(place));
                }
                percent_closed = true;
            }
            Parsed::Block(_) if reader.ended => return Err(Problem::AfterEnd.at(first)),
            Parsed::Block(block) if block.delete && options.block_delete => {}
            Parsed::Block(block) => reader.block(&block)?,
        }
        seen = true;
        last = first;
    }
    if let Some(open) = &reader.nurbs {
        return Err(open.left_open(last));
    }
    if !reader.ended {
        return Err(Problem::NoEnd.at(last));
    }
    if let (Some(place), false) = (percent_open, percent_closed) {
        return Err(Problem::Percent.at(place));
    }
    if reader.paths.is_empty() {
        return Err(Problem::Empty.at(last));
    }
    Ok(Program { paths: reader.paths })
}

/// How F is meant.
#[derive(Clone, Copy, PartialEq)]
enum FeedMode {
    PerMinute,
    InverseTime,
}

struct Interpreter {
    /// G0, G1, G2 or G3; none after a NURBS.
    motion: Option<Code>,
    nurbs: Option<OpenNurbs>,
    /// The last motion was a G6.2, which a G6.3 may close once more.
    closed: bool,
    tip: bool,
    plane: Plane,
    control: PathControl,
    feed_mode: FeedMode,
    /// G94 \[mm/min\].
    feed: Option<f64>,
    /// The tip was given a place.
    placed: bool,
    /// Values programmed last, as far as they still hold; V1 and V2 are 0 before.
    known: Words,
    spindle: Spindle,
    pending: Vec<Pending>,
    /// s, and where it was programmed.
    dwell: Option<(f64, Place)>,
    paths: Vec<ProgramPath>,
    /// The next motion that feeds goes on along the last path.
    open: bool,
    ended: bool,
}

impl Default for Interpreter {
    fn default() -> Self {
        Self {
            motion: None,
            nurbs: None,
            closed: false,
            tip: false,
            plane: Plane::default(),
            control: PathControl::Blend(None),
            feed_mode: FeedMode::PerMinute,
            feed: None,
            placed: false,
            known: Words::default(),
            spindle: Spindle::default(),
            pending: Vec::new(),
            dwell: None,
            paths: Vec::new(),
            open: false,
            ended: false,
        }
    }
}

/// Letters of the six axis words, in the order of [`shared::io::AXIS_NAMES`].
const AXIS_WORDS: [&str; AXES] = shared::io::AXIS_NAMES;
/// Names of the extensions.
const EXTENSION_WORDS: [&str; SIDES] = ["V1", "V2"];

impl Interpreter {
    /// Carries out a block in the order of RS274/NGC: modes and feed, outputs, spindle, dwell, motion, end.
    fn block(&mut self, block: &Block) -> Result<(), NcError> {
        if let Some(open) = &mut self.nurbs {
            if let Progress::Complete(way, words) = open.block(block)? {
                self.end_nurbs(Way::Nurbs(Box::new(way)), words);
            }
            return Ok(());
        }
        let own_motion = block.code(Group::Motion).map(|code| code.code);
        let modal = self.motion.filter(|_| own_motion.is_none());
        let claims = Claims::of(block, modal)?;
        self.modes(block, &claims)?;
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
        if let (FeedMode::InverseTime, Some(f), false) = (self.feed_mode, block.word("F"), feeds) {
            return Err(Problem::InverseTimeAlone.at(f.place));
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

    /// Modal codes, and F.
    fn modes(&mut self, block: &Block, claims: &Claims) -> Result<(), NcError> {
        for code in &block.codes {
            match code.code {
                Code::TipOn => self.tip = true,
                Code::TipOff => self.tip = false,
                Code::PlaneXy => self.plane = Plane::Xy,
                Code::PlaneZx => self.plane = Plane::Zx,
                Code::PlaneYz => self.plane = Plane::Yz,
                Code::ExactPath => self.control = PathControl::ExactPath,
                Code::ExactStop => self.control = PathControl::ExactStop,
                Code::Continuous => self.control = blend(claims)?,
                Code::InverseTime => self.set_feed_mode(FeedMode::InverseTime),
                Code::PerMinute => self.set_feed_mode(FeedMode::PerMinute),
                Code::Rapid
                | Code::Feed
                | Code::ArcClockwise
                | Code::ArcCounterClockwise
                | Code::UniformNurbs
                | Code::KnotNurbs => self.motion = Some(code.code),
                Code::UniformNurbsEnd | Code::KnotNurbsEnd => {
                    // All of a G6.2 may have been said before its G6.3.
                    if !(std::mem::take(&mut self.closed) && code.code == Code::KnotNurbsEnd) {
                        return Err(Problem::NothingToClose(code.name).at(code.place));
                    }
                    self.motion = None;
                }
                // These have their own places.
                Code::OutputOn
                | Code::OutputOff
                | Code::OutputOnNow
                | Code::OutputOffNow
                | Code::WaitForInput
                | Code::Analog
                | Code::AnalogNow
                | Code::SpindleClockwise
                | Code::SpindleCounterClockwise
                | Code::SpindleOff
                | Code::Dwell
                | Code::MachineAxes
                | Code::End => {}
                // These confirm the only state there is.
                Code::Millimetres | Code::CompensationOff | Code::WorldOffset | Code::Absolute => {}
            }
        }
        if let Some(f) = block.word("F") {
            if f.value <= 0.0 {
                return Err(value_error(f, "a feed is above 0"));
            }
            if self.feed_mode == FeedMode::PerMinute {
                self.feed = Some(f.value);
            }
        }
        Ok(())
    }

    /// A feed of the other mode means nothing any more.
    fn set_feed_mode(&mut self, mode: FeedMode) {
        if self.feed_mode != mode {
            self.feed_mode = mode;
            self.feed = None;
        }
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
            });
            self.open = false;
        }
    }

    /// G53: the axes named go, in axis space, where they are told to.
    fn axes_motion(&mut self, block: &Block, place: Place) -> Result<(), NcError> {
        if self.motion != Some(Code::Rapid) {
            return Err(Problem::AxesNeedRapid.at(place));
        }
        if let Some(word) = EXTENSION_WORDS.iter().find_map(|w| block.word(w)) {
            return Err(Problem::Orphan(word.label()).at(word.place));
        }
        let words = words(block);
        if words.axes.iter().all(Option::is_none) {
            let (code, word) = ("G53", "an axis word");
            return Err(Problem::Missing { code, word }.at(place));
        }
        if let Some(pending) = self.pending.iter().find(|pending| pending.opens()) {
            return Err(Problem::OnInAxes(pending.code).at(pending.place));
        }
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
                || self.motion.is_some_and(own)
        };
        let first_word = block.words.iter().find(is_motion).map(|word| word.place);
        let Some(place) = nurbs.map(|code| code.place).or(first_word) else {
            return Ok(false);
        };
        let Some(mode) = self.motion else {
            return Err(Problem::NoMotion.at(place));
        };
        if !self.tip {
            return Err(Problem::NotTip.at(place));
        }
        let words = words(block);
        let rapid = mode == Code::Rapid;
        let places = rapid && words.axes[..3].iter().all(Option::is_some);
        if !(self.placed || places) {
            return Err(Problem::FirstMotion.at(place));
        }
        self.closed = false;
        if rapid {
            if self.learn(&words) {
                self.placed = true;
                self.rapid(Way::Line, words, place);
            }
            return Ok(false);
        }
        let feed = self.feed_rate(block, mode, place)?;
        if is_nurbs(mode) {
            if mode == Code::UniformNurbs && self.plane != Plane::Xy {
                return Err(Problem::NurbsPlane.at(place));
            }
            self.nurbs = Some(OpenNurbs::begin(block, claims, mode, place, feed)?);
            return Ok(true);
        }
        let way = match mode {
            Code::Feed => Way::Line,
            _ => Way::Arc(arc::way(claims, mode, self.plane, place)?),
        };
        // An arc without a way is a full circle.
        if self.learn(&words) || way != Way::Line {
            self.feed_motion(way, words, feed, place);
        }
        Ok(true)
    }

    /// A complete NURBS. No motion goes on after it.
    fn end_nurbs(&mut self, way: Way, words: Words) {
        let Some(open) = self.nurbs.take() else { return };
        self.learn(&words);
        self.feed_motion(way, words, open.feed, open.place);
        self.closed = self.motion == Some(Code::KnotNurbs);
        self.motion = None;
    }

    fn feed_rate(&self, block: &Block, mode: Code, place: Place) -> Result<FeedRate, NcError> {
        match self.feed_mode {
            FeedMode::PerMinute => {
                let feed = self.feed.ok_or(Problem::NoFeed(mode.name()).at(place))?;
                Ok(FeedRate::PerMinute(feed))
            }
            FeedMode::InverseTime => {
                let f = block.word("F");
                let f = f.ok_or(Problem::NoInverseTime(mode.name()).at(place))?;
                Ok(FeedRate::InverseTime(f.value))
            }
        }
    }

    fn rapid(&mut self, way: Way, words: Words, place: Place) {
        let target = Target {
            way,
            words,
            feed: None,
            control: self.control,
            place,
        };
        self.start_path(Motion::Rapid, target);
        self.open = false;
    }

    /// Goes on along an open path, or starts one.
    fn feed_motion(&mut self, way: Way, words: Words, feed: FeedRate, place: Place) {
        let target = Target {
            way,
            words,
            feed: Some(feed),
            control: self.control,
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

/// G64 with its P. Q would leave points out, which is never done.
fn blend(claims: &Claims) -> Result<PathControl, NcError> {
    let [p, q] = ["P", "Q"].map(|word| claims.word(Code::Continuous, word));
    if let Some(p) = p.filter(|p| p.value <= 0.0) {
        return Err(value_error(
            p,
            "a tolerance is above 0 mm; without any, write G61",
        ));
    }
    if let Some(q) = q.filter(|q| q.value != 0.0) {
        return Err(value_error(
            q,
            "no point of a program is left out; write Q0, or no Q",
        ));
    }
    Ok(PathControl::Blend(p.map(|p| p.value)))
}

/// What `block` says of where to.
pub(super) fn words(block: &Block) -> Words {
    let value = |name: &str| block.word(name).map(|word| word.value);
    Words {
        axes: AXIS_WORDS.map(value),
        extension: EXTENSION_WORDS.map(value),
    }
}

pub(super) fn number_below(value: f64, count: u8) -> Option<u8> {
    (0..count).find(|n| f64::from(*n) == value)
}

pub(super) fn value_error(word: &Word, reason: &'static str) -> NcError {
    Problem::Value {
        word: word.label(),
        value: word.value,
        reason,
    }
    .at(word.place)
}
