//! Outputs of a program: M62 to M65, M67 and M68 by the number of the output, M3, M4, M5 and S by what it is.

use super::block::{Block, Word};
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::program::{ProgramAction, ProgramEvent};
use shared::geometry::Turn;
use shared::io::{LEVELS, OUTPUTS, SIDES};
use shared::protocol::{Channel, PathAction};

/// P of seam tracking, and of the first digital output.
const TRACKING: u8 = 2;
const FIRST_OUTPUT: u8 = 3;
/// Longest dwell \[s\]: a day. A larger number is one of milliseconds, or a slip.
pub(super) const LONGEST_DWELL_S: f64 = 86_400.0;

/// An event that waits for its motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pending {
    pub(super) action: ProgramAction,
    pub(super) code: &'static str,
    pub(super) place: SourcePosition,
    /// It does not need a motion to take effect with: the machine stands anyway.
    pub(super) at_rest: bool,
}

impl Pending {
    /// The event at the start of the motion to target `with_target`.
    pub(super) fn event(self, with_target: usize) -> ProgramEvent {
        ProgramEvent {
            with_target,
            after_mm: 0.0,
            action: self.action,
            code: self.code,
            place: self.place,
        }
    }

    /// Whether it opens a beam gate or lets the tracker go, by number.
    pub(super) fn opens(&self) -> bool {
        matches!(
            self.action,
            ProgramAction::Output(PathAction::Beam { on: true, .. } | PathAction::Tracking { on: true })
        )
    }
}

/// The spindle as far as the program has come.
#[derive(Clone, Debug, Default)]
pub(super) struct Spindle {
    /// S \[r/min\].
    speed: Option<f64>,
    turns: Option<Turn>,
    /// An S has been read.
    said: bool,
    /// The M3 or M4 by which it turns with no S so far.
    without_speed: Option<(&'static str, SourcePosition)>,
}

impl Spindle {
    /// What S, M3, M4 and M5 of `block` ask for.
    pub(super) fn block(&mut self, block: &Block) -> Result<Vec<Pending>, NcError> {
        let mut events = Vec::new();
        let mut add = |action, code, place| {
            events.push(Pending {
                action,
                code,
                place,
                at_rest: true,
            });
        };
        let s = block.word("S");
        let own = block.code(Group::Spindle);
        if let Some(s) = s {
            self.said = true;
            if s.value < 0.0 {
                return Err(s.value_error("the spindle speed must be 0 r/min or more"));
            }
            if !block.passed_over.is_empty() && own.is_none() {
                return self.speed_of_other_function(s).map(|()| events);
            }
            self.speed = Some(s.value);
            self.without_speed = None;
        }
        match (own, s) {
            (Some(code), s) if code.code == Code::SpindleOff => {
                // The speed comes first, as on LinuxCNC.
                if let Some(s) = s.filter(|_| self.turns.is_some()) {
                    add(ProgramAction::SpindleSpeed(s.value), "S", s.place);
                }
                self.turns = None;
                self.without_speed = None;
                add(ProgramAction::SpindleOff, code.name, code.place);
            }
            (Some(code), _) => {
                let speed = self.speed.unwrap_or_else(|| {
                    self.without_speed = Some((code.name, code.place));
                    0.0
                });
                let turn = match code.code {
                    Code::SpindleCounterClockwise => Turn::CounterClockwise,
                    _ => Turn::Clockwise,
                };
                self.turns = Some(turn);
                add(ProgramAction::SpindleSpeed(speed), code.name, code.place);
                add(ProgramAction::SpindleOn(turn), code.name, code.place);
            }
            (None, Some(s)) if self.turns.is_some() => {
                add(ProgramAction::SpindleSpeed(s.value), "S", s.place)
            }
            (None, _) => {}
        }
        Ok(events)
    }

    /// S beside a function that is passed over may be a word of that function: what the spindle does is not known from it.
    fn speed_of_other_function(&mut self, s: &Word) -> Result<(), NcError> {
        if self.turns.is_some() {
            let why = "it may belong to the function that is passed over: write the speed of the spindle in a block of its own";
            return Err(s.value_error(why));
        }
        self.speed = None;
        Ok(())
    }

    /// S is `speed` \[r/min\], if the program has said none; whether it has not.
    pub(super) fn begin_with(&mut self, speed: f64) -> bool {
        let unsaid = self.speed.is_none() && !self.said;
        if unsaid {
            self.speed = Some(speed);
        }
        unsaid
    }

    /// M3 or M4 without an S turns at 0 r/min, and nothing may be fed so; as little with a beam, which would be off.
    pub(super) fn check_speed(&self, is_beam: bool) -> Result<(), NcError> {
        let word = match is_beam {
            true => "S, here or before the first motion that feeds: without it the beam is off",
            false => {
                "S, here or before the first motion that feeds, or spindle_rpm in [program] of the machine file"
            }
        };
        match self.without_speed {
            Some((code, place)) => Err(Problem::Missing { code, word }.at(place)),
            None => Ok(()),
        }
    }

    /// It turns at the S that was said.
    pub(super) fn start(
        &mut self,
        turn: Turn,
        code: &'static str,
        place: SourcePosition,
    ) -> Result<[Pending; 2], NcError> {
        let word = "S before it, as it turns the spindle";
        let speed = self.speed.ok_or(Problem::Missing { code, word }.at(place))?;
        self.turns = Some(turn);
        let event = |action| Pending {
            action,
            code,
            place,
            at_rest: true,
        };
        Ok([
            event(ProgramAction::SpindleSpeed(speed)),
            event(ProgramAction::SpindleOn(turn)),
        ])
    }

    /// It stops, if it turns, as `code` asks for.
    pub(super) fn stop(&mut self, code: &'static str, place: SourcePosition) -> Option<Pending> {
        self.without_speed = None;
        self.turns.take().map(|_| Pending {
            action: ProgramAction::SpindleOff,
            code,
            place,
            at_rest: true,
        })
    }

    /// S is that of `saved` again, by M72 or M73; it turns as then.
    pub(super) fn restore(&mut self, saved: Self, place: SourcePosition) -> Option<Pending> {
        let before = std::mem::replace(self, saved).speed;
        let speed = self
            .speed
            .filter(|_| self.turns.is_some() && before != self.speed)?;
        Some(Pending {
            action: ProgramAction::SpindleSpeed(speed),
            code: "M72",
            place,
            at_rest: true,
        })
    }

    /// Which way it turns.
    pub(super) fn turns(&self) -> Option<Turn> {
        self.turns
    }

    /// S \[r/min\], 0 if it was not said.
    pub(super) fn speed(&self) -> f64 {
        self.speed.unwrap_or(0.0)
    }
}

/// What M7, M8 or M9 of a block ask for.
pub(super) fn coolant(block: &Block) -> Option<Pending> {
    let code = block.code(Group::Coolant)?;
    let on = |own: Code| match code.code {
        Code::CoolantOff => Some(false),
        _ => block.has(own).then_some(true),
    };
    Some(Pending {
        action: ProgramAction::Coolant {
            mist: on(Code::MistOn),
            flood: on(Code::FloodOn),
        },
        code: code.name,
        place: code.place,
        at_rest: true,
    })
}

/// The output that `block` switches.
pub(super) fn output(block: &Block, claims: &Claims) -> Result<Option<Pending>, NcError> {
    let found = block.code(Group::Outputs);
    let Some(code) = found.filter(|code| code.code != Code::WaitForInput) else {
        return Ok(None);
    };
    let need = |word: &'static str| -> Result<&Word, NcError> {
        let missing = Problem::Missing {
            code: code.name,
            word,
        };
        claims.word(code.code, word).ok_or(missing.at(code.place))
    };
    let action = match code.code {
        Code::Analog | Code::AnalogNow => {
            let (e, q) = (need("E")?, need("Q")?);
            if q.value < 0.0 {
                return Err(q.value_error("the value must be 0 or more"));
            }
            match e.number_below(LEVELS as u8) {
                Some(side) if usize::from(side) < SIDES => PathAction::Power { side, watt: q.value },
                Some(level) => PathAction::Level {
                    channel: Channel::Analog(level - SIDES as u8),
                    value: q.value,
                    over_mm: 0.0,
                },
                None => {
                    return Err(e.value_error(
                        "E0 and E1 are the powers of beam 1 and 2, E2 and E3 analog outputs 1 and 2",
                    ));
                }
            }
        }
        _ => {
            let p = need("P")?;
            let on = matches!(code.code, Code::OutputOn | Code::OutputOnNow);
            match p.number_below(FIRST_OUTPUT + OUTPUTS as u8) {
                Some(TRACKING) => PathAction::Tracking { on },
                Some(side) if side < TRACKING => PathAction::Beam { side, on },
                Some(output) => PathAction::Output {
                    output: output - FIRST_OUTPUT,
                    on,
                },
                None => {
                    return Err(p.value_error(
                        "P0 and P1 are the beam gates 1 and 2, P2 is tracking, P3 to P10 are outputs 1 to 8",
                    ));
                }
            }
        }
    };
    Ok(Some(Pending {
        action: ProgramAction::Output(action),
        code: code.name,
        place: code.place,
        at_rest: matches!(
            code.code,
            Code::OutputOnNow | Code::OutputOffNow | Code::AnalogNow
        ),
    }))
}

/// The time of a G4 in `block` \[s\].
pub(super) fn dwell(block: &Block, claims: &Claims) -> Result<Option<(f64, SourcePosition)>, NcError> {
    let Some(code) = block.code(Group::NonModal).filter(|c| c.code == Code::Dwell) else {
        return Ok(None);
    };
    if let Some(output) = block.code(Group::Outputs) {
        let (first, second) = (code.name, output.name);
        return Err(Problem::ModalGroup { first, second }.at(output.place));
    }
    let missing = Problem::Missing {
        code: code.name,
        word: "P",
    };
    // Siemens has F for it.
    let time = claims.word(Code::Dwell, "P").or(block.word("F"));
    let p = time.ok_or(missing.at(code.place))?;
    if !(0.0..=LONGEST_DWELL_S).contains(&p.value) {
        return Err(p.value_error("the time must be from 0 to 86400 s (a day)"));
    }
    Ok(Some((p.value, code.place)))
}
