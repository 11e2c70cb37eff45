//! Polar coordinates in the plane X Y: `@` is the distance from the origin of the program, `^` the angle from X \[deg\].

use super::block::{Block, Word};
use super::codes::Code;
use super::error::{NcError, Problem};
use super::interpreter::Interpreter;
use std::borrow::Cow;

impl Interpreter {
    /// The block with X and Y in place of polar coordinates. One that is not said stays as it is; with G91 both are
    /// steps.
    pub(super) fn without_polar<'b>(&mut self, block: &'b Block) -> Result<Cow<'b, Block>, NcError> {
        let [distance, angle] = ["@", "^"].map(|name| block.word(name));
        let Some(place) = distance.or(angle).map(|word| word.place) else {
            return Ok(Cow::Borrowed(block));
        };
        if let Some(word) = ["X", "Y"].iter().find_map(|name| block.word(name)) {
            let (first, second) = ("@", "X and Y");
            return Err(Problem::ModalGroup { first, second }.at(word.place));
        }
        let unit = self.modal.unit();
        let now = self.programmed(&[0, 1], place)?;
        let steps = block.has(Code::Incremental) || (self.modal.incremental && !block.has(Code::Absolute));
        let polar = [now[0].hypot(now[1]), now[1].atan2(now[0]).to_degrees()];
        let value = |word: Option<&Word>, now: f64, unit: f64| match word {
            Some(word) if steps => now + word.value * unit,
            Some(word) => word.value * unit,
            None => now,
        };
        let distance = value(distance, polar[0], unit);
        let angle = value(angle, polar[1], 1.0);
        let (sin, cos) = angle.to_radians().sin_cos();
        let mut block = block.clone();
        block.polar_step = steps.then(|| [distance - polar[0], angle - polar[1]]);
        block
            .words
            .retain(|word| !["@", "^"].contains(&word.address.as_str()));
        for (axis, (name, to)) in [("X", distance * cos), ("Y", distance * sin)]
            .into_iter()
            .enumerate()
        {
            let from = if steps { now[axis] } else { 0.0 };
            block.words.push(Word {
                address: name.to_owned(),
                value: (to - from) / unit,
                named: false,
                step: None,
                place,
            });
        }
        Ok(Cow::Owned(block))
    }
}
