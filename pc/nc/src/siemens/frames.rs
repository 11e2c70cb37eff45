//! TRANS, ATRANS, ROT and AROT: an offset and a rotation about Z inside the coordinate system that holds.

use crate::block::Block;
use crate::claims::Claims;
use crate::codes::{Code, Group};
use crate::error::{NcError, Problem};
use crate::interpreter::Interpreter;
use crate::offsets::System;
use crate::program::{AXIS_WORDS, Plane};

impl Interpreter {
    /// Carries out the frame word of `block`. TRANS and ROT replace all that was, ATRANS and AROT go on from it; without words TRANS
    /// and ROT end it.
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
        let impossible = |why| Problem::Impossible { code: name, why }.at(place);
        let mut frame = match code {
            Code::Shift | Code::Turn => System::default(),
            _ => self.offsets.frame,
        };
        if matches!(code, Code::Shift | Code::MoreShift) {
            let mut by = [0.0; shared::io::AXES];
            for (axis, value) in self.axis_values(block) {
                by[axis] = value;
            }
            frame.shift(&by);
        } else {
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
            frame.rotation += plane.or(about_z).map_or(0.0, |word| word.value);
        }
        self.offsets.frame = frame;
        Ok(())
    }
}
