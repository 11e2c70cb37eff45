//! From blocks to paths: modal state, and what each motion means.

use super::error::{NcError, Place, Problem};
use super::lexer::Word;
use super::parser::{Block, Code, Group, Parsed, parse};
use super::program::{Motion, Program, ProgramEvent, ProgramPath, Target, Tip};
use shared::protocol::PathAction;

/// Choices of the operator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Blocks that start with `/` are left out.
    pub block_delete: bool,
}

/// Reads a whole program.
///
/// Consecutive G1 blocks make one path; every G0, and with G61.1 every G1, is a path of its own. M62, M63 and
/// M67 take effect at the start of the next motion.
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

/// M62, M63 or M67 that waits for its motion.
struct Pending {
    action: PathAction,
    code: &'static str,
    place: Place,
}

#[derive(Clone, Copy, PartialEq)]
enum MotionMode {
    Rapid,
    Feed,
}

#[derive(Default)]
struct Interpreter {
    motion: Option<MotionMode>,
    tip: bool,
    exact_stop: bool,
    /// mm/min, and where it was programmed.
    feed: Option<(f64, Place)>,
    position: Option<Tip>,
    pending: Vec<Pending>,
    paths: Vec<ProgramPath>,
    /// The next G1 goes on along the last path.
    open: bool,
    ended: bool,
}

/// Letters of the six axis words, in the order of [`shared::io::AXIS_NAMES`].
const AXIS_WORDS: [&str; 6] = shared::io::AXIS_NAMES;
/// Names of the extensions.
const EXTENSION_WORDS: [&str; 2] = ["V1", "V2"];

impl Interpreter {
    /// Carries out a block in the order of RS274/NGC: feed, outputs, modes, motion, end.
    fn block(&mut self, block: &Block) -> Result<(), NcError> {
        if let Some(f) = block.word("F") {
            if f.value <= 0.0 {
                return Err(value_error(f, "a feed is above 0 mm/min"));
            }
            self.feed = Some((f.value, f.place));
        }
        self.outputs(block)?;
        for code in &block.codes {
            match code.code {
                Code::TipOn => self.tip = true,
                Code::TipOff => self.tip = false,
                Code::ExactStop => self.exact_stop = true,
                Code::Continuous => self.exact_stop = false,
                Code::Rapid => self.motion = Some(MotionMode::Rapid),
                Code::Feed => self.motion = Some(MotionMode::Feed),
                // Outputs and the end have their own places; the others confirm the only state there is.
                Code::OutputOn | Code::OutputOff | Code::Analog | Code::End => {}
                Code::PlaneXy
                | Code::Millimetres
                | Code::CompensationOff
                | Code::WorldOffset
                | Code::Absolute
                | Code::PerMinute => {}
            }
        }
        self.motion(block)?;
        if block.code(Group::Stop).is_some() {
            if let Some(pending) = self.pending.first() {
                return Err(Problem::NoMotionAfter(pending.code).at(pending.place));
            }
            self.ended = true;
        }
        Ok(())
    }

    fn outputs(&mut self, block: &Block) -> Result<(), NcError> {
        let Some(code) = block.code(Group::Outputs) else {
            return match ["P", "E", "Q"].iter().find_map(|w| block.word(w)) {
                Some(word) => Err(Problem::Orphan(word.label()).at(word.place)),
                None => Ok(()),
            };
        };
        let need = |word: &'static str| {
            let missing = Problem::Missing {
                code: code.name,
                word,
            };
            block.word(word).ok_or(missing.at(code.place))
        };
        let foreign: &[&str] = if code.code == Code::Analog {
            &["P"]
        } else {
            &["E", "Q"]
        };
        if let Some(word) = foreign.iter().find_map(|w| block.word(w)) {
            return Err(Problem::Orphan(word.label()).at(word.place));
        }
        let action = if code.code == Code::Analog {
            let (e, q) = (need("E")?, need("Q")?);
            let Some(side) = number_below(e.value, 2) else {
                return Err(value_error(e, "E0 and E1 are the powers of beam 1 and 2"));
            };
            if q.value < 0.0 {
                return Err(value_error(q, "a power is 0 W or more"));
            }
            PathAction::Power { side, watt: q.value }
        } else {
            let p = need("P")?;
            let on = code.code == Code::OutputOn;
            match number_below(p.value, 3) {
                Some(2) => PathAction::Tracking { on },
                Some(side) => PathAction::Beam { side, on },
                None => {
                    return Err(value_error(
                        p,
                        "P0 and P1 are the beam gates 1 and 2, P2 is tracking",
                    ));
                }
            }
        };
        self.pending.push(Pending {
            action,
            code: code.name,
            place: code.place,
        });
        Ok(())
    }

    fn motion(&mut self, block: &Block) -> Result<(), NcError> {
        let first_word = block.words.iter().find(|w| {
            AXIS_WORDS.contains(&w.address.as_str()) || EXTENSION_WORDS.contains(&w.address.as_str())
        });
        let Some(first_word) = first_word else {
            return Ok(());
        };
        let Some(mode) = self.motion else {
            return Err(Problem::NoMotion.at(first_word.place));
        };
        if !self.tip {
            return Err(Problem::NotTip.at(first_word.place));
        }
        let complete = AXIS_WORDS.iter().all(|w| block.word(w).is_some());
        if self.position.is_none() && !(complete && mode == MotionMode::Rapid) {
            return Err(Problem::FirstMotion.at(first_word.place));
        }
        let tip = moved(self.position.unwrap_or_default(), block);
        if self.position == Some(tip) {
            return Ok(());
        }
        self.position = Some(tip);
        let target = Target {
            tip,
            line: block.line,
        };
        match mode {
            MotionMode::Rapid => {
                self.start_path(Motion::Rapid, target);
                self.open = false;
            }
            MotionMode::Feed => {
                let (feed, feed_place) = self.feed.ok_or(Problem::NoFeed.at(first_word.place))?;
                match self.paths.last_mut() {
                    Some(path) if self.open => {
                        if let Motion::Feed(from) = path.motion
                            && from != feed
                        {
                            return Err(Problem::FeedChange { from, to: feed }.at(feed_place));
                        }
                        let events = take_events(&mut self.pending, path.targets.len());
                        path.targets.push(target);
                        path.events.extend(events);
                    }
                    _ => self.start_path(Motion::Feed(feed), target),
                }
                self.open = !self.exact_stop;
            }
        }
        Ok(())
    }

    fn start_path(&mut self, motion: Motion, target: Target) {
        let events = take_events(&mut self.pending, 0);
        self.paths.push(ProgramPath {
            dwell_before_s: 0.0,
            motion,
            targets: vec![target],
            events,
        });
    }
}

/// The waiting events, which take effect at the start of the motion to target `with_target`.
fn take_events(pending: &mut Vec<Pending>, with_target: usize) -> Vec<ProgramEvent> {
    pending
        .drain(..)
        .map(|event| ProgramEvent {
            with_target,
            action: event.action,
            line: event.place.line,
        })
        .collect()
}

/// `tip` with the words of `block` put in.
fn moved(mut tip: Tip, block: &Block) -> Tip {
    let value = |name: &str| block.word(name).map(|w| w.value);
    for i in 0..3 {
        tip.position_mm[i] = value(AXIS_WORDS[i]).unwrap_or(tip.position_mm[i]);
        tip.angles_deg[i] = value(AXIS_WORDS[3 + i]).unwrap_or(tip.angles_deg[i]);
    }
    for (extension, name) in tip.extension_mm.iter_mut().zip(EXTENSION_WORDS) {
        *extension = value(name).unwrap_or(*extension);
    }
    tip
}

fn number_below(value: f64, count: u8) -> Option<u8> {
    (0..count).find(|n| f64::from(*n) == value)
}

fn value_error(word: &Word, reason: &'static str) -> NcError {
    Problem::Value {
        word: word.label(),
        value: word.value,
        reason,
    }
    .at(word.place)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "G21 G17 G90 G94 G40 G54 G64\nG43.4\nG0 X0 Y0 Z50 A0 B0 C0\nG0 Z0\n";

    fn run(body: &str) -> Result<Program, NcError> {
        interpret(&format!("{HEADER}{body}"), Options::default())
    }

    /// Problem and line within the body.
    fn problem(body: &str) -> (Problem, i64) {
        let error = run(body).unwrap_err();
        (
            error.problem,
            i64::from(error.place.line) - HEADER.lines().count() as i64,
        )
    }

    #[test]
    fn g1_blocks_make_one_path_and_each_g0_its_own() {
        let program = run("F6000\nG1 X10\nX20 Y1\nx30 y3 v1=0.5 a1\nG0 Z50\nM2").unwrap();
        let shape: Vec<_> = program
            .paths
            .iter()
            .map(|p| (p.motion, p.targets.len()))
            .collect();
        let feed = Motion::Feed(6000.0);
        let rapid = Motion::Rapid;
        assert_eq!(shape, [(rapid, 1), (rapid, 1), (feed, 3), (rapid, 1)]);
        let end = program.paths[2].targets[2];
        assert_eq!(end.line, 8);
        assert_eq!(end.tip.position_mm, [30.0, 3.0, 0.0]);
        assert_eq!(end.tip.angles_deg, [1.0, 0.0, 0.0]);
        assert_eq!(end.tip.extension_mm, [0.5, 0.0]);
    }

    #[test]
    fn outputs_take_effect_with_the_next_motion() {
        let body = "F600\nM67 E1 Q1500\nG1 X10\nM62 P0\nM62 P2\nX20\nM63 P0\nG0 Z50\nM30";
        let program = run(body).unwrap();
        let feed = &program.paths[2].events;
        let (side, watt) = (1, 1500.0);
        let actions: Vec<_> = feed.iter().map(|e| (e.with_target, e.action)).collect();
        assert_eq!(
            actions,
            [
                (0, PathAction::Power { side, watt }),
                (1, PathAction::Beam { side: 0, on: true }),
                (1, PathAction::Tracking { on: true }),
            ]
        );
        assert_eq!(program.paths[3].events[0].with_target, 0);
        assert_eq!(problem("M62 P0\nM2"), (Problem::NoMotionAfter("M62"), 1));
    }

    #[test]
    fn exact_stop_ends_a_path_at_each_block() {
        let program = run("F600\nG61.1\nG1 X10\nX20\nG64\nX30\nX40\nM2").unwrap();
        let shape: Vec<_> = program.paths[2..].iter().map(|p| p.targets.len()).collect();
        assert_eq!(shape, [1, 1, 2]);
    }

    #[test]
    fn a_change_of_feed_inside_a_path_is_an_error_at_its_line() {
        let (from, to) = (600.0, 700.0);
        assert_eq!(
            problem("G1 X10 F600\nX20\nF700\nX30\nM2"),
            (Problem::FeedChange { from, to }, 3)
        );
        assert!(run("G1 X10 F600\nX20 F600\nG0 X0\nG1 X10 F700\nM2").is_ok());
    }

    #[test]
    fn block_delete_is_the_operators_choice() {
        let body = "F600\nG1 X10\n/X20\nM2";
        assert_eq!(run(body).unwrap().paths[2].targets.len(), 2);
        let text = format!("{HEADER}{body}");
        let block_delete = true;
        let program = interpret(&text, Options { block_delete }).unwrap();
        assert_eq!(program.paths[2].targets.len(), 1);
    }

    #[test]
    fn what_cannot_be_done_is_named_with_its_line() {
        assert_eq!(problem("\nG1 X10\nM2"), (Problem::NoFeed, 2));
        assert_eq!(problem("G49\nG0 X10\nM2"), (Problem::NotTip, 2));
        assert_eq!(problem("G1 X1 F600"), (Problem::NoEnd, 1));
        assert_eq!(problem("G1 X1 F600\nM2\nG0 X5"), (Problem::AfterEnd, 3));
        assert_eq!(problem("G0 X5 P1\nM2"), (Problem::Orphan("P".into()), 1));
        assert_eq!(problem("M62 P0 Q1\nM2"), (Problem::Orphan("Q".into()), 1));
        let (code, word) = ("M67", "Q");
        assert_eq!(problem("M67 E0\nM2"), (Problem::Missing { code, word }, 1));
        assert!(matches!(
            problem("M62 P3\nM2"),
            (Problem::Value { value: 3.0, .. }, 1)
        ));
        assert!(matches!(problem("F-5\nM2"), (Problem::Value { .. }, 1)));
        assert_eq!(problem("G1 X5 F5\nM2\n%"), (Problem::Percent, 3));
        let bare = |text: &str| interpret(text, Options::default()).unwrap_err().problem;
        assert_eq!(bare("G43.4\nX5\nM2"), Problem::NoMotion);
        assert_eq!(bare("G43.4\nG0 X5\nM2"), Problem::FirstMotion);
        assert_eq!(bare("G0 X0 Y0 Z0 A0 B0 C0\nM2"), Problem::NotTip);
        assert_eq!(bare("G21\nM2"), Problem::Empty);
        assert_eq!(bare("%\nG43.4\nG0 X0 Y0 Z0 A0 B0 C0\nM2"), Problem::Percent);
    }

    #[test]
    fn a_message_reads_as_a_sentence_with_its_place() {
        assert_eq!(
            run("G1 X10 F600\nG2 X5\nM2").unwrap_err().to_string(),
            "line 6, column 1: G2 is not understood"
        );
    }
}
