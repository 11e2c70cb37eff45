//! Parameters that stand for the state of the machine and of the program, beside those that programs set.

use super::codes::Code;
use super::error::{Problem, SourcePosition};
use super::expression;
use super::interpreter::Interpreter;
use super::offsets::SYSTEMS;
use super::parameters::{INPUT, Lookup, Parameter};
use super::scanner::Scanner;
use shared::io::AXES;
use std::ops::RangeInclusive;

/// G28, G30: position of X.
const HOMES: [u32; 2] = [5161, 5181];
/// G52 and G92: whether they hold, and X.
const LOCAL_ON: u32 = 5210;
const LOCAL: u32 = 5211;
/// Number of the coordinate system that holds.
const SYSTEM: u32 = 5220;
/// X of G54; the next systems follow in steps, the rotation behind the axes.
const FIRST_SYSTEM: u32 = 5221;
const SYSTEM_STEP: u32 = 20;
const ROTATION: u32 = 9;
/// The tool in the machine, its length in the table \[mm\], and X of where it is.
const TOOL: u32 = 5400;
const TOOL_LENGTH: u32 = 5403;
const HERE: u32 = 5420;
/// Parameters that programs cannot set.
const READ_ONLY: RangeInclusive<u32> = 5400..=5428;

/// What a numbered parameter stands for.
enum Place {
    Home(usize, usize),
    LocalOn,
    Local(usize),
    System,
    Offset(usize, usize),
    Rotation(usize),
    Tool,
    ToolLength,
    Here(usize),
}

fn axis(number: u32, first: u32) -> Option<usize> {
    let axis = number.checked_sub(first)? as usize;
    (axis < AXES).then_some(axis)
}

fn place(number: u32) -> Option<Place> {
    for (index, first) in HOMES.into_iter().enumerate() {
        if let Some(axis) = axis(number, first) {
            return Some(Place::Home(index, axis));
        }
    }
    if let Some(axis) = axis(number, LOCAL) {
        return Some(Place::Local(axis));
    }
    if let Some(axis) = axis(number, HERE) {
        return Some(Place::Here(axis));
    }
    match number {
        LOCAL_ON => return Some(Place::LocalOn),
        SYSTEM => return Some(Place::System),
        TOOL => return Some(Place::Tool),
        TOOL_LENGTH => return Some(Place::ToolLength),
        _ => {}
    }
    let behind = number.checked_sub(FIRST_SYSTEM)?;
    let (system, entry) = ((behind / SYSTEM_STEP) as usize, behind % SYSTEM_STEP);
    match entry {
        _ if system >= SYSTEMS => None,
        ROTATION => Some(Place::Rotation(system)),
        entry => axis(entry, 0).map(|axis| Place::Offset(system, axis)),
    }
}

/// Alarms and stops of Fanuc controllers.
const ALARM: u32 = 3000;
const STOP: u32 = 3006;

impl Lookup for Interpreter {
    fn has_value(&mut self, number: u32) -> bool {
        place(number).is_some() || self.parameters.has_value(number)
    }

    fn value(&mut self, parameter: &Parameter) -> Option<f64> {
        match parameter {
            Parameter::Numbered(number) => match place(*number) {
                Some(place) => self.state(&place),
                None if *number == INPUT => Some(self.look_at_input()),
                None => self.parameters.get(parameter),
            },
            Parameter::Named(name) => match self.parameters.get(parameter) {
                None if name.starts_with('_') => self.system(name),
                value => value,
            },
            Parameter::Siemens(_) => self.parameters.get(parameter),
            Parameter::Variable { name, .. } => match self.parameters.get(parameter) {
                None if name.starts_with('_') => self.system(&name.to_ascii_lowercase()),
                value => value,
            },
        }
    }
}

impl Interpreter {
    /// What conditions may depend on has not changed, nor been looked at, as long as this stays as it is.
    pub(super) fn conditions(&self) -> u64 {
        self.parameters.changes + self.looks
    }

    /// #5399: 0 before any M66. What is read of it depends on what the machine answers.
    fn look_at_input(&mut self) -> f64 {
        let Some((question, value)) = self.input else {
            return self
                .parameters
                .get(&Parameter::Numbered(INPUT))
                .unwrap_or_default();
        };
        self.looks += 1;
        self.branches = true;
        if self.looked.last() != Some(&question) {
            self.looked.push(question);
        }
        value
    }

    fn state(&mut self, place: &Place) -> Option<f64> {
        self.looks += 1;
        Some(match *place {
            Place::Home(index, axis) => self.homes[index][axis],
            Place::LocalOn => f64::from(u8::from(self.offsets.local_on)),
            Place::Local(axis) => self.offsets.local[axis],
            Place::System => self.offsets.active as f64 + 1.0,
            Place::Offset(system, axis) => self.offsets.systems[system].offset[axis],
            Place::Rotation(system) => self.offsets.systems[system].rotation,
            Place::Tool => f64::from(self.tool_numbers[1]),
            Place::ToolLength => self.tools.length_of(self.tool_numbers[1]),
            Place::Here(axis) if self.is_beside(axis) => return None,
            Place::Here(axis) => {
                let place = SourcePosition {
                    line: self.line,
                    column: 1,
                };
                let here = self.programmed(&[axis], place).ok()?[axis];
                if axis < 3 { here / self.modal.unit() } else { here }
            }
        })
    }

    /// Named parameters of the system.
    fn system(&mut self, name: &str) -> Option<f64> {
        self.looks += 1;
        let truth = |holds: bool| Some(f64::from(u8::from(holds)));
        let axes = ["_x", "_y", "_z", "_a", "_b", "_c"];
        if let Some(axis) = axes.iter().position(|own| *own == name) {
            return self.state(&Place::Here(axis));
        }
        match name {
            "_line" => Some(f64::from(self.line)),
            "_feed" => Some(self.modal.written_feed()),
            "_rpm" => Some(self.spindle.speed()),
            "_metric" => truth(!self.modal.inches),
            "_imperial" => truth(self.modal.inches),
            "_absolute" => truth(!self.modal.incremental),
            "_incremental" => truth(self.modal.incremental),
            "_inverse_time" => truth(self.modal.inverse_time()),
            "_units_per_minute" => truth(!self.modal.inverse_time() && !self.modal.per_revolution()),
            "_units_per_rev" => truth(self.modal.per_revolution()),
            "_ijk_absolute_mode" => truth(self.modal.absolute_centres),
            "_spindle_on" => truth(self.spindle.turns().is_some()),
            "_current_tool" => Some(f64::from(self.tool_numbers[1])),
            "_selected_tool" => Some(f64::from(self.tool_numbers[0])),
            "_coord_system" => {
                let codes = [540.0, 550.0, 560.0, 570.0, 580.0, 590.0, 591.0, 592.0, 593.0];
                codes.get(self.offsets.active).copied()
            }
            "_plane" => Some(match self.modal.plane.axis() {
                2 => 170.0,
                1 => 180.0,
                _ => 190.0,
            }),
            "_motion_mode" => Some(match self.modal.motion {
                Some(Code::Rapid) => 0.0,
                Some(Code::Feed) => 10.0,
                Some(Code::ArcClockwise) => 20.0,
                Some(Code::ArcCounterClockwise) => 30.0,
                Some(_) => return None,
                None => 800.0,
            }),
            "_task" => Some(0.0),
            _ => None,
        }
    }

    /// Gives a parameter a value, by the program.
    pub(super) fn set(&mut self, parameter: &Parameter, value: f64) -> Result<(), Problem> {
        let Parameter::Numbered(number) = parameter else {
            return self.parameters.set(parameter, value);
        };
        // Some of these are counted once more below.
        self.parameters.changes += 1;
        match place(*number) {
            Some(Place::Home(index, axis)) => self.homes[index][axis] = value,
            Some(Place::LocalOn) => self.offsets.local_on = value != 0.0,
            Some(Place::Local(axis)) => self.offsets.local[axis] = value,
            Some(Place::Offset(system, axis)) => self.offsets.systems[system].offset[axis] = value,
            Some(Place::Rotation(system)) => self.offsets.systems[system].rotation = value,
            Some(Place::System | Place::Tool | Place::ToolLength | Place::Here(_)) => {
                return Err(Problem::ReadOnly(parameter.to_string()));
            }
            None if READ_ONLY.contains(number) || *number == 0 => {
                return Err(Problem::ReadOnly(parameter.to_string()));
            }
            None if *number == ALARM => return Err(Problem::Alarm(value)),
            None if *number == STOP => return Err(Problem::StopByParameter),
            None => self.parameters.set(parameter, value)?,
        }
        Ok(())
    }

    /// What a subroutine returned.
    pub(super) fn set_result(&mut self, value: Option<f64>) {
        let returned = f64::from(u8::from(value.is_some()));
        for (name, value) in [("_value", value.unwrap_or(0.0)), ("_value_returned", returned)] {
            // Named parameters take any value.
            let _ = self.parameters.set(&Parameter::Named(name.to_owned()), value);
        }
    }

    /// `text` with the values of its parameters; what is none stays as it is.
    pub(super) fn with_values(&mut self, text: &str) -> String {
        let mut shown = String::new();
        let mut rest = text;
        while let Some(at) = rest.find('#') {
            shown.push_str(&rest[..at]);
            let mut scanner = Scanner::new(&rest[at + 1..], self.line);
            let parameter = expression::parameter(&mut scanner, self).ok();
            match parameter.and_then(|parameter| self.value(&parameter)) {
                Some(value) => shown.push_str(&format!("{value:.6}")),
                None => {
                    shown.push('#');
                    rest = &rest[at + 1..];
                    continue;
                }
            }
            rest = &rest[at + 1 + scanner.mark()..];
        }
        shown + rest
    }
}
