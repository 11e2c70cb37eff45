//! From blocks to paths: modal state, and what each motion means.

use super::error::{NcError, Place, Problem};
use super::lexer::Word;
use super::outputs::{Pending, Waiting, take_events, waiting};
use super::parser::{Block, Code, Group, Parsed, parse};
use super::program::{ArcForm, Motion, Program, ProgramFeed, ProgramPath, Target, Way, Words};
use shared::geometry::Turn;
use shared::io::{AXES, SIDES};
use shared::protocol::PathAction;

/// Choices of the operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Blocks that start with `/` are left out.
    pub block_delete: bool,
}

/// Reads a whole program.
///
/// Consecutive G1, G2 and G3 blocks make one path; every G0, and with G61.1 every block, is a path of its own.
/// M62, M63 and M67 take effect at the start of the next motion, G4 ends a path and delays the next one.
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

#[derive(Clone, Copy, PartialEq)]
enum MotionMode {
    Rapid,
    Line,
    Arc(Turn),
}

#[derive(Default)]
struct Interpreter {
    motion: Option<MotionMode>,
    tip: bool,
    exact_stop: bool,
    /// mm/min.
    feed: Option<f64>,
    /// The tip was given a place.
    placed: bool,
    /// Values programmed last, as far as they still hold; V1 and V2 are 0 before.
    known: Words,
    pending: Vec<Pending>,
    /// s, and where it was programmed.
    dwell: Option<(f64, Place)>,
    paths: Vec<ProgramPath>,
    /// The next G1, G2 or G3 goes on along the last path.
    open: bool,
    ended: bool,
}

/// Letters of the six axis words, in the order of [`shared::io::AXIS_NAMES`].
const AXIS_WORDS: [&str; AXES] = shared::io::AXIS_NAMES;
/// Names of the extensions.
const EXTENSION_WORDS: [&str; SIDES] = ["V1", "V2"];
/// Words of an arc.
const ARC_WORDS: [&str; 3] = ["I", "J", "R"];

impl Interpreter {
    /// Carries out a block in the order of RS274/NGC: feed, outputs, dwell, modes, motion, end.
    fn block(&mut self, block: &Block) -> Result<(), NcError> {
        if let Some(f) = block.word("F") {
            if f.value <= 0.0 {
                return Err(value_error(f, "a feed is above 0 mm/min"));
            }
            self.feed = Some(f.value);
        }
        match waiting(block)? {
            Some(Waiting::Output(pending)) => self.pending.push(pending),
            Some(Waiting::Dwell(time, place)) => {
                let before = self.dwell.map_or(0.0, |(time, _)| time);
                self.dwell = Some((before + time, place));
                self.open = false;
            }
            None => {}
        }
        for code in &block.codes {
            match code.code {
                Code::TipOn => self.tip = true,
                Code::TipOff => self.tip = false,
                Code::ExactStop => self.exact_stop = true,
                Code::Continuous => self.exact_stop = false,
                Code::Rapid => self.motion = Some(MotionMode::Rapid),
                Code::Feed => self.motion = Some(MotionMode::Line),
                Code::ArcClockwise => self.motion = Some(MotionMode::Arc(Turn::Clockwise)),
                Code::ArcCounterClockwise => self.motion = Some(MotionMode::Arc(Turn::CounterClockwise)),
                // These have their own places; the others confirm the only state there is.
                Code::OutputOn
                | Code::OutputOff
                | Code::Analog
                | Code::Dwell
                | Code::MachineAxes
                | Code::End => {}
                Code::PlaneXy
                | Code::Millimetres
                | Code::CompensationOff
                | Code::WorldOffset
                | Code::Absolute
                | Code::PerMinute => {}
            }
        }
        match block.code(Group::NonModal) {
            Some(code) if code.code == Code::MachineAxes => self.axes_motion(block, code.place)?,
            _ => self.tip_motion(block)?,
        }
        if block.code(Group::Stop).is_some() {
            let waiting = self.pending.first().map(|pending| (pending.code, pending.place));
            if let Some((code, place)) = waiting.or(self.dwell.map(|(_, place)| ("G4", place))) {
                return Err(Problem::NoMotionAfter(code).at(place));
            }
            self.ended = true;
        }
        Ok(())
    }

    /// G53: the axes named go, in axis space, where they are told to.
    fn axes_motion(&mut self, block: &Block, place: Place) -> Result<(), NcError> {
        if self.motion != Some(MotionMode::Rapid) {
            return Err(Problem::AxesNeedRapid.at(place));
        }
        let foreign = EXTENSION_WORDS.iter().chain(&ARC_WORDS);
        if let Some(word) = foreign.into_iter().find_map(|w| block.word(w)) {
            return Err(Problem::Orphan(word.label()).at(word.place));
        }
        let words = words(block);
        if words.axes.iter().all(Option::is_none) {
            let (code, word) = ("G53", "an axis word");
            return Err(Problem::Missing { code, word }.at(place));
        }
        let opens = |pending: &&Pending| {
            matches!(
                pending.action,
                PathAction::Beam { on: true, .. } | PathAction::Tracking { on: true }
            )
        };
        if let Some(pending) = self.pending.iter().find(opens) {
            return Err(Problem::OnInAxes.at(pending.place));
        }
        let target = Target {
            way: Way::Axes,
            words,
            line: block.line,
        };
        self.start_path(Motion::Rapid, target);
        self.open = false;
        // Where the tip is now, the program does not say.
        self.known.axes = [None; AXES];
        Ok(())
    }

    fn tip_motion(&mut self, block: &Block) -> Result<(), NcError> {
        let is_motion = |word: &&Word| {
            let address = &word.address.as_str();
            AXIS_WORDS.contains(address) || EXTENSION_WORDS.contains(address) || ARC_WORDS.contains(address)
        };
        let Some(first_word) = block.words.iter().find(is_motion) else {
            return Ok(());
        };
        let Some(mode) = self.motion else {
            return Err(Problem::NoMotion.at(first_word.place));
        };
        if !self.tip {
            return Err(Problem::NotTip.at(first_word.place));
        }
        let words = words(block);
        let places = mode == MotionMode::Rapid && words.axes[..3].iter().all(Option::is_some);
        if !(self.placed || places) {
            return Err(Problem::FirstMotion.at(first_word.place));
        }
        let way = match mode {
            MotionMode::Arc(turn) => Way::Arc(turn, arc_form(block, first_word.place)?),
            MotionMode::Rapid | MotionMode::Line => {
                if let Some(word) = ARC_WORDS.iter().find_map(|w| block.word(w)) {
                    return Err(Problem::Orphan(word.label()).at(word.place));
                }
                Way::Line
            }
        };
        let moves = self.learn(&words);
        // An arc without a way is a full circle.
        if !moves && way == Way::Line {
            return Ok(());
        }
        self.placed = true;
        let line = block.line;
        let target = Target { way, words, line };
        if mode == MotionMode::Rapid {
            self.start_path(Motion::Rapid, target);
            self.open = false;
        } else {
            self.feed_motion(target, first_word.place)?;
        }
        Ok(())
    }

    /// G1, G2, G3: goes on along an open path, or starts one.
    fn feed_motion(&mut self, target: Target, place: Place) -> Result<(), NcError> {
        let mm_min = self.feed.ok_or(Problem::NoFeed.at(place))?;
        match self.paths.last_mut() {
            Some(path) if self.open => {
                let with_target = path.targets.len();
                if path.feeds.last().is_none_or(|feed| feed.mm_min != mm_min) {
                    path.feeds.push(ProgramFeed { with_target, mm_min });
                }
                path.targets.push(target);
                path.events.extend(take_events(&mut self.pending, with_target));
            }
            _ => {
                self.start_path(Motion::Feed, target);
                if let Some(path) = self.paths.last_mut() {
                    path.feeds.push(ProgramFeed {
                        with_target: 0,
                        mm_min,
                    });
                }
            }
        }
        self.open = !self.exact_stop;
        Ok(())
    }

    fn start_path(&mut self, motion: Motion, target: Target) {
        self.paths.push(ProgramPath {
            dwell_before_s: self.dwell.take().map_or(0.0, |(time, _)| time),
            motion,
            targets: vec![target],
            feeds: Vec::new(),
            events: take_events(&mut self.pending, 0),
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

/// What `block` says of where to.
fn words(block: &Block) -> Words {
    let value = |name: &str| block.word(name).map(|word| word.value);
    Words {
        axes: AXIS_WORDS.map(value),
        extension: EXTENSION_WORDS.map(value),
    }
}

/// I J or R of `block`, whose motion begins at `place`.
fn arc_form(block: &Block, place: Place) -> Result<ArcForm, NcError> {
    let [i, j, r] = ARC_WORDS.map(|name| block.word(name));
    match (i.or(j), r) {
        (Some(_), Some(r)) => Err(Problem::CentreAndRadius.at(r.place)),
        (Some(_), None) => Ok(ArcForm::Centre([i, j].map(|word| word.map_or(0.0, |w| w.value)))),
        (None, Some(r)) if r.value == 0.0 => Err(value_error(r, "a radius is not 0")),
        (None, Some(r)) => Ok(ArcForm::Radius(r.value)),
        (None, None) => {
            let code = block.code(Group::Motion).map_or("an arc", |code| code.name);
            let word = "I J or R";
            Err(Problem::Missing { code, word }.at(place))
        }
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
