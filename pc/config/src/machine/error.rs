//! What is wrong with a machine file.

use crate::RangeError;
use crate::toml_file::TomlError;
use shared::parameter::ParameterError;
use thiserror::Error;

/// Why a machine file cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum MachineError {
    /// It cannot be read, is not TOML, or a key is missing, unknown or of the wrong type.
    #[error(transparent)]
    File(#[from] TomlError),
    /// A parameter of a board makes no sense.
    #[error("machine file {path}: {parameter}")]
    Parameter {
        /// The file.
        path: String,
        /// Owner, name and value.
        parameter: ParameterError,
    },
    /// Something else makes no sense.
    #[error("machine file {path}, line {line}: {mistake}")]
    Mistake {
        /// The file.
        path: String,
        /// Where its key is, or of one that is missing the table around it; first line is 1.
        line: usize,
        /// What it is.
        mistake: Mistake,
    },
}

/// What makes no sense in a machine file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Mistake {
    /// A value.
    #[error(transparent)]
    Value(#[from] RangeError),
    /// A key for an axis that the machine has is missing.
    #[error("{key} is missing; a {machine} has that axis")]
    AxisMissing {
        /// Dotted name of the key.
        key: String,
        /// Name of the kinematics.
        machine: &'static str,
    },
    /// A key for an axis that the machine does not have.
    #[error("{key} is given, but a {machine} has no such axis")]
    NoSuchAxis {
        /// Dotted name of the key.
        key: String,
        /// Name of the kinematics.
        machine: &'static str,
    },
    /// A figure of the cameras' optics.
    #[error("cameras.optics: {reason}")]
    Optics {
        /// Which, and what it has to be.
        reason: vision::OpticsError,
    },
    /// An output or input has a number that the board does not have, or that another one has.
    #[error("{key}.number is {number}, {}", if *taken { "which another one has".to_owned() } else { format!("but must be from 1 to {most}") })]
    OutputNumber {
        /// Dotted name of the table.
        key: String,
        /// The number.
        number: u8,
        /// Another one has it.
        taken: bool,
        /// How many there are.
        most: usize,
    },
    /// An output, an input or programs hang on a beam that the machine does not have.
    #[error("{key} names beam {beam}, but there is no [beams.{beam}]")]
    NoSuchBeam {
        /// Dotted name of the table.
        key: String,
        /// The number of the beam.
        beam: u8,
    },
    /// Nothing turns the spindle the other way.
    #[error(
        "program.spindle_reverse names \"{name}\", but needs an [outputs.{name}], and a spindle (a beam with stays_on_at_rest)"
    )]
    SpindleReverse {
        /// Name of the output.
        name: String,
    },
    /// No input is that of the probe.
    #[error(
        "program.probe names \"{input}\", but needs an [inputs.{input}] that answers nothing: it must not stop the machine"
    )]
    ProbeInput {
        /// Name of the input.
        input: String,
    },
    /// An input has only one of the keys of an answer.
    #[error(
        "{key} has {given} without {missing}: an input that answers needs both, one that programs wait for neither"
    )]
    AnswerIncomplete {
        /// Dotted name of the table.
        key: String,
        /// The key that is there.
        given: &'static str,
        /// The key that is not.
        missing: &'static str,
    },
    /// An input answers nothing that there is.
    #[error(
        "{key}.answers is \"{answers}\": it must be \"beam 1\", \"beam 2\" or the name of one of [outputs]"
    )]
    AnswersNothing {
        /// Dotted name of the table.
        key: String,
        /// What it is said to answer.
        answers: String,
    },
    /// A tool without a number.
    #[error("[{key}] is no tool: their numbers are whole, from 1, such as [tools.2]")]
    ToolNumber {
        /// Dotted name of the table.
        key: String,
    },
    /// A table of deviations.
    #[error("{key} {what}")]
    Deviations {
        /// Dotted name of the table.
        key: String,
        /// What is wrong with it.
        what: String,
    },
    /// Some of the tables of a tracker, but not all.
    #[error(
        "[{table}] is missing; a machine that follows a seam needs [head], [slides], [tracking] and [cameras]"
    )]
    TrackerIncomplete {
        /// The first that is missing.
        table: &'static str,
    },
}

impl Mistake {
    /// Dotted name of the key that it is about.
    pub(crate) fn key(&self) -> String {
        match self {
            Self::Value(error) => error.key.to_string(),
            Self::AxisMissing { key, .. } | Self::NoSuchAxis { key, .. } => key.clone(),
            Self::OutputNumber { key, .. } => format!("{key}.number"),
            Self::Deviations { key, .. } => key.clone(),
            Self::NoSuchBeam { key, .. } | Self::AnswerIncomplete { key, .. } | Self::ToolNumber { key } => {
                key.clone()
            }
            Self::SpindleReverse { .. } => "program.spindle_reverse".to_owned(),
            Self::ProbeInput { .. } => "program.probe".to_owned(),
            Self::AnswersNothing { key, .. } => format!("{key}.answers"),
            Self::Optics { .. } => "cameras.optics".to_owned(),
            Self::TrackerIncomplete { table } => (*table).to_owned(),
        }
    }
}
