//! A beam that M3, M4, M5 and S switch, as in the laser mode of Grbl.

use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::outputs::Pending;
use super::program::{FeedRate, ProgramAction};
use shared::geometry::Turn;
use shared::protocol::{Channel, PathAction};

/// What M3, M4, M5 and S mean on a machine whose beam they switch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// Beam, 0 or 1.
    pub side: u8,
    /// S of the full power.
    pub full_s: f64,
    /// Full power \[W\].
    pub full_watt: f64,
}

/// What the beam was told so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Burning {
    /// The gate is open. Rapids close it.
    pub(super) gate: bool,
    watt: Option<f64>,
    /// Speed of the path at which the power is full \[mm/s\]; 0 if it does not follow the speed.
    full_mm_s: f64,
}

impl Interpreter {
    /// What waits in place of `pending` where a beam stands for the spindle: it burns in motions that feed only.
    pub(super) fn of_beam(&mut self, pending: Pending) -> Option<Pending> {
        let Some(laser) = self.setup.laser else {
            return Some(pending);
        };
        let action = match pending.action {
            ProgramAction::SpindleSpeed(_) | ProgramAction::SpindleOn(_) => return None,
            ProgramAction::SpindleOff => {
                self.burning.gate = false;
                let side = laser.side;
                ProgramAction::Output(PathAction::Beam { side, on: false })
            }
            other => other,
        };
        Some(Pending { action, ..pending })
    }

    /// Switches the beam for a motion with `feed`: M3 burns with the power of S, M4 with as much of it as the speed of the path is of F.
    pub(super) fn burn(&mut self, feed: FeedRate, place: SourcePosition) -> Result<(), NcError> {
        let (Some(laser), Some(turn)) = (self.setup.laser, self.spindle.turns()) else {
            return Ok(());
        };
        let (s, side) = (self.spindle.speed(), laser.side);
        if s > laser.full_s {
            let full = laser.full_s;
            return Err(Problem::LaserPower { s, full }.at(place));
        }
        let (code, full_mm_s) = match (turn, feed) {
            (Turn::Clockwise, _) => ("M3", 0.0),
            (Turn::CounterClockwise, FeedRate::PerMinute(mm_min)) => ("M4", mm_min / 60.0),
            (Turn::CounterClockwise, FeedRate::InverseTime(_)) => {
                let (code, why) = (
                    "M4",
                    "with G93 there is no F that the power could follow: write G94, or M3",
                );
                return Err(Problem::Impossible { code, why }.at(place));
            }
        };
        let (burns, watt) = (s > 0.0, laser.full_watt * s / laser.full_s);
        if burns && self.welding {
            let why = "a weld with weld data switches its beam itself: write M5 before WELDON";
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let mut actions = Vec::new();
        if burns && self.burning.watt.replace(watt) != Some(watt) {
            actions.push(PathAction::Power { side, watt });
        }
        if burns && std::mem::replace(&mut self.burning.full_mm_s, full_mm_s) != full_mm_s {
            let (channel, least) = (Channel::Power(side), 0.0);
            actions.push(PathAction::BySpeed {
                channel,
                full_mm_s,
                least,
            });
        }
        if std::mem::replace(&mut self.burning.gate, burns) != burns {
            actions.push(PathAction::Beam { side, on: burns });
        }
        for action in actions {
            self.wait(Pending {
                action: ProgramAction::Output(action),
                code,
                place,
                at_rest: false,
            });
        }
        Ok(())
    }
}
