//! Parameters of programs: `#1`, `#<local>` and `#<_global>`, and `R1` of Siemens controllers.

use super::error::Problem;
use super::probing::Found;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::RangeInclusive;

/// Largest number of a parameter.
const LAST: f64 = 5602.0;
/// Parameters of a subroutine itself, 1 to this one, and those of a macro that G65 calls.
const OWN: u32 = 30;
const OWN_OF_MACRO: u32 = 33;
/// R parameters: R0 to the one before.
const SIEMENS: u16 = 300;

/// Numbers that on Fanuc controllers are values of the controller: offsets of tools, alarms and clocks, modes, and where the axes are.
const OF_CONTROL: [RangeInclusive<u32>; 4] = [2001..=2999, 3000..=3021, 4001..=4130, 5001..=5060];

/// What the last M66 found.
pub(super) const INPUT: u32 = 5399;

/// A parameter by number or by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Parameter {
    /// 1 to 5602.
    Numbered(u32),
    /// Lower case; global if it begins with `_`.
    Named(String),
    /// R0 to R299: the same ones in all of a program.
    Siemens(u16),
    /// A variable of Siemens, upper case: of the program that defines it, else the global one of this name if it begins with `_`.
    Variable {
        /// Its name.
        name: String,
        /// Element of an array, from 0.
        index: u32,
    },
}

/// Type of a variable of Siemens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// REAL.
    Real,
    /// INT.
    Whole,
    /// BOOL.
    Truth,
}

/// A variable of Siemens with its elements, of which an array has several.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Variable {
    kind: Kind,
    values: Vec<f64>,
}

impl Variable {
    pub(super) fn new(kind: Kind, values: Vec<f64>) -> Self {
        let mut variable = Self { kind, values };
        for index in 0..variable.values.len() {
            variable.set(index as u32, variable.values[index]);
        }
        variable
    }

    fn get(&self, index: u32) -> Option<f64> {
        self.values.get(index as usize).copied()
    }

    /// Gives an element a value of its type; whether there is such an element.
    fn set(&mut self, index: u32, value: f64) -> bool {
        let of_kind = match self.kind {
            Kind::Real => value,
            Kind::Whole => value.round(),
            Kind::Truth => f64::from(u8::from(value != 0.0)),
        };
        let element = self.values.get_mut(index as usize);
        element.map(|element| *element = of_kind).is_some()
    }
}

impl Parameter {
    /// R with these digits.
    pub(super) fn siemens(digits: &str) -> Option<Self> {
        let number = digits.parse().ok().filter(|number| *number < SIEMENS);
        number.map(Self::Siemens)
    }

    /// That of a number, which may have been computed.
    pub(super) fn numbered(number: f64) -> Option<Self> {
        let whole = number.round();
        let near = (number - whole).abs() < 1e-4 && (0.0..=LAST).contains(&whole);
        near.then_some(Self::Numbered(whole as u32))
    }

    /// Why it cannot be read.
    pub(super) fn no_value(&self) -> Problem {
        match self {
            Self::Numbered(number) if is_of_control(*number) => Problem::OfControl(*number),
            Self::Numbered(number) => Problem::Vacant(*number),
            _ => Problem::Undefined(self.to_string()),
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Numbered(number) => write!(f, "#{number}"),
            Self::Named(name) => write!(f, "#<{name}>"),
            Self::Siemens(number) => write!(f, "R{number}"),
            Self::Variable { name, index: 0 } => write!(f, "{name}"),
            Self::Variable { name, index } => write!(f, "{name}[{index}]"),
        }
    }
}

/// Values of parameters while a block is read.
pub(super) trait Lookup {
    /// The value; none of a name that has not been set.
    fn value(&mut self, parameter: &Parameter) -> Option<f64>;

    /// Whether a numbered parameter has been given a value.
    fn has_value(&mut self, _number: u32) -> bool {
        true
    }

    /// Whether the block that is read sets it.
    fn is_set_here(&self, _parameter: &Parameter) -> bool {
        false
    }
}

/// What the words of a block see: the values from before it, but of R parameters those that it has set.
pub(super) struct InBlock<'a> {
    before: &'a mut dyn Lookup,
    pub(super) settings: Vec<(Parameter, f64)>,
    /// Whose value is read.
    pub(super) next: Option<Parameter>,
}

impl<'a> InBlock<'a> {
    pub(super) fn new(before: &'a mut dyn Lookup) -> Self {
        Self {
            before,
            settings: Vec::new(),
            next: None,
        }
    }
}

impl Lookup for InBlock<'_> {
    fn value(&mut self, parameter: &Parameter) -> Option<f64> {
        let set = self.settings.iter().rev().find(|(own, _)| own == parameter);
        match (parameter, set) {
            (Parameter::Siemens(_) | Parameter::Variable { .. }, Some((_, value))) => Some(*value),
            _ => self.before.value(parameter),
        }
    }

    fn has_value(&mut self, number: u32) -> bool {
        self.before.has_value(number)
    }

    fn is_set_here(&self, parameter: &Parameter) -> bool {
        self.next
            .iter()
            .chain(self.settings.iter().map(|(own, _)| own))
            .any(|own| own == parameter)
    }
}

/// What one level of a program calls its own.
#[derive(Clone, Debug, Default)]
struct Level {
    own: BTreeMap<u32, f64>,
    /// It was called by G65: what is not given to it has no value.
    is_macro: bool,
    named: BTreeMap<String, f64>,
    variables: BTreeMap<String, Variable>,
}

impl Level {
    fn owns(&self, number: u32) -> bool {
        let last = if self.is_macro { OWN_OF_MACRO } else { OWN };
        (1..=last).contains(&number)
    }
}

/// Values that programs set.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    numbered: BTreeMap<u32, f64>,
    global: BTreeMap<String, f64>,
    siemens: BTreeMap<u16, f64>,
    /// How many values were set.
    pub(super) changes: u64,
    /// The innermost subroutine last.
    levels: Vec<Level>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            numbered: BTreeMap::new(),
            global: BTreeMap::new(),
            siemens: BTreeMap::new(),
            changes: 0,
            levels: vec![Level::default()],
        }
    }
}

impl Parameters {
    /// Before anything is set; with what a probe has found before.
    pub(super) fn new(found: Option<Found>) -> Self {
        let mut parameters = Self::default();
        if let Some(found) = found {
            parameters.found(found);
        }
        parameters
    }

    /// Takes what a probe has found.
    pub(super) fn found(&mut self, found: Found) {
        self.changes += 1;
        self.numbered.extend(found.parameters());
    }

    /// A subroutine begins, with its arguments.
    pub(super) fn enter(&mut self, arguments: &[f64]) {
        let own = (1..=OWN).zip(arguments.iter().copied()).collect();
        self.levels.push(Level {
            own,
            ..Level::default()
        });
    }

    /// A macro begins, with the numbers of its arguments.
    pub(super) fn enter_macro(&mut self, arguments: &[(u32, f64)]) {
        self.levels.push(Level {
            own: arguments.iter().copied().collect(),
            is_macro: true,
            ..Level::default()
        });
    }

    /// Whether a numbered one has been given a value.
    pub(super) fn has_value(&self, number: u32) -> bool {
        let level = self.levels.last();
        match level.filter(|level| level.owns(number)) {
            Some(level) => level.own.contains_key(&number),
            None => self.numbered.contains_key(&number),
        }
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

    /// Numbered ones are 0 until they are set, but for those of macros and of controllers.
    pub(super) fn get(&self, parameter: &Parameter) -> Option<f64> {
        let level = self.levels.last()?;
        match parameter {
            Parameter::Numbered(number) if level.owns(*number) => {
                let value = level.own.get(number).copied();
                value.or((!level.is_macro).then_some(0.0))
            }
            Parameter::Numbered(number) => {
                let value = self.numbered.get(number).copied();
                value.or((!is_of_control(*number)).then_some(0.0))
            }
            Parameter::Named(name) if name.starts_with('_') => self.global.get(name).copied(),
            Parameter::Named(name) => level.named.get(name).copied(),
            Parameter::Siemens(number) => Some(self.siemens.get(number).copied().unwrap_or(0.0)),
            Parameter::Variable { name, index } => match level.variables.get(name) {
                Some(variable) => variable.get(*index),
                None => self.get(&global(name)?),
            },
        }
    }

    /// Defines a variable in the innermost program.
    pub(super) fn define(&mut self, name: String, variable: Variable) {
        self.changes += 1;
        if let Some(level) = self.levels.last_mut() {
            level.variables.insert(name, variable);
        }
    }

    /// Gives one a value.
    pub(super) fn set(&mut self, parameter: &Parameter, value: f64) -> Result<(), Problem> {
        self.changes += 1;
        let Some(level) = self.levels.last_mut() else {
            return Ok(());
        };
        match parameter {
            Parameter::Numbered(number) if level.owns(*number) => {
                level.own.insert(*number, value);
            }
            Parameter::Numbered(number) => {
                self.numbered.insert(*number, value);
            }
            Parameter::Named(name) if name.starts_with('_') => {
                self.global.insert(name.clone(), value);
            }
            Parameter::Named(name) => {
                level.named.insert(name.clone(), value);
            }
            Parameter::Siemens(number) => {
                self.siemens.insert(*number, value);
            }
            Parameter::Variable { name, index } => {
                let is_set = match (level.variables.get_mut(name), global(name)) {
                    (Some(variable), _) => variable.set(*index, value),
                    (None, Some(global)) => return self.set(&global, value),
                    (None, None) => false,
                };
                return match is_set {
                    true => Ok(()),
                    false => Err(Problem::Undefined(parameter.to_string())),
                };
            }
        }
        Ok(())
    }
}

fn is_of_control(number: u32) -> bool {
    OF_CONTROL.iter().any(|numbers| numbers.contains(&number))
}

/// The global parameter that a variable is where it is not defined.
fn global(name: &str) -> Option<Parameter> {
    let global = Parameter::Named(name.to_ascii_lowercase());
    name.starts_with('_').then_some(global)
}
