//! Tapping, G84 and G74, as LinuxCNC has it: no axis follows the spindle, so the tap has a holder that gives way along its axis.

use super::codes::Code;
use super::cycles::{Cycle, SPINDLE};
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::outputs::Pending;
use super::program::ProgramAction;
use shared::geometry::Turn;

impl Interpreter {
    /// Down and up with the feed, which nobody overrides; at the bottom the spindle turns round.
    pub(super) fn tap(&mut self, cycle: &Cycle) -> Result<(), NcError> {
        let place = cycle.place;
        let (turn, back, own) = match cycle.code {
            Code::LeftTapping => (Turn::CounterClockwise, Turn::Clockwise, "M4"),
            _ => (Turn::Clockwise, Turn::CounterClockwise, "M3"),
        };
        if self.setup.laser.is_some() {
            let (code, why) = (
                cycle.code.name(),
                "M3, M4 and M5 switch a beam here: taps need a spindle",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let before = self.spindle.turns();
        let event = |action| Pending {
            action,
            code: SPINDLE,
            place,
            at_rest: true,
        };
        match before {
            Some(other) if other != turn => {
                let (code, why) = match cycle.code {
                    Code::LeftTapping => ("G74", "the spindle turns to the right: write M4 before"),
                    _ => ("G84", "the spindle turns to the left: write M3 before"),
                };
                return Err(Problem::Impossible { code, why }.at(place));
            }
            Some(_) => {}
            None => {
                for event in self.spindle.start(turn, cycle.code.name(), place)? {
                    self.wait(event);
                }
                let code = cycle.code.name();
                let text =
                    format!("the spindle is off: {code} has it turn as with {own}, and stop after each hole");
                self.tell_once(text, place);
            }
        }
        // On a path of its own.
        self.open = false;
        self.fixed_feed = true;
        self.cycle_feed(cycle, cycle.bottom)?;
        self.wait(event(ProgramAction::SpindleOff));
        self.wait(event(ProgramAction::SpindleOn(back)));
        if cycle.dwell > 0.0 {
            self.dwell(cycle.dwell, place);
        }
        self.cycle_feed(cycle, cycle.clear)?;
        self.fixed_feed = false;
        self.wait(event(ProgramAction::SpindleOff));
        match before {
            Some(turn) => self.wait(event(ProgramAction::SpindleOn(turn))),
            None => drop(self.spindle.stop(cycle.code.name(), place)),
        }
        Ok(())
    }

    /// How long the machine stands at the bottom while the spindle turns round \[s\].
    pub(super) fn turning_round(&mut self, mode: Code, place: SourcePosition) -> f64 {
        let dwell = self.last_dwell();
        if dwell.is_none() {
            let text = format!(
                "{} without P goes up as soon as the spindle is told to turn round: P is the time that it takes for that, in s",
                mode.name()
            );
            self.tell_once(text, place);
        }
        dwell.unwrap_or(0.0)
    }
}
