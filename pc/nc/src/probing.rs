//! Motions that end where the probe touches, or where it no longer does: G38.2 to G38.5 and G31. Until the machine has been
//! there ([`super::answers`]) they are taken to go to their ends, where those of G38.2 and G38.4 meet what they must.

use super::answers::Answer;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::offsets::Coordinates;
use super::program::{FeedRate, Motion, Way, Words};
use shared::io::AXES;

/// X of where the last probe touched, in coordinates of the program, and whether it did.
const FOUND: u32 = 5061;
const SUCCESS: u32 = 5070;
/// What does not move the tip \[mm\].
const SAME: f64 = 1e-6;

/// The probe of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeInput {
    /// Input of the process that it switches, from 0.
    pub input: u8,
    /// Whether that is on while it touches.
    pub touching: bool,
}

/// A motion that an input ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe {
    /// The input, from 0,
    pub input: u8,
    /// and what ends the motion: it comes on, or goes off.
    pub on: bool,
    /// It must not come to its end: G38.2 and G38.4.
    pub must: bool,
    /// The probe is to come free: G38.4 and G38.5.
    pub away: bool,
    /// The code.
    pub code: &'static str,
    /// Where the program says so.
    pub place: SourcePosition,
    /// Number of the question what it meets, from 0.
    pub question: usize,
}

/// What a machine found: X Y Z \[mm\], A B C \[°\] of its tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probed {
    /// Where the probe touched, or came free, if it did.
    pub met: Option<[f64; AXES]>,
    /// Where the machine came to rest after it.
    pub stands: [f64; AXES],
}

/// What `#5061` and those after it are: where the last probe touched, in the units and the coordinates of the program, and 1 in
/// `#5070` if it did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    at: [f64; AXES],
    touched: bool,
}

impl Found {
    /// The parameters, with their numbers.
    pub(super) fn parameters(self) -> impl Iterator<Item = (u32, f64)> {
        let touched = f64::from(u8::from(self.touched));
        (FOUND..).zip(self.at).chain([(SUCCESS, touched)])
    }
}

impl Interpreter {
    /// The number of the next question, and the answer if there is one.
    pub(super) fn ask(&mut self) -> (usize, Option<Answer>) {
        let question = self.asked;
        self.asked += 1;
        (question, self.answers.get(question).copied())
    }

    /// The straight motion of `mode`, G38 or G31, to where `words` say.
    pub(super) fn probe(
        &mut self,
        mode: Code,
        words: Words,
        feed: FeedRate,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let code = mode.name();
        let impossible = |why| Err(Problem::Impossible { code, why }.at(place));
        let (away, must) = match mode {
            Code::Probe { away, must } => (away, must),
            _ => (false, false),
        };
        let Some(probe) = self.setup.probe else {
            return impossible(
                "this machine has no probe: name the input of one in [program] of the machine file (probe)",
            );
        };
        if self.compensation.is_on() {
            return impossible("cutter compensation is on: write G40 before");
        }
        if self.welding {
            return impossible("a weld is open: write WELDOFF before");
        }
        if let FeedRate::InverseTime(_) = feed {
            return impossible("how long the motion takes is not known: write G94");
        }
        if let Some(opening) = self.pending.iter().find(|pending| pending.opens()) {
            let (code, why) = (
                opening.code,
                "no beam or tracking goes on with a motion of the probe",
            );
            return Err(Problem::Impossible { code, why }.at(opening.place));
        }
        let from = self.position(&[0, 1, 2], place)?;
        if (3..AXES).any(|axis| self.moves(&words, axis)) || words.extension != [None; 2] {
            return impossible("it leads X Y Z, and turns or extends nothing");
        }
        self.learn(&words);
        if distance(&from, &self.at) < SAME {
            return match must {
                true => impossible("it must lead elsewhere than where the tip is"),
                false => {
                    self.note_found(None);
                    Ok(())
                }
            };
        }
        // It is begun at its beginning: what follows depends on what is found.
        self.branches = true;
        let (question, answer) = self.ask();
        let met = match answer {
            Some(Answer::Probe(found)) => {
                let there = self.end_of_tool(&found.stands);
                self.at[..3].copy_from_slice(&there[..3]);
                found.met.map(|met| self.end_of_tool(&met))
            }
            _ => {
                let text = format!(
                    "{code} is taken to go to the end of its motion until the machine has been there: what follows may be elsewhere"
                );
                self.tell_once(text, place);
                must.then_some(self.at)
            }
        };
        // A motion that has moved nothing is none any more.
        let motion = match distance(&from, &self.at) < SAME {
            true => Motion::Stand,
            false => Motion::Feed,
        };
        self.alone(motion, (Way::Line, self.words_to_here(words)), Some(feed), place)?;
        if let Some(path) = self.paths.last_mut() {
            path.probe = Some(Probe {
                input: probe.input,
                on: probe.touching != away,
                must,
                away,
                code,
                place,
                question,
            });
        }
        self.note_found(met);
        Ok(())
    }

    /// Words of X Y Z where the tip is.
    fn words_to_here(&self, mut words: Words) -> Words {
        for axis in 0..3 {
            words.axes[axis] = Some(self.at[axis]);
        }
        words
    }

    /// `#5061` to `#5066`: where the probe touched, or where its motion has ended. `#5070`: whether it did.
    fn note_found(&mut self, met: Option<Coordinates>) {
        let mut at = self.offsets.to_programmed(&met.unwrap_or(self.at));
        at[..3].iter_mut().for_each(|value| *value /= self.modal.unit());
        let found = Found {
            at,
            touched: met.is_some(),
        };
        self.parameters.found(found);
        self.found = Some(found);
    }
}

fn distance(from: &Coordinates, to: &Coordinates) -> f64 {
    (0..3)
        .map(|axis| (to[axis] - from[axis]).powi(2))
        .sum::<f64>()
        .sqrt()
}
