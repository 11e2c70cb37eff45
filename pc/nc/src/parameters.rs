//! Parameters of programs: `#1`, `#<local>` and `#<_global>`.

use super::error::Problem;
use std::collections::BTreeMap;
use std::fmt;

/// Largest number of a parameter.
const LAST: f64 = 5602.0;
/// Parameters of a subroutine itself, 1 to this one.
const OWN: u32 = 30;

/// What the last M66 found.
pub(super) const INPUT: u32 = 5399;

/// A parameter by number or by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Parameter {
    /// 1 to 5602.
    Numbered(u32),
    /// Lower case; global if it begins with `_`.
    Named(String),
}

impl Parameter {
    /// That of a number, which may have been computed.
    pub(super) fn numbered(number: f64) -> Option<Self> {
        let whole = number.round();
        let near = (number - whole).abs() < 1e-4 && (0.0..=LAST).contains(&whole);
        near.then_some(Self::Numbered(whole as u32))
    }

    /// Why it cannot be read.
    pub(super) fn no_value(&self) -> Problem {
        match self {
            Self::Numbered(INPUT) => Problem::InputUnknown,
            _ => Problem::Undefined(self.to_string()),
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbered(number) => write!(f, "#{number}"),
            Self::Named(name) => write!(f, "#<{name}>"),
        }
    }
}

/// Values of parameters while a block is read.
pub(super) trait Lookup {
    /// The value; none of a name that has not been set.
    fn value(&mut self, parameter: &Parameter) -> Option<f64>;
}

/// What one level of a program calls its own.
#[derive(Clone, Debug, Default)]
struct Level {
    own: [f64; OWN as usize],
    named: BTreeMap<String, f64>,
}

/// Values that programs set.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    numbered: BTreeMap<u32, f64>,
    global: BTreeMap<String, f64>,
    /// The innermost subroutine last.
    levels: Vec<Level>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            numbered: BTreeMap::new(),
            global: BTreeMap::new(),
            levels: vec![Level::default()],
        }
    }
}

impl Parameters {
    /// A subroutine begins, with its arguments.
    pub(super) fn enter(&mut self, arguments: &[f64]) {
        let mut level = Level::default();
        for (place, value) in level.own.iter_mut().zip(arguments) {
            *place = *value;
        }
        self.levels.push(level);
    }

    /// Subroutines inside each other, with the main program.
    pub(super) fn depth(&self) -> usize {
        self.levels.len()
    }

    /// It has ended.
    pub(super) fn leave(&mut self) {
        if self.levels.len() > 1 {
            self.levels.pop();
        }
    }

    /// Numbered ones are 0 until they are set.
    pub(super) fn get(&self, parameter: &Parameter) -> Option<f64> {
        let level = self.levels.last()?;
        match parameter {
            Parameter::Numbered(number @ 1..=OWN) => level.own.get(*number as usize - 1).copied(),
            Parameter::Numbered(number) => Some(self.numbered.get(number).copied().unwrap_or(0.0)),
            Parameter::Named(name) if name.starts_with('_') => self.global.get(name).copied(),
            Parameter::Named(name) => level.named.get(name).copied(),
        }
    }

    /// Gives one a value.
    pub(super) fn set(&mut self, parameter: &Parameter, value: f64) {
        let Some(level) = self.levels.last_mut() else {
            return;
        };
        match parameter {
            Parameter::Numbered(number @ 1..=OWN) => level.own[*number as usize - 1] = value,
            Parameter::Numbered(number) => {
                self.numbered.insert(*number, value);
            }
            Parameter::Named(name) if name.starts_with('_') => {
                self.global.insert(name.clone(), value);
            }
            Parameter::Named(name) => {
                level.named.insert(name.clone(), value);
            }
        }
    }
}
