//! What a parameter may be, as the reader of machine files says when it is given one that cannot be.

use super::{Kind, Parameter, replace};
use crate::machine::{MachineError, MachineFile, Mistake};
use crate::toml_file::TomlError;
use shared::parameter::Allowed;
use std::fmt;

/// Values that no parameter has: far below and far above all.
const FAR: [f64; 2] = [-1e9, 1e9];

/// What a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// From the first to the second.
    Within(f64, f64),
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// In words, in English.
    Said(&'static str),
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within(least, most) => write!(f, "{least} … {most}"),
            Self::Positive => f.write_str("> 0"),
            Self::NotNegative => f.write_str("≥ 0"),
            Self::Said(words) => f.write_str(words),
        }
    }
}

/// What the reader says that `parameter` of the machine file `text` may be, where everything else is as it is: its answers to one
/// value far below and one far above all. None where it says only that a value cannot be.
///
/// What it says of one parameter alone may not be enough: it also holds parameters against each other, and then names another one.
pub fn ranges(text: &str, parameter: &Parameter) -> Vec<Range> {
    let mut found = Vec::new();
    for far in FAR {
        let Some(refused) = far_value(parameter, far).and_then(|typed| refusal(text, parameter, &typed))
        else {
            continue;
        };
        let range = match &refused {
            MachineError::Parameter { parameter, .. } => match parameter.allowed() {
                Allowed::Within(least, most) => Range::Within(shortest(least), shortest(most)),
                Allowed::Positive => Range::Positive,
                Allowed::NotNegative => Range::NotNegative,
                Allowed::Unsaid => continue,
            },
            MachineError::Mistake {
                mistake: Mistake::Value(error),
                ..
            } => Range::Said(error.requirement),
            _ => continue,
        };
        if !found.contains(&range) {
            found.push(range);
        }
    }
    // Beside a range the sign says nothing more.
    if found.iter().any(|range| matches!(range, Range::Within(..))) {
        found.retain(|range| !matches!(range, Range::Positive | Range::NotNegative));
    }
    found
}

/// Whether `error` is about `parameter`, as it stands in the text that was refused.
pub fn is_about(error: &MachineError, parameter: &Parameter) -> bool {
    match error {
        MachineError::File(TomlError::Content { line, message, .. }) => {
            let named = message.strip_prefix(&*parameter.key);
            *line == parameter.line && named.is_some_and(|said| said.starts_with(':'))
        }
        MachineError::File(TomlError::Read { .. }) => false,
        MachineError::Mistake { mistake, .. } => mistake.key() == parameter.key,
        MachineError::Parameter { parameter: error, .. } => {
            let (Some(owner), Some(field)) = (error.owner(), error.field()) else {
                return false;
            };
            let Some(tables) = parameter.key.strip_suffix(field) else {
                return false;
            };
            // "axis X" is [axes.X], "beam 1" is [beams.1]; what stands above all tables has an owner without a table.
            let name = owner.split(' ').next_back().unwrap_or_default();
            let is_of_owner = tables.is_empty() || tables.split('.').any(|table| table == name);
            is_of_owner && numbers(&parameter.value).any(|number| number as f32 == error.value())
        }
    }
}

/// What the reader says to `typed`, if that is about `parameter`.
fn refusal(text: &str, parameter: &Parameter, typed: &str) -> Option<MachineError> {
    let refused = MachineFile::parse("", &replace(text, parameter, typed).ok()?).err()?;
    let as_typed = Parameter {
        value: typed.to_owned(),
        ..parameter.clone()
    };
    is_about(&refused, &as_typed).then_some(refused)
}

/// `far` in place of the number, or of each number of a list.
fn far_value(parameter: &Parameter, far: f64) -> Option<String> {
    match parameter.kind {
        Kind::Float => Some(format!("{far:?}")),
        // Those of a machine file are not negative.
        Kind::Integer => Some(format!("{:.0}", far.max(0.0))),
        Kind::Text => None,
        Kind::Other => {
            let count = numbers(&parameter.value).count();
            let is_list = parameter.value.starts_with('[') && !parameter.value.contains(['{', '"']);
            (is_list && count > 0).then(|| format!("[{}]", vec![format!("{far:?}"); count].join(", ")))
        }
    }
}

/// The numbers of a value as it is written.
fn numbers(value: &str) -> impl Iterator<Item = f64> {
    let parts = value.split(|letter: char| "[],{}= ".contains(letter));
    parts.filter_map(|part| part.replace('_', "").parse().ok())
}

/// The shortest decimal number that an error's number stands for.
fn shortest(number: f32) -> f64 {
    number.to_string().parse().unwrap_or_else(|_| f64::from(number))
}
