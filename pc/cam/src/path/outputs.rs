//! Outputs of a program, checked against the machine.

use super::{MAX_EVENTS, PathError, Planner, SpeedStep};
use nc::{ProgramAction, ProgramEvent, SourcePosition};
use shared::geometry::Turn;
use shared::io::{LEVELS, OUTPUTS, SIDES};
use shared::protocol::{Channel, PathAction, PathEvent};

/// A switching at the start of the motion to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Switching {
    pub(super) with_target: usize,
    /// So far behind \[mm\].
    pub(super) after_mm: f64,
    pub(super) action: PathAction,
}

impl Planner {
    /// `events` as the motion board knows them. Beams, spindle and tracking must be there, and give only so much.
    pub(super) fn switchings(&self, events: &[ProgramEvent]) -> Result<Vec<Switching>, PathError> {
        let mut switchings = Vec::new();
        for event in events {
            switchings.extend(self.actions(event)?.into_iter().map(|action| Switching {
                with_target: event.with_target,
                after_mm: event.after_mm,
                action,
            }));
        }
        Ok(switchings)
    }

    /// What an event switches, in this order; of coolant and the first tool [`Planner::notices`] tells.
    pub(super) fn actions(&self, event: &ProgramEvent) -> Result<Vec<PathAction>, PathError> {
        let place = event.place;
        Ok(match event.action {
            ProgramAction::Coolant { .. } | ProgramAction::ChangeTool(_) => Vec::new(),
            // Weld data has taken its place.
            ProgramAction::WeldOn(_) | ProgramAction::WeldOff => Vec::new(),
            ProgramAction::Output(action) => {
                self.check_output(&action, place)?;
                vec![action]
            }
            ProgramAction::SpindleSpeed(rpm) => {
                let side = self.spindle(event)?;
                let largest = self.largest_power[usize::from(side)].unwrap_or(0.0);
                if rpm > largest {
                    return Err(PathError::SpindleSpeed { place, rpm, largest });
                }
                vec![PathAction::Power { side, watt: rpm }]
            }
            ProgramAction::SpindleOn(turn) => {
                let side = self.spindle(event)?;
                let on = PathAction::Beam { side, on: true };
                match self.spindle_reversed(turn == Turn::CounterClockwise) {
                    None if turn == Turn::CounterClockwise => {
                        let machine = self.name.clone();
                        return Err(PathError::SpindleSense { place, machine });
                    }
                    reversed => reversed.into_iter().chain([on]).collect(),
                }
            }
            ProgramAction::SpindleOff => {
                let side = self.spindle(event)?;
                let off = PathAction::Beam { side, on: false };
                [off].into_iter().chain(self.spindle_reversed(false)).collect()
            }
        })
    }

    /// Switches the output with which the spindle turns the other way, if the machine file names one.
    fn spindle_reversed(&self, on: bool) -> Option<PathAction> {
        let name = self.program.spindle_reverse.as_ref()?;
        let output = *self.output_names.outputs.get(name)?;
        Some(PathAction::Output { output, on })
    }

    /// The beam that is the spindle: the one that stays on at rest.
    fn spindle(&self, event: &ProgramEvent) -> Result<u8, PathError> {
        self.spindle.ok_or_else(|| PathError::NoSpindle {
            place: event.place,
            code: event.code,
            machine: self.name.clone(),
        })
    }

    pub(super) fn check_output(&self, action: &PathAction, place: SourcePosition) -> Result<(), PathError> {
        let missing = |output: String| PathError::NoOutput {
            place,
            output,
            machine: self.name.clone(),
        };
        match *action {
            PathAction::Beam { side, .. } | PathAction::AtRest { side, .. } => {
                self.most(Channel::Power(side), place).map(|_| ())
            }
            PathAction::Power { side, watt } => self.check_level(Channel::Power(side), watt, place),
            PathAction::Level { channel, value, .. } => self.check_level(channel, value, place),
            PathAction::BySpeed { channel, .. } => self.most(channel, place).map(|_| ()),
            PathAction::Output { output, .. } => {
                let has = self
                    .io
                    .outputs
                    .get(usize::from(output))
                    .is_some_and(Option::is_some);
                has.then_some(())
                    .ok_or_else(|| missing(format!("output {}", output + 1)))
            }
            PathAction::Tracking { .. } if !self.tracks => Err(missing("seam tracking".to_owned())),
            PathAction::Tracking { .. } => Ok(()),
        }
    }

    /// The highest value of a level.
    fn most(&self, channel: Channel, place: SourcePosition) -> Result<f64, PathError> {
        let (most, output) = match channel {
            Channel::Power(side) => {
                let power = self.largest_power.get(usize::from(side)).copied();
                (power.flatten(), format!("beam {}", side + 1))
            }
            Channel::Analog(output) => {
                let analog = self.io.analog.get(usize::from(output)).copied().flatten();
                (
                    analog.map(|analog| analog.value_at_10v),
                    format!("analog output {}", output + 1),
                )
            }
        };
        most.ok_or_else(|| PathError::NoOutput {
            place,
            output,
            machine: self.name.clone(),
        })
    }

    fn check_level(&self, channel: Channel, value: f64, place: SourcePosition) -> Result<(), PathError> {
        let largest = self.most(channel, place)?;
        match channel {
            _ if value <= largest => Ok(()),
            Channel::Power(side) => Err(PathError::Power {
                place,
                side,
                watt: value,
                largest,
            }),
            Channel::Analog(output) => Err(PathError::Level {
                place,
                output,
                value,
                largest,
            }),
        }
    }
}

/// What the program has switched on so far. The boards begin every path with everything off, but for a spindle and the outputs
/// of the process; these are said again too, for a start in the middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Switched {
    levels: [Option<f64>; LEVELS],
    /// Speed at which each level is full, and the least part.
    by_speed: [Option<(f64, f64)>; LEVELS],
    rest_ms: [Option<u32>; SIDES],
    gates: [bool; SIDES],
    outputs: [Option<bool>; OUTPUTS],
    tracks: bool,
}

impl Switched {
    pub(super) fn switch(&mut self, action: &PathAction) {
        match *action {
            PathAction::Power { side, watt } => self.levels[usize::from(side)] = Some(watt),
            PathAction::Beam { side, on } => self.gates[usize::from(side)] = on,
            PathAction::Tracking { on } => self.tracks = on,
            PathAction::Output { output, on } => self.outputs[usize::from(output)] = Some(on),
            PathAction::Level { channel, value, .. } => self.levels[channel.index()] = Some(value),
            PathAction::BySpeed {
                channel,
                full_mm_s,
                least,
            } => {
                self.by_speed[channel.index()] = Some((full_mm_s, least));
            }
            PathAction::AtRest { side, ms } => self.rest_ms[usize::from(side)] = Some(ms),
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
        for (channel, level) in CHANNELS.into_iter().zip(self.levels) {
            actions.extend(level.map(|value| match channel {
                Channel::Power(side) => PathAction::Power { side, watt: value },
                Channel::Analog(_) => PathAction::Level {
                    channel,
                    value,
                    over_mm: 0.0,
                },
            }));
        }
        for (channel, by_speed) in CHANNELS.into_iter().zip(self.by_speed) {
            actions.extend(by_speed.map(|(full_mm_s, least)| PathAction::BySpeed {
                channel,
                full_mm_s,
                least,
            }));
        }
        for (output, on) in (0..).zip(self.outputs) {
            actions.extend(on.map(|on| PathAction::Output { output, on }));
        }
        for (side, (rest, gate)) in (0..).zip(self.rest_ms.into_iter().zip(self.gates)) {
            actions.extend(rest.map(|ms| PathAction::AtRest { side, ms }));
            actions.extend(gate.then_some(PathAction::Beam { side, on: true }));
        }
        actions.extend(self.tracks.then_some(PathAction::Tracking { on: true }));
        actions
    }
}

/// All levels, in the order of their places.
const CHANNELS: [Channel; LEVELS] = [
    Channel::Power(0),
    Channel::Power(1),
    Channel::Analog(0),
    Channel::Analog(1),
];

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
            s_mm: *s_mm + event.after_mm,
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
