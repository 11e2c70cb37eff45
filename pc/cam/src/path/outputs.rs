//! Outputs of a program, checked against the machine.

use super::{MAX_EVENTS, PathError, Planner, SpeedStep};
use nc::{ProgramAction, ProgramEvent, SourcePosition};
use shared::geometry::Turn;
use shared::io::SIDES;
use shared::protocol::{PathAction, PathEvent};

/// A switching at the start of the motion to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Switching {
    pub(super) with_target: usize,
    pub(super) action: PathAction,
}

impl Planner {
    /// `events` as the motion board knows them. Beams, spindle and tracking must be there, and give only so much.
    pub(super) fn switchings(&self, events: &[ProgramEvent]) -> Result<Vec<Switching>, PathError> {
        let switching = |event: &ProgramEvent| {
            let action = self.action(event).transpose()?;
            let with_target = event.with_target;
            Some(action.map(|action| Switching { with_target, action }))
        };
        events.iter().filter_map(switching).collect()
    }

    /// What an event switches; of coolant and tools [`Planner::notices`] tells.
    pub(super) fn action(&self, event: &ProgramEvent) -> Result<Option<PathAction>, PathError> {
        let place = event.place;
        let action = match event.action {
            ProgramAction::Pause => {
                let code = event.code;
                return Err(PathError::Pause { place, code });
            }
            ProgramAction::Coolant { .. } | ProgramAction::ChangeTool(_) => return Ok(None),
            ProgramAction::Output(action) => {
                self.check_output(&action, place)?;
                action
            }
            ProgramAction::SpindleSpeed(rpm) => {
                let side = self.spindle(event)?;
                let largest = self.largest_power[usize::from(side)].unwrap_or(0.0);
                if rpm > largest {
                    return Err(PathError::SpindleSpeed { place, rpm, largest });
                }
                PathAction::Power { side, watt: rpm }
            }
            ProgramAction::SpindleOn(Turn::Clockwise) => {
                let side = self.spindle(event)?;
                PathAction::Beam { side, on: true }
            }
            ProgramAction::SpindleOn(Turn::CounterClockwise) => {
                self.spindle(event)?;
                let machine = self.name.clone();
                return Err(PathError::SpindleSense { place, machine });
            }
            ProgramAction::SpindleOff => {
                let side = self.spindle(event)?;
                PathAction::Beam { side, on: false }
            }
        };
        Ok(Some(action))
    }

    /// The beam that is the spindle: the one that stays on at rest.
    fn spindle(&self, event: &ProgramEvent) -> Result<u8, PathError> {
        self.spindle.ok_or_else(|| PathError::NoSpindle {
            place: event.place,
            code: event.code,
            machine: self.name.clone(),
        })
    }

    fn check_output(&self, action: &PathAction, place: SourcePosition) -> Result<(), PathError> {
        let missing = |output: String| PathError::NoOutput {
            place,
            output,
            machine: self.name.clone(),
        };
        let power = |side: u8| {
            let power = self.largest_power[usize::from(side)];
            power.ok_or_else(|| missing(format!("beam {}", side + 1)))
        };
        match *action {
            PathAction::Beam { side, .. } => power(side).map(|_| ()),
            PathAction::Power { side, watt } => {
                let largest = power(side)?;
                if watt > largest {
                    return Err(PathError::Power {
                        place,
                        side,
                        watt,
                        largest,
                    });
                }
                Ok(())
            }
            PathAction::Tracking { .. } if !self.tracks => Err(missing("seam tracking".to_owned())),
            PathAction::Tracking { .. } => Ok(()),
        }
    }
}

/// What the program has switched on so far. The boards begin every path with everything off, but for a spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Switched {
    powers: [Option<f64>; SIDES],
    gates: [bool; SIDES],
    tracks: bool,
}

impl Switched {
    pub(super) fn switch(&mut self, action: &PathAction) {
        match *action {
            PathAction::Power { side, watt } => self.powers[usize::from(side)] = Some(watt),
            PathAction::Beam { side, on } => self.gates[usize::from(side)] = on,
            PathAction::Tracking { on } => self.tracks = on,
        }
    }

    /// Whether a beam is on, or a spindle.
    pub(super) fn works(&self) -> bool {
        self.gates.contains(&true)
    }

    /// Takes up all of `events`.
    pub(super) fn take_up(&mut self, events: &[PathEvent]) {
        for event in events {
            self.switch(&event.action);
        }
    }

    /// A rapid leaves gates and tracking off.
    pub(super) fn rapid(&mut self) {
        self.gates = [false; SIDES];
        self.tracks = false;
    }

    /// What brings a path there that begins with everything off.
    pub(super) fn actions(&self) -> Vec<PathAction> {
        let mut actions = Vec::new();
        for (side, (power, gate)) in (0..).zip(self.powers.into_iter().zip(self.gates)) {
            actions.extend(power.map(|watt| PathAction::Power { side, watt }));
            actions.extend(gate.then_some(PathAction::Beam { side, on: true }));
        }
        actions.extend(self.tracks.then_some(PathAction::Tracking { on: true }));
        actions
    }
}

/// What happens on the part of a path that begins with target `first`, whose motions start at `starts` \[mm\] and go
/// at `speeds` \[mm/s\]: what is on already, then `events`; and where the speed changes.
pub(super) fn on_the_way(
    on: &Switched,
    events: &[Switching],
    first: usize,
    starts: &[f64],
    speeds: &[f64],
    place: SourcePosition,
) -> Result<(Vec<PathEvent>, Vec<SpeedStep>), PathError> {
    let before = on.actions().into_iter();
    let mut found: Vec<PathEvent> = before.map(|action| PathEvent { s_mm: 0.0, action }).collect();
    for event in events {
        let index = event.with_target.checked_sub(first);
        found.extend(index.and_then(|i| starts.get(i)).map(|s_mm| PathEvent {
            s_mm: *s_mm,
            action: event.action,
        }));
    }
    found.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
    let joins = speeds.windows(2).zip(starts.iter().skip(1));
    let steps: Vec<SpeedStep> = joins
        .filter(|(pair, _)| pair[0] != pair[1])
        .map(|(pair, s)| SpeedStep {
            s: *s,
            velocity: pair[1],
        })
        .collect();
    let events = found.len() + steps.len();
    if events > MAX_EVENTS {
        return Err(PathError::TooManyEvents { place, events });
    }
    Ok((found, steps))
}
