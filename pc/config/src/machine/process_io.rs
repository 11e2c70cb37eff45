//! Outputs and inputs of the process, which the file calls by name.

use super::Mistake;
use serde::Deserialize;
use shared::config::{AnalogConfig, BeamConfig, OutputConfig, ProcessInputConfig, ProcessIo};
use shared::io::SIDES;
use std::collections::BTreeMap;

/// What the machine has of outputs, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OutputNames {
    /// Digital outputs: from the name to the number, from 0.
    pub outputs: BTreeMap<String, u8>,
    /// Analog outputs.
    pub analog: BTreeMap<String, u8>,
}

/// A digital output as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    number: u8,
    follows_beam: Option<u8>,
}

/// An analog output.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Analog {
    number: u8,
    value_at_10v: f64,
    follows_beam: Option<u8>,
}

/// An input.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    number: u8,
    /// "beam 1", "beam 2" or the name of an output.
    answers: String,
    within_ms: u32,
}

/// Tables `[outputs.NAME]`, `[analog_outputs.NAME]` and `[inputs.NAME]`.
pub struct Tables {
    pub outputs: BTreeMap<String, Output>,
    pub analog: BTreeMap<String, Analog>,
    pub inputs: BTreeMap<String, Input>,
}

impl Tables {
    /// What the board is told, and the names.
    pub fn build(self, beams: &[Option<BeamConfig>; SIDES]) -> Result<(ProcessIo, OutputNames), Mistake> {
        let mut io = ProcessIo::default();
        let mut names = OutputNames::default();
        for (name, output) in &self.outputs {
            let key = format!("outputs.{name}");
            let config = OutputConfig {
                follows_beam: followed(&key, output.follows_beam, beams)?,
            };
            let number = place(&key, output.number, &mut io.outputs, config)?;
            names.outputs.insert(name.clone(), number);
        }
        for (name, analog) in &self.analog {
            let key = format!("analog_outputs.{name}");
            let config = AnalogConfig {
                value_at_10v: analog.value_at_10v,
                follows_beam: followed(&key, analog.follows_beam, beams)?,
            };
            let number = place(&key, analog.number, &mut io.analog, config)?;
            names.analog.insert(name.clone(), number);
        }
        for (name, input) in &self.inputs {
            let key = format!("inputs.{name}");
            let beam = input.answers.strip_prefix("beam ");
            let line = match beam.and_then(|beam| beam.parse().ok()) {
                Some(beam) => followed(&key, Some(beam), beams)?,
                None => names
                    .outputs
                    .get(&input.answers)
                    .map(|output| output + SIDES as u8),
            };
            let answers = line.ok_or_else(|| Mistake::AnswersNothing {
                key: key.clone(),
                answers: input.answers.clone(),
            })?;
            let within_ms = input.within_ms;
            place(
                &key,
                input.number,
                &mut io.inputs,
                ProcessInputConfig { answers, within_ms },
            )?;
        }
        Ok((io, names))
    }
}

/// The beam of that number, from 0, which the machine must have.
fn followed(key: &str, beam: Option<u8>, beams: &[Option<BeamConfig>; SIDES]) -> Result<Option<u8>, Mistake> {
    let Some(beam) = beam else { return Ok(None) };
    let side = beam.wrapping_sub(1);
    match beams.get(usize::from(side)) {
        Some(Some(_)) => Ok(Some(side)),
        _ => Err(Mistake::NoSuchBeam {
            key: key.to_owned(),
            beam,
        }),
    }
}

/// Puts `config` where its number says, which counts from 1; the number from 0.
fn place<T: Copy, const N: usize>(
    key: &str,
    number: u8,
    places: &mut [Option<T>; N],
    config: T,
) -> Result<u8, Mistake> {
    let index = number.wrapping_sub(1);
    match places.get_mut(usize::from(index)) {
        Some(place @ None) => *place = Some(config),
        taken => {
            return Err(Mistake::OutputNumber {
                key: key.to_owned(),
                number,
                taken: taken.is_some(),
                most: N,
            });
        }
    }
    Ok(index)
}
