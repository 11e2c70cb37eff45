//! Mirrors and rotations of other controllers: G51.1 and G50.1 (Fanuc), G101 and G100 (Haas), G68 and G69. They are carried out as a
//! frame, as those of Siemens programs.

use super::block::Block;
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::frame::Frame;
use super::interpreter::Interpreter;
use super::program::{AXIS_WORDS, Plane};
use shared::io::AXES;

/// What of these holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Foreign {
    /// Where X, Y and Z are mirrored, in the coordinate system \[mm\].
    mirrored: [Option<f64>; 3],
    /// G68 holds.
    rotated: bool,
    /// The next motion in X or Y must say both, as coordinates: where controllers have the other one after a rotation, they do not agree.
    says_both: bool,
}

impl Foreign {
    fn mirrors(&self) -> bool {
        self.mirrored.iter().any(Option::is_some)
    }

    /// Whether any of them holds.
    pub(super) fn holds(&self) -> bool {
        self.mirrors() || self.rotated
    }

    /// X to 2a − X for each mirrored axis.
    fn mirror(&self) -> Frame {
        let mut frame = Frame::default();
        if self.mirrors() {
            let mut by = [0.0; AXES];
            for (by, at) in by.iter_mut().zip(self.mirrored) {
                *by = 2.0 * at.unwrap_or(0.0);
            }
            frame.shift(&by);
            frame.stretch(self.mirrored.map(|at| if at.is_some() { -1.0 } else { 1.0 }));
        }
        frame
    }
}

impl Interpreter {
    /// Carries out G51.1, G101, G50.1, G100 or G68.
    pub(super) fn foreign_frame(
        &mut self,
        block: &Block,
        claims: &Claims,
        (code, name): (Code, &'static str),
        place: SourcePosition,
    ) -> Result<(), NcError> {
        let impossible = |why, place| Err(Problem::Impossible { code: name, why }.at(place));
        let foreign = self.offsets.foreign;
        let ends = code == Code::MirrorNoMore;
        self.check_no_tilt(name, place)?;
        if self.offsets.has_frame() && !foreign.holds() {
            return match ends {
                true => impossible(
                    "TRANS, ROT, MIRROR or SCALE hold, which it does not end: write TRANS alone",
                    place,
                ),
                false => impossible(
                    "TRANS, ROT, MIRROR or SCALE hold: end them first by TRANS alone",
                    place,
                ),
            };
        }
        if let Some(word) = AXIS_WORDS[3..].iter().find_map(|axis| block.word(axis)) {
            return impossible("it is for X, Y and Z only", word.place);
        }
        if code == Code::TurnAbout {
            return self.turn_about(block, claims, place);
        }
        if foreign.rotated {
            return impossible("a rotation holds: end it first by G69", place);
        }
        if ends && !foreign.mirrors() {
            self.tell_once(format!("{name} changes nothing: nothing is mirrored"), place);
            return Ok(());
        }
        let unit = self.modal.unit();
        let incremental = self.modal.incremental;
        let mirrored = &mut self.offsets.foreign.mirrored;
        let mut any = false;
        for (axis, at) in mirrored.iter_mut().enumerate() {
            let Some(word) = block.word(AXIS_WORDS[axis]) else {
                continue;
            };
            any = true;
            if ends {
                *at = None;
                continue;
            }
            if word.value != 0.0 && name == "G101" {
                return impossible("it mirrors about the zero point: write 0", word.place);
            }
            if word.value != 0.0 && incremental {
                return impossible(
                    "the place of the mirror is a coordinate: write it with G90",
                    word.place,
                );
            }
            *at = Some(word.value * unit);
        }
        match (any, ends) {
            (false, true) => *mirrored = [None; 3],
            (false, false) => {
                let (code, word) = (name, "X, Y or Z");
                return Err(Problem::Missing { code, word }.at(place));
            }
            _ => {}
        }
        self.offsets.frame = self.offsets.foreign.mirror();
        self.check_weld_as_it_is(name, place)
    }

    /// G68 with the centre X Y and the angle R, in the plane X Y.
    fn turn_about(&mut self, block: &Block, claims: &Claims, place: SourcePosition) -> Result<(), NcError> {
        let impossible = |why| Err(Problem::Impossible { code: "G68", why }.at(place));
        if self.offsets.foreign.mirrors() {
            return impossible(
                "a mirror holds, and controllers do not agree on the order of the two: end it first by G50.1",
            );
        }
        if self.modal.plane != Plane::Xy || block.word("Z").is_some() {
            return impossible(
                "it turns about Z only: select the plane with G17, and write X and Y of the centre",
            );
        }
        if self.modal.incremental {
            return impossible("its angle and centre may be steps or not with G91: write it with G90");
        }
        let (Some(x), Some(y), Some(r)) = (
            block.word("X"),
            block.word("Y"),
            claims.word(Code::TurnAbout, "R"),
        ) else {
            return impossible(
                "write the centre X Y and the angle R, as controllers take others for those that are missing",
            );
        };
        let unit = self.modal.unit();
        let centre = [x.value * unit, y.value * unit, 0.0, 0.0, 0.0, 0.0];
        let mut frame = Frame::default();
        frame.shift(&centre);
        frame.turn(2, r.value);
        frame.shift(&centre.map(|value| -value));
        self.offsets.frame = frame;
        let foreign = &mut self.offsets.foreign;
        (foreign.rotated, foreign.says_both) = (true, true);
        Ok(())
    }

    /// G69; whether there was something to end.
    pub(super) fn end_rotation(&mut self) -> bool {
        let foreign = &mut self.offsets.foreign;
        if !std::mem::take(&mut foreign.rotated) {
            return false;
        }
        foreign.says_both = true;
        self.offsets.frame = Frame::default();
        self.spline_end = None;
        true
    }

    /// Refuses one of X and Y behind a rotation that began or ended.
    pub(super) fn check_both_said(&mut self, block: &Block) -> Result<(), NcError> {
        let words = ["X", "Y"].map(|axis| block.word(axis));
        let Some(word) = words.iter().flatten().next() else {
            return Ok(());
        };
        if !std::mem::take(&mut self.offsets.foreign.says_both) {
            return Ok(());
        }
        let both = words
            .iter()
            .all(|word| word.is_some_and(|word| word.distance.is_none()));
        if both && !self.modal.incremental {
            return Ok(());
        }
        let why = "the first motion after G68 or G69 says X and Y, with G90: controllers do not agree on where the other one is";
        Err(Problem::Impossible { code: "G68", why }.at(word.place))
    }

    /// Refuses what other controllers do not allow while these hold.
    pub(super) fn check_no_foreign(&self, code: &'static str, place: SourcePosition) -> Result<(), NcError> {
        let why = "G51.1, G101 or G68 holds: end it first by G50.1, G100 or G69";
        match self.offsets.foreign.holds() {
            true => Err(Problem::Impossible { code, why }.at(place)),
            false => Ok(()),
        }
    }

    /// Refuses another coordinate system while these hold.
    pub(super) fn check_same_system(&self, block: &Block, index: usize) -> Result<(), NcError> {
        match block.code(Group::Offset) {
            Some(code) if index != self.offsets.active => {
                self.check_no_foreign(code.name, code.place)?;
                self.check_no_fanuc_tilt(code.name, code.place)
            }
            _ => Ok(()),
        }
    }
}
