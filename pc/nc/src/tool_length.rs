//! Length of the tool in use: G43, G43.1, G43.2, G49, and the table of tools by G10 L1, L10 and L11.
//!
//! Coordinates of the program, and all that is kept of where the tip is, are those of the end of the tool in use. Motions say where
//! the tip of the machine file goes: farther towards the machine by the length, along the tool.

use super::block::{Block, CodeWord, Word};
use super::claims::Claims;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::offsets::Coordinates;
use super::program::{AXIS_WORDS, Way, Words};
use super::setup::Tool;
use shared::io::AXES;
use std::collections::BTreeMap;

/// Axis of lengths.
const Z: usize = 2;
/// Number of the first tool that is called by another name.
const FIRST_NAMED: u32 = 1_000_001;
/// Directions that differ by less are one.
const SAME: f64 = 1e-9;
/// Index of G59.3, in which L11 measures.
const FIXTURE: usize = 8;

/// The table, and what of it holds.
#[derive(Clone, Debug, Default)]
pub(super) struct Tools {
    table: BTreeMap<u32, Tool>,
    /// The one in use \[mm\].
    pub(super) length: f64,
    /// A B C where the last motion led \[deg\].
    angles: [f64; 3],
}

impl Tools {
    pub(super) fn new(table: &BTreeMap<u32, Tool>) -> Self {
        Self {
            table: table.clone(),
            ..Self::default()
        }
    }

    /// That of a tool, 0 if it is not in the table \[mm\].
    pub(super) fn length_of(&self, number: u32) -> f64 {
        self.table.get(&number).map_or(0.0, |tool| tool.length_mm)
    }

    /// That of a tool of the table \[mm\].
    pub(super) fn diameter_of(&self, number: u32) -> Option<f64> {
        self.table.get(&number).map(|tool| tool.diameter_mm)
    }
}

impl Interpreter {
    /// G43 and the others of its group.
    pub(super) fn tool_length(
        &mut self,
        block: &Block,
        claims: &Claims,
        code: CodeWord,
    ) -> Result<(), NcError> {
        let place = code.place;
        let h = claims.word(code.code, "H").map(|h| Ok((tool(h)?, h.place)));
        let h = h.transpose()?;
        let length = match (code.code, h) {
            (Code::TipOff, _) => 0.0,
            (Code::OwnLength, _) => match self.length_words(block)? {
                Some(length) => length,
                None => return Err(missing(code.name, "Z", place)),
            },
            (Code::MoreLength, None) => return Err(missing(code.name, "H", place)),
            (Code::MoreLength, Some((number, place))) => self.tools.length + self.length_of(number, place)?,
            (_, Some((number, place))) => self.length_of(number, place)?,
            (Code::ToolLength, None) => self.tools.length_of(self.tool_numbers[1]),
            _ => return Ok(()),
        };
        self.use_length(length, place)
    }

    /// The number that stands for the tool `name`: itself if it is a number, else one of those that no table has.
    pub(super) fn tool_of_name(&mut self, name: &str, place: SourcePosition) -> u32 {
        if let Ok(number) = name.parse() {
            return number;
        }
        let known = self.tool_names.iter().position(|known| known == name);
        let index = known.unwrap_or(self.tool_names.len());
        let number = FIRST_NAMED + index as u32;
        if known.is_none() {
            self.tool_names.push(name.to_owned());
            let text = format!(
                "tool {name} has the number {number} here: the machine file knows tools by their numbers"
            );
            self.notice(text, place);
        }
        number
    }

    /// The name that a tool was called by.
    pub(super) fn name_of_tool(&self, number: u32) -> Option<&str> {
        let index = number.checked_sub(FIRST_NAMED)?;
        self.tool_names.get(index as usize).map(String::as_str)
    }

    /// The length of a tool of the table; without a table every tool ends at the tip of the machine file.
    fn length_of(&mut self, number: u32, place: SourcePosition) -> Result<f64, NcError> {
        match self.tools.table.get(&number) {
            _ if number == 0 => Ok(0.0),
            Some(tool) => Ok(tool.length_mm),
            None if self.setup.tools.is_empty() => {
                let text =
                    format!("H{number} changes nothing: the tip is that of the tool in the machine file");
                self.notice(text, place);
                Ok(0.0)
            }
            None => Err(Problem::NoTool(number).at(place)),
        }
    }

    /// Z of G43.1 or G10 L1 \[mm\]; the end of a tool is on the line that the tip of the machine file is on.
    fn length_words(&self, block: &Block) -> Result<Option<f64>, NcError> {
        let aside = AXIS_WORDS.iter().enumerate().filter(|(axis, _)| *axis != Z);
        let aside = aside
            .filter_map(|(_, name)| block.word(name))
            .find(|word| word.value != 0.0);
        if let Some(word) = aside {
            return Err(
                word.value_error("tools have a length along Z only, as their end is in line with the tip")
            );
        }
        Ok(block
            .word(AXIS_WORDS[Z])
            .map(|word| word.value * self.modal.unit()))
    }

    /// Another length is in use: the machine stays where it is, and the end of the tool is elsewhere.
    fn use_length(&mut self, length: f64, place: SourcePosition) -> Result<(), NcError> {
        let more = length - self.tools.length;
        if more == 0.0 {
            return Ok(());
        }
        if self.known[..3].contains(&true) {
            self.rely_on_angles(place)?;
        }
        let along = self.along(&self.at);
        (0..3).for_each(|axis| self.at[axis] -= more * along[axis]);
        self.tools.length = length;
        self.tools.angles = angles(&self.at);
        self.spline_end = None;
        Ok(())
    }

    /// G10 L1, L10 and L11: the length of tool P.
    pub(super) fn set_tool(
        &mut self,
        block: &Block,
        claims: &Claims,
        [l, p]: [&Word; 2],
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let number = tool(p)?;
        if number == 0 {
            return Err(p.value_error("tools of the table have numbers from 1"));
        }
        if let Some(r) = claims.word(Code::SetOffsets, "R") {
            let diameter = 2.0 * r.value * self.modal.unit();
            self.tools.table.entry(number).or_default().diameter_mm = diameter;
        }
        let Some(z) = self.length_words(block)? else {
            self.tools.table.entry(number).or_default();
            return Ok(());
        };
        let length = if l.value == 1.0 {
            z
        } else {
            // With this length the end of the tool, the machine standing here, is at Z.
            self.rely_on_angles(place)?;
            let at = self.position(&[Z], place)?;
            if (self.along(&at)[Z] - 1.0).abs() > SAME {
                let (code, why) = ("G10 L10 and L11", "the tool must be upright where it is measured");
                return Err(Problem::Impossible { code, why }.at(place));
            }
            // L11 measures in the fixture, in which no local offset holds.
            let systems = &self.offsets.systems;
            let zero = if l.value == 10.0 {
                systems[self.offsets.active].offset[Z] + self.offsets.local_now()[Z]
            } else {
                systems[FIXTURE].offset[Z]
            };
            at[Z] + self.tools.length - zero - z
        };
        self.tools.table.entry(number).or_default().length_mm = length;
        Ok(())
    }

    /// Where the tip of the machine file is, the end of the tool being at `at`.
    pub(super) fn tip_of_machine(&self, at: &Coordinates) -> Coordinates {
        let along = self.along(at);
        self.retracted(at, along)
    }

    /// Where the end of the tool is, the tip of the machine file being at `tip`.
    pub(super) fn end_of_tool(&self, tip: &Coordinates) -> Coordinates {
        let along = self.along(tip);
        self.moved(tip, along, -self.tools.length)
    }

    /// `at` by the length towards the machine along a direction that its A B C do not have yet.
    pub(super) fn retracted(&self, at: &Coordinates, along: [f64; 3]) -> Coordinates {
        self.moved(at, along, self.tools.length)
    }

    fn moved(&self, at: &Coordinates, along: [f64; 3], by: f64) -> Coordinates {
        let mut moved = *at;
        (0..3).for_each(|axis| moved[axis] += by * along[axis]);
        moved
    }

    /// Makes of a motion of the end of the tool, which is known by now, one of the tip of the machine file.
    pub(super) fn retract(
        &mut self,
        way: &mut Way,
        words: &mut Words,
        place: SourcePosition,
        feeds: bool,
    ) -> Result<(), NcError> {
        let length = self.tools.length;
        if length == 0.0 {
            return Ok(());
        }
        self.rely_on_angles(place)?;
        let before = std::mem::replace(&mut self.tools.angles, angles(&self.at));
        if feeds && self.swings(before) {
            let (code, why) = (
                "the length of the tool",
                "while it feeds the tool must not turn, but about itself: make it the tip of the machine file, or turn with G0",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        let along = self.along(&self.at);
        let along_before = self.direction_at(before);
        for axis in 0..3 {
            if words.axes[axis].is_none() {
                if (along[axis] - along_before[axis]).abs() < SAME {
                    continue;
                }
                self.position(&[axis], place)?;
            }
            words.axes[axis] = Some(self.at[axis] + length * along[axis]);
        }
        if let Way::Nurbs(way) = way {
            for point in &mut way.points {
                for (value, along) in point.position.iter_mut().zip(along) {
                    *value = value.map(|value| value + length * along);
                }
            }
        }
        Ok(())
    }

    /// Whether the tool points elsewhere on the way from A B C: an axis goes that it is not in line with.
    fn swings(&self, from: [f64; 3]) -> bool {
        let to = angles(&self.at);
        let along = self.direction_at(from);
        (0..3).filter(|axis| from[*axis] != to[*axis]).any(|axis| {
            let mut quarter = from;
            quarter[axis] += 90.0;
            let other = self.direction_at(quarter);
            (0..3).any(|i| (other[i] - along[i]).abs() > SAME)
        })
    }

    /// The program relies on how its rotary axes stand, as far as it has not said that.
    fn rely_on_angles(&mut self, place: SourcePosition) -> Result<(), NcError> {
        let fitted = self.setup.fitted;
        let rotary: Vec<usize> = (3..AXES).filter(|axis| fitted[*axis]).collect();
        self.position(&rotary, place).map(|_| ())
    }

    /// From the tip to the machine, along the tool.
    pub(super) fn along(&self, at: &Coordinates) -> [f64; 3] {
        self.direction_at(angles(at))
    }

    fn direction_at(&self, angles: [f64; 3]) -> [f64; 3] {
        let kinematics = self.setup.kinematics.as_ref();
        kinematics.map_or([0.0, 0.0, 1.0], |kinematics| kinematics.direction(angles))
    }
}

fn angles(at: &Coordinates) -> [f64; 3] {
    [at[3], at[4], at[5]]
}

fn missing(code: &'static str, word: &'static str, place: SourcePosition) -> NcError {
    Problem::Missing { code, word }.at(place)
}

/// Number of a tool.
pub(super) fn tool(word: &Word) -> Result<u32, NcError> {
    if word.value < 0.0 || word.value.fract() != 0.0 || word.value > f64::from(u32::MAX) {
        return Err(word.value_error("tools have whole numbers from 0"));
    }
    Ok(word.value as u32)
}
