//! Outputs and inputs of the process, which the file calls by name.

use super::Mistake;
use serde::Deserialize;
use shared::config::{AnalogConfig, BeamConfig, OutputConfig, ProcessInputConfig, ProcessIo};
use shared::io::{PROCESS_INPUTS, SIDES};
use std::collections::BTreeMap;

/// What the machine has of outputs, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OutputNames {
    /// Digital outputs: from the name to the number, from 0.
    pub outputs: BTreeMap<String, u8>,
    /// Analog outputs.
    pub analog: BTreeMap<String, u8>,
}

/// Inputs by name, and their numbers, from 0.
pub type InputNames = BTreeMap<String, u8>;

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

/// An input. Only one that answers something stops the machine; programs may wait for any.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    number: u8,
    /// "beam 1", "beam 2" or the name of an output.
    answers: Option<String>,
    within_ms: Option<u32>,
}

/// Tables `[outputs.NAME]`, `[analog_outputs.NAME]` and `[inputs.NAME]`.
pub struct Tables {
    pub outputs: BTreeMap<String, Output>,
    pub analog: BTreeMap<String, Analog>,
    pub inputs: BTreeMap<String, Input>,
}

impl Tables {
    /// What the board is told, and the names.
    pub fn build(
        self,
        beams: &[Option<BeamConfig>; SIDES],
    ) -> Result<(ProcessIo, OutputNames, InputNames), Mistake> {
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
        let mut inputs = [None; PROCESS_INPUTS];
        let mut input_names = InputNames::new();
        for (name, input) in &self.inputs {
            let key = format!("inputs.{name}");
            let answer = answer(&key, input, &names, beams)?;
            let number = place(&key, input.number, &mut inputs, answer)?;
            input_names.insert(name.clone(), number);
        }
        io.inputs = inputs.map(Option::flatten);
        Ok((io, names, input_names))
    }
}

/// What `input` answers, if anything.
fn answer(
    key: &str,
    input: &Input,
    names: &OutputNames,
    beams: &[Option<BeamConfig>; SIDES],
) -> Result<Option<ProcessInputConfig>, Mistake> {
    let (answers, within_ms) = match (&input.answers, input.within_ms) {
        (None, None) => return Ok(None),
        (Some(answers), Some(within_ms)) => (answers, within_ms),
        (answers, _) => {
            return Err(Mistake::AnswerIncomplete {
                key: key.to_owned(),
                given: answers.as_ref().map_or("within_ms", |_| "answers"),
                missing: answers.as_ref().map_or("answers", |_| "within_ms"),
            });
        }
    };
    let beam = answers.strip_prefix("beam ");
    let line = match beam.and_then(|beam| beam.parse().ok()) {
        Some(beam) => followed(key, Some(beam), beams)?,
        None => names.outputs.get(answers).map(|output| output + SIDES as u8),
    };
    let answers = line.ok_or_else(|| Mistake::AnswersNothing {
        key: key.to_owned(),
        answers: answers.clone(),
    })?;
    Ok(Some(ProcessInputConfig { answers, within_ms }))
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
