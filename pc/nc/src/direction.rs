//! Directions of the tool as vectors: `A3= B3= C3=` of any block with A B C, and I J K of straight motions after G43.5.
//!
//! The vector leads from the tip to the machine, in coordinates of the program; its length says nothing, and what is not said
//! of it is 0. The kinematics of the machine make rotary axes of it.

use super::block::{Block, Word};
use super::claims::{Claims, VECTOR_LETTERS};
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::offsets::Coordinates;
use super::program::{AXIS_WORDS, Words};
use shared::io::AXES;

/// Components along X Y Z.
pub(super) const DIRECTION_WORDS: [&str; 3] = ["A3", "B3", "C3"];
/// Of these a message shows so many parts of 1.
const SHOWN: f64 = 1e6;

impl Interpreter {
    /// The direction that `block` with a motion of `mode` says, a unit vector in the frame of the tip, and where.
    pub(super) fn direction(
        &self,
        block: &Block,
        claims: &Claims,
        mode: Code,
    ) -> Result<Option<([f64; 3], SourcePosition)>, NcError> {
        let named = DIRECTION_WORDS.map(|name| block.word(name));
        let straight = matches!(mode, Code::Rapid | Code::Feed);
        let letters = VECTOR_LETTERS.map(|name| claims.word(mode, name).filter(|_| straight));
        let first = |words: &[Option<&Word>; 3]| words.iter().flatten().next().map(|word| word.place);
        let (words, place) = match (first(&named), first(&letters)) {
            (None, None) => return Ok(None),
            (Some(place), None) => (named, place),
            (None, Some(place)) => (letters, place),
            (Some(place), Some(_)) => {
                return Err(impossible("it is said by I J K too: leave one out", place));
            }
        };
        if !(straight || matches!(mode, Code::ArcClockwise | Code::ArcCounterClockwise)) {
            let why = "it is possible with G0, G1, G2 and G3 only: write A B C, or a block of its own";
            return Err(impossible(why, place));
        }
        if AXIS_WORDS[3..].iter().any(|name| block.word(name).is_some()) {
            let why = "it says where the rotary axes go: leave A B C out";
            return Err(impossible(why, place));
        }
        let [x, y, z] = words.map(|word| word.map_or(0.0, |word| word.value));
        let length = x.hypot(y).hypot(z);
        if length == 0.0 {
            return Err(Problem::NoDirection.at(place));
        }
        let direction = self.offsets.direction([x, y, z]);
        Ok(Some((direction.map(|part| part / length), place)))
    }

    /// Puts the rotary axes with which the tool points along `direction` at the end of a motion into its `words`.
    pub(super) fn point(
        &mut self,
        words: &mut Words,
        direction: [f64; 3],
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let Some(kinematics) = self.setup.kinematics.clone() else {
            return Err(impossible("it needs the kinematics of a machine", place));
        };
        let fitted = self.setup.fitted;
        let open: Vec<usize> = (0..AXES)
            .filter(|axis| words.axes[*axis].is_none() && (*axis < 3 || fitted[*axis]))
            .collect();
        let at = self.position(&open, place)?;
        let end: Coordinates = std::array::from_fn(|axis| words.axes[axis].unwrap_or(at[axis]));
        let angles = kinematics
            .pointing(&self.retracted(&end, direction), direction)
            .map_err(|why| {
                let direction = direction.map(|part| (part * SHOWN).round() / SHOWN);
                Problem::Unreachable { direction, why }.at(place)
            })?;
        for (axis, angle) in (3..AXES).zip(angles).filter(|(axis, _)| fitted[*axis]) {
            words.axes[axis] = Some(angle);
        }
        Ok(())
    }
}

fn impossible(why: &'static str, place: SourcePosition) -> NcError {
    let code = "the direction of the tool";
    Problem::Impossible { code, why }.at(place)
}
