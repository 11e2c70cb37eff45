//! TRANS, ROT, MIRROR, SCALE and those with A before them: the frame inside the coordinate system that holds.

use crate::block::Block;
use crate::claims::Claims;
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem, SourcePosition};
use crate::frame::Frame;
use crate::interpreter::Interpreter;
use crate::program::{AXIS_WORDS, Plane};

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
            Code::Shift | Code::Turn | Code::Mirror | Code::Scale => Frame::default(),
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
            Code::Turn | Code::MoreTurn => frame.turn(self.rotation(block, claims, (code, name), place)?),
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

    /// By how much ROT or AROT turns about Z \[deg\].
    fn rotation(
        &self,
        block: &Block,
        claims: &Claims,
        (code, name): (Code, &'static str),
        place: SourcePosition,
    ) -> Result<f64, NcError> {
        let impossible = |why| Problem::Impossible { code: name, why }.at(place);
        let plane = claims.word(code, "RPL");
        if plane.is_some() && self.modal.plane != Plane::Xy {
            return Err(impossible("RPL= turns about Z only: select the plane with G17"));
        }
        let aside = AXIS_WORDS.iter().filter(|axis| **axis != "Z");
        if aside
            .filter_map(|axis| block.word(axis))
            .any(|word| word.value != 0.0)
        {
            return Err(impossible("a tilted plane is not supported: rotate about Z"));
        }
        let about_z = block.word("Z");
        if plane.is_some() && about_z.is_some() {
            return Err(impossible("it turns by RPL= or by Z, not both"));
        }
        Ok(plane.or(about_z).map_or(0.0, |word| word.value))
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
        let corner = CORNERS.iter().find_map(|name| block.word(name));
        let corner = corner.map(|word| word.place);
        let corner = corner.or(self.corners.rounds().then_some(place));
        let of_its_length = frame
            .of_arcs()
            .is_some_and(|(factor, _)| (factor - 1.0).abs() < 1e-12);
        if let Some(place) = corner
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
