//! TRANS, ROT, MIRROR, SCALE and those with A before them: the frame inside the coordinate system that holds, or inside a tilted plane.

use crate::block::Block;
use crate::claims::Claims;
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::program::AXIS_WORDS;

/// Words of the rotary axes, and of directions of the tool.
const OF_THE_TOOL: [&str; 6] = ["A", "B", "C", "A3", "B3", "C3"];
/// Words of corners, which have a length.
const CORNERS: [&str; 4] = ["RND", "RNDM", "CHF", "CHR"];

impl Interpreter {
    /// Carries out the frame word of `block`. Those without A replace all that was, and alone they end it; the others go on from it.
    pub(crate) fn frame(
        &mut self,
        block: &Block,
        claims: &Claims,
        code: Code,
        name: &'static str,
    ) -> Result<(), NcError> {
        let Some(place) = block.code(Group::NonModal).map(|code| code.place) else {
            return Ok(());
        };
        let mut frame = match code {
            Code::Shift | Code::Turn | Code::Mirror | Code::Scale => self.offsets.base(),
            _ => self.offsets.frame,
        };
        match code {
            Code::Shift | Code::MoreShift => {
                let mut by = [0.0; shared::io::AXES];
                for (axis, value) in self.axis_values(block) {
                    by[axis] = value;
                }
                frame.shift(&by);
            }
            Code::Turn | Code::MoreTurn => {
                for (axis, degrees) in self.rotations(block, claims, (code, name), place)? {
                    frame.turn(axis, degrees);
                }
            }
            _ => {
                if let Some(factors) = factors(block, matches!(code, Code::Mirror | Code::MoreMirror), name)?
                {
                    frame.stretch(factors);
                }
            }
        }
        self.offsets.frame = frame;
        self.check_weld_as_it_is(name, place)
    }

    /// The rotations of ROT or AROT, axes and degrees in the order of the controller: about Z, about Y as it is then, and about X.
    fn rotations(
        &self,
        block: &Block,
        claims: &Claims,
        (code, name): (Code, &'static str),
        place: SourcePosition,
    ) -> Result<Vec<(usize, f64)>, NcError> {
        let impossible = |why, place| Err(Problem::Impossible { code: name, why }.at(place));
        let words = AXIS_WORDS.iter().enumerate();
        let words = words.filter_map(|(axis, name)| block.word(name).map(|word| (axis, word)));
        let words: Vec<_> = words.collect();
        if let Some((_, word)) = words.iter().find(|(axis, _)| *axis > 2) {
            return impossible("it turns about X, Y and Z, and not with rotary axes", word.place);
        }
        let in_plane = claims.word(code, "RPL");
        if in_plane.is_some() && !words.is_empty() {
            return impossible("it turns by RPL= or about axes, not both", place);
        }
        let in_plane = in_plane.map(|word| (self.modal.plane.axis(), word.value));
        let about = words.into_iter().rev().map(|(axis, word)| (axis, word.value));
        Ok(about.chain(in_plane).collect())
    }

    /// Where a corner is to be put in behind the motion of `block`, if it is.
    pub(crate) fn corner_place(&self, block: &Block, place: SourcePosition) -> Option<SourcePosition> {
        let word = CORNERS.iter().find_map(|name| block.word(name));
        word.map(|word| word.place)
            .or(self.corners.rounds().then_some(place))
    }

    /// What MIRROR and SCALE do not reach: the attitude of the tool, levels of cycles along Z, and corners.
    pub(crate) fn check_reshaped(
        &self,
        block: &Block,
        drills: bool,
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let frame = &self.offsets.frame;
        if !frame.reshapes() {
            return Ok(());
        }
        let impossible = |why, place| {
            let code = "MIRROR or SCALE";
            Err(Problem::Impossible { code, why }.at(place))
        };
        if let Some(word) = OF_THE_TOOL.iter().find_map(|name| block.word(name)) {
            return impossible(
                "only X Y Z follow it, the tool does not: leave its rotary axes as they are",
                word.place,
            );
        }
        if drills && !frame.keeps_z() {
            return impossible("cycles need Z as it is: mirror or scale X and Y alone", place);
        }
        let of_its_length = self
            .offsets
            .arcs(self.modal.plane)
            .is_some_and(|arcs| (arcs.factor - 1.0).abs() < 1e-12);
        if let Some(place) = self.corner_place(block, place)
            && !of_its_length
        {
            return impossible(
                "roundings and chamfers are not scaled: write their motions out, and RNDM=0 before",
                place,
            );
        }
        Ok(())
    }
}

/// A factor for X, Y and Z; none without words.
fn factors(block: &Block, mirrors: bool, name: &'static str) -> Result<Option<[f64; 3]>, NcError> {
    let mut factors = [1.0; 3];
    let mut any = false;
    for (axis, letter) in AXIS_WORDS.iter().enumerate() {
        let Some(word) = block.word(letter) else { continue };
        let impossible = |why| Problem::Impossible { code: name, why }.at(word.place);
        let Some(factor) = factors.get_mut(axis) else {
            return Err(impossible("only X, Y and Z are mirrored and scaled"));
        };
        any = true;
        if !mirrors && word.value <= 0.0 {
            return Err(impossible("a factor is above 0"));
        }
        *factor = if mirrors { -1.0 } else { word.value };
    }
    Ok(any.then_some(factors))
}
