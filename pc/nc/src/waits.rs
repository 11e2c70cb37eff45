//! Waits of a program: M0, M1, M60, M6 with another tool, and M66. The machine rests between two paths until they are over.

use super::answers::Answer;
use super::block::{Block, CodeWord};
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::outputs::{LONGEST_DWELL_S, Pending};
use super::program::ProgramAction;
use shared::io::PROCESS_INPUTS;
use std::fmt;

/// A rest between two paths that ends when the operator or an input says so.
#[derive(Clone, Debug, PartialEq)]
pub struct Wait {
    /// What ends it.
    pub until: Until,
    /// The code that asks for it.
    pub code: &'static str,
    /// Where the program says so.
    pub place: SourcePosition,
    /// The last comment or message of the program before it, and after the last motion.
    pub text: Option<String>,
    /// How many waits are before it in the program.
    pub number: usize,
    /// Number of the question what the input does, from 0.
    pub question: Option<usize>,
}

/// What ends a wait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// M0, M1, M60: the operator continues.
    Continued,
    /// M6: the operator has put in the tool of this number, and continues; 0 is none.
    ToolIn(u32),
    /// M66: an input of the process does something.
    Input {
        /// Its number, from 0.
        input: u8,
        /// What it has to do.
        event: InputEvent,
        /// The longest wait \[s\].
        within_s: f64,
    },
    /// M66 with L0: an input of the process is read.
    Read {
        /// Its number, from 0.
        input: u8,
    },
}

/// What an input does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputEvent {
    /// L1: it goes from low to high.
    Rises,
    /// L2: it goes from high to low.
    Falls,
    /// L3: it is high, or comes to be.
    High,
    /// L4: it is low, or comes to be.
    Low,
}

impl Wait {
    /// Whether the operator has to end it.
    pub fn is_for_operator(&self) -> bool {
        !matches!(self.until, Until::Input { .. } | Until::Read { .. })
    }
}

impl fmt::Display for Until {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Continued => f.write_str("until the operator continues"),
            Self::ToolIn(0) => f.write_str("until the operator has taken the tool out"),
            Self::ToolIn(tool) => write!(f, "until the operator has put tool {tool} in"),
            Self::Input {
                input,
                event,
                within_s,
            } => write!(f, "until input {} {event}, {within_s} s at most", input + 1),
            Self::Read { input } => write!(f, "until input {} is read", input + 1),
        }
    }
}

impl InputEvent {
    /// `#5399` after it: 1 where the input is on, 0 where it is off.
    pub fn after(self) -> i8 {
        match self {
            Self::Rises | Self::High => 1,
            Self::Falls | Self::Low => 0,
        }
    }
}

impl fmt::Display for InputEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rises => "goes from low to high",
            Self::Falls => "goes from high to low",
            Self::High => "is high",
            Self::Low => "is low",
        })
    }
}

impl Interpreter {
    /// M0, M60, and M1 where the operator wants it.
    pub(super) fn pause(&mut self, code: CodeWord) {
        if code.code == Code::OptionalPause && !self.optional_stop {
            // What was said was said of this.
            self.said = None;
        } else {
            self.wait_at_rest(Until::Continued, code, None);
        }
    }

    /// M6: the spindle stops. The first tool of a program must be in the machine, another one is put in.
    pub(super) fn change_tool(&mut self, code: CodeWord) {
        if let Some(stop) = self.spindle.stop(code.name, code.place) {
            self.wait(stop);
        }
        let next = self.tool_numbers[0];
        if self.tool_in.is_some_and(|tool| tool != next) {
            if let Some(name) = self.name_of_tool(next) {
                self.said = Some(format!("tool {name}"));
            }
            self.wait_at_rest(Until::ToolIn(next), code, None);
        } else {
            self.wait(Pending {
                action: ProgramAction::ChangeTool(next),
                code: code.name,
                place: code.place,
                at_rest: true,
            });
        }
        self.tool_numbers[1] = next;
        self.tool_in = Some(next);
    }

    /// M66, if `block` has it.
    pub(super) fn wait_for_input(&mut self, block: &Block, claims: &Claims) -> Result<(), NcError> {
        let found = block.code(Group::Outputs);
        let Some(code) = found.filter(|code| code.code == Code::WaitForInput) else {
            return Ok(());
        };
        let missing = |word: &'static str| {
            Problem::Missing {
                code: code.name,
                word,
            }
            .at(code.place)
        };
        if let Some(e) = claims.word(code.code, "E") {
            let why = "the boards have no analog inputs; P0 to P3 are the digital ones";
            return Err(Problem::Impossible { code: code.name, why }.at(e.place));
        }
        let p = claims.word(code.code, "P").ok_or_else(|| missing("P"))?;
        let inputs = PROCESS_INPUTS as u8;
        let input = p
            .number_below(inputs)
            .ok_or_else(|| p.value_error("P0 to P3 are the inputs 1 to 4"))?;
        let l = claims.word(code.code, "L");
        let event = match l.map(|l| (l, l.number_below(5))) {
            None | Some((_, Some(0))) => None,
            Some((_, Some(1))) => Some(InputEvent::Rises),
            Some((_, Some(2))) => Some(InputEvent::Falls),
            Some((_, Some(3))) => Some(InputEvent::High),
            Some((_, Some(4))) => Some(InputEvent::Low),
            Some((l, _)) => {
                return Err(l.value_error(
                    "L0 does not wait, L1 waits for a rise, L2 for a fall, L3 for high, L4 for low",
                ));
            }
        };
        let (question, answer) = self.ask();
        // What is waited for comes, and what is only read is off, until the machine has been there.
        let likely = event.map_or(0, InputEvent::after);
        let value = match answer {
            Some(Answer::Input(value)) => value,
            _ => likely,
        };
        self.input = Some((question, value.into()));
        let Some(event) = event else {
            self.wait_at_rest(Until::Read { input }, *code, Some(question));
            return Ok(());
        };
        let q = claims.word(code.code, "Q").ok_or_else(|| missing("Q"))?;
        if !(q.value > 0.0 && q.value <= LONGEST_DWELL_S) {
            return Err(q.value_error("the longest wait must be above 0 and up to 86400 s (a day)"));
        }
        let until = Until::Input {
            input,
            event,
            within_s: q.value,
        };
        self.wait_at_rest(until, *code, Some(question));
        Ok(())
    }

    /// The path ends, what takes effect at rest does so, and the machine waits.
    fn wait_at_rest(&mut self, until: Until, code: CodeWord, question: Option<usize>) {
        self.stand();
        if self.dwell_s() > 0.0 {
            self.standing(Vec::new());
        }
        self.open = false;
        self.waits.push(Wait {
            until,
            code: code.name,
            place: code.place,
            text: self.said.take(),
            number: self.waited,
            question,
        });
        self.waited += 1;
    }
}
