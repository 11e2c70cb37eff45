//! Digital outputs and levels of the process, over the path.

use super::levels::Level;
use crate::config::{AnalogConfig, BeamConfig, OutputConfig, ProcessIo};
use crate::io::{ANALOG_OUTPUTS, Bits, DacCode, LEVELS, Lines, OUTPUTS, SIDES};
use crate::parameter::{ParameterError, positive};
use crate::protocol::Channel;
use crate::trajectory::SpeedState;

/// Names of the outputs in messages.
const OUTPUT_OWNERS: [&str; OUTPUTS] = [
    "output 1", "output 2", "output 3", "output 4", "output 5", "output 6", "output 7", "output 8",
];
const ANALOG_OWNERS: [&str; ANALOG_OUTPUTS] = ["analog output 1", "analog output 2"];
const BEAM_OWNERS: [&str; SIDES] = ["beam 1", "beam 2"];

/// What a machine has of outputs, and how they hang on its beams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputLimits {
    /// Whether there is such an output, and the beam that it follows.
    outputs: [Option<Option<usize>>; OUTPUTS],
    /// Value at +10 V of each level.
    full: [Option<f64>; LEVELS],
    /// The beam that it follows.
    follows: [Option<usize>; LEVELS],
}

impl OutputLimits {
    /// Checks the parameters of the outputs that the machine has.
    pub fn build(beams: &[Option<BeamConfig>; SIDES], process: &ProcessIo) -> Result<Self, ParameterError> {
        let mut limits = Self {
            outputs: [None; OUTPUTS],
            full: [None; LEVELS],
            follows: [None; LEVELS],
        };
        for (side, beam) in beams.iter().enumerate() {
            limits.full[side] = beam.as_ref().map(|beam| beam.power_at_10v_w);
            limits.follows[side] = Some(side);
        }
        for (index, output) in process.outputs.iter().enumerate() {
            let Some(OutputConfig { follows_beam }) = output else {
                continue;
            };
            limits.outputs[index] = Some(followed(OUTPUT_OWNERS[index], *follows_beam, beams)?);
        }
        for (index, analog) in process.analog.iter().enumerate() {
            let Some(AnalogConfig {
                value_at_10v,
                follows_beam,
            }) = analog
            else {
                continue;
            };
            let owner = ANALOG_OWNERS[index];
            limits.full[SIDES + index] = Some(positive(owner, "value_at_10v", *value_at_10v)?);
            limits.follows[SIDES + index] = followed(owner, *follows_beam, beams)?;
        }
        Ok(limits)
    }

    /// Whether the machine has digital output `index`.
    pub fn has(&self, index: u8) -> bool {
        self.outputs.get(usize::from(index)).is_some_and(Option::is_some)
    }

    /// The highest value of a level, if the machine has it.
    pub fn most(&self, channel: Channel) -> Option<f64> {
        self.full.get(channel.index()).copied().flatten()
    }
}

/// The beam that an output follows, which the machine must have.
fn followed(
    owner: &'static str,
    beam: Option<u8>,
    beams: &[Option<BeamConfig>; SIDES],
) -> Result<Option<usize>, ParameterError> {
    let Some(side) = beam else { return Ok(None) };
    let has = beams.get(usize::from(side)).is_some_and(Option::is_some);
    match has {
        true => Ok(Some(usize::from(side))),
        false => Err(ParameterError::new(owner, "follows_beam", f64::from(side) + 1.0)),
    }
}

/// The name of beam number `side` in messages.
pub fn beam_owner(side: usize) -> &'static str {
    BEAM_OWNERS[side]
}

/// What the events passed so far ask of the outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    on: Bits,
    levels: [Level; LEVELS],
}

impl Outputs {
    /// Everything off.
    pub const NONE: Self = Self {
        on: Bits::NONE,
        levels: [Level::ZERO; LEVELS],
    };

    /// Switches a digital output.
    pub fn switch(&mut self, output: u8, on: bool) {
        self.on.set(usize::from(output), on);
    }

    /// The level of `channel`.
    pub fn level(&mut self, channel: Channel) -> &mut Level {
        &mut self.levels[channel.index()]
    }

    /// The path ends at `s_mm`: levels stay as they are there.
    pub fn settle(&mut self, s_mm: f64) {
        self.levels.iter_mut().for_each(|level| level.settle(s_mm));
    }

    /// Gates and digital outputs, the gates being `gates`: what follows a beam is on with it only.
    pub fn lines(&self, limits: &OutputLimits, gates: [bool; SIDES]) -> Lines {
        let mut lines = Lines::of_gates(gates);
        for (output, follows) in limits.outputs.iter().enumerate() {
            let Some(follows) = follows else { continue };
            let on = self.on.get(output) && follows.is_none_or(|side| gates[side]);
            lines.set(SIDES + output, on);
        }
        lines
    }

    /// Codes of the levels at `now`, where the gates `open` at any time in the millisecond.
    pub fn codes(&self, limits: &OutputLimits, now: &SpeedState, open: [bool; SIDES]) -> [DacCode; LEVELS] {
        core::array::from_fn(|index| {
            let shut = limits.follows[index].is_some_and(|side| !open[side]);
            match limits.full[index] {
                Some(full) if !shut => DacCode::from_ratio(self.levels[index].at(now).max(0.0), full),
                _ => DacCode::ZERO,
            }
        })
    }
}
