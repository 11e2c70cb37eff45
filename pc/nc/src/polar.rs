//! Polar coordinates in the plane X Y: `@` is the distance from the origin of the program, `^` the angle from X \[deg\]; so are X and Y
//! after G16.

use super::block::{Block, Word};
use super::codes::{Code, Group};
use super::error::{NcError, Problem};
use super::interpreter::Interpreter;
use super::program::Plane;
use std::borrow::Cow;

impl Interpreter {
    /// The block with X and Y in place of polar coordinates. One that is not said stays as it is; with G91 both are
    /// steps.
    pub(super) fn without_polar<'b>(&mut self, block: &'b Block) -> Result<Cow<'b, Block>, NcError> {
        let block = self.with_polar(block)?;
        let [distance, angle] = ["@", "^"].map(|name| block.word(name));
        let Some(place) = distance.or(angle).map(|word| word.place) else {
            return Ok(block);
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
        let mut block = block.into_owned();
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
                distance: None,
                place,
            });
        }
        Ok(Cow::Owned(block))
    }

    /// The block with `@` and `^` in place of X and Y, where G16 holds.
    fn with_polar<'b>(&self, block: &'b Block) -> Result<Cow<'b, Block>, NcError> {
        let holds = block.has(Code::Polar) || self.modal.polar && !block.has(Code::PolarOff);
        let others = block.codes.iter().any(|code| code.code.takes_axes());
        let words = ["X", "Y"].map(|name| block.word(name));
        let Some(place) = words.into_iter().flatten().map(|word| word.place).next() else {
            return Ok(Cow::Borrowed(block));
        };
        if !holds || others || block.has(Code::MachineAxes) {
            return Ok(Cow::Borrowed(block));
        }
        let wrong = |why| Err(Problem::Impossible { code: "G16", why }.at(place));
        let plane = match block.code(Group::Plane) {
            Some(code) => code.code == Code::PlaneXy,
            None => self.modal.plane == Plane::Xy,
        };
        if !plane {
            return wrong("polar coordinates are in the XY plane: select it with G17");
        }
        let steps = block.has(Code::Incremental) || self.modal.incremental && !block.has(Code::Absolute);
        if steps && words[0].is_some() {
            return wrong("a distance is from the origin, and no step: write it with G90");
        }
        let mut block = block.clone();
        for word in &mut block.words {
            match word.address.as_str() {
                "X" => word.address = "@".to_owned(),
                "Y" => word.address = "^".to_owned(),
                _ => {}
            }
        }
        Ok(Cow::Owned(block))
    }
}
