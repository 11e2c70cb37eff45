//! Polar coordinates of Siemens programs: RP= is the distance from the pole, AP= the angle in the plane \[deg\]. G110, G111 and
//! G112 set the pole, which is the origin at the start.

use crate::arc::CENTRE_WORDS;
use crate::block::{Block, Distance, Word};
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::program::AXIS_WORDS;
use std::borrow::Cow;

/// Words of a centre or radius: with one of them the pole is not the centre of an arc.
const FORM_WORDS: [&str; 6] = ["I", "J", "K", "R", "CR", "AR"];

impl Interpreter {
    /// The block with axis words in place of AP= and RP=. One that is not said stays as it is.
    pub(crate) fn without_pole<'b>(&mut self, block: Cow<'b, Block>) -> Result<Cow<'b, Block>, NcError> {
        let is_polar = |word: &&Word| matches!(word.address.as_str(), "RP" | "AP");
        let Some(place) = block.words.iter().find(is_polar).map(|word| word.place) else {
            return Ok(block);
        };
        let [distance, angle] = ["RP", "AP"].map(|name| block.word(name));
        let axes = self.modal.plane.axes();
        if let Some(word) = axes.iter().find_map(|axis| block.word(AXIS_WORDS[*axis])) {
            let (first, second) = ("AP= or RP=", "axis words of the plane");
            return Err(Problem::ModalGroup { first, second }.at(word.place));
        }
        let unit = self.modal.unit();
        let [a, b] = axes;
        let now = self.programmed(&[a.min(b), a.max(b)], place)?;
        let from = axes.map(|axis| now[axis] - self.pole[axis]);
        let polar = [from[0].hypot(from[1]), from[1].atan2(from[0]).to_degrees()];
        let all_steps = match block.code(Group::Distance) {
            Some(code) => code.code == Code::Incremental,
            None => self.modal.incremental,
        };
        let value = |word: Option<&Word>, now: f64, unit: f64| match word {
            Some(word) if word.distance.map_or(all_steps, Distance::is_step) => now + word.value * unit,
            Some(word) => word.value * unit,
            None => now,
        };
        let to = value(distance, polar[0], unit);
        if to < 0.0 {
            let why = "the distance from the pole must not be negative";
            return Err(distance.map_or(Problem::NoValue.at(place), |word| word.value_error(why)));
        }
        let (sin, cos) = value(angle, polar[1], 1.0).to_radians().sin_cos();
        let ends = [to * cos, to * sin];
        let arc = block
            .code(Group::Motion)
            .map_or(self.modal.motion, |code| Some(code.code))
            .is_some_and(|code| matches!(code, Code::ArcClockwise | Code::ArcCounterClockwise));
        let about_pole = arc && FORM_WORDS.iter().all(|name| block.word(name).is_none());
        let mut block = block.into_owned();
        block
            .words
            .retain(|word| word.address != "AP" && word.address != "RP");
        let mut push = |address: &str, value: f64, step: bool| {
            block.words.push(Word {
                address: address.to_owned(),
                value: value / unit,
                named: false,
                distance: Some(if step { Distance::Step } else { Distance::Absolute }),
                place,
            });
        };
        for (axis, end) in axes.into_iter().zip(ends) {
            push(AXIS_WORDS[axis], self.pole[axis] + end, false);
            if about_pole {
                push(CENTRE_WORDS[axis], self.pole[axis] - now[axis], true);
            }
        }
        Ok(Cow::Owned(block))
    }

    /// G110, G111, G112: the pole by steps from where the tip is, as coordinates, by steps from the last pole.
    pub(crate) fn set_pole(
        &mut self,
        block: &Block,
        code: Code,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        for axis in 0..3 {
            let Some(word) = block.word(AXIS_WORDS[axis]) else {
                continue;
            };
            let from = match code {
                Code::PoleFromTip => self.programmed(&[axis], place)?[axis],
                Code::PoleFromPole => self.pole[axis],
                _ => 0.0,
            };
            self.pole[axis] = from + word.value * self.modal.unit();
        }
        Ok(())
    }
}
