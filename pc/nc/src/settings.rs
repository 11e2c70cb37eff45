//! What moves nothing but changes where programmed coordinates are: G10, G28, G30, G52, G54 to G59.3, G92, and tools.

use super::block::{Block, CodeWord};
use super::claims::Claims;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::offsets::{Coordinates, NO_SYSTEM, SYSTEMS, linear};
use super::program::{AXIS_WORDS, Way};
use shared::io::AXES;

impl Interpreter {
    /// Coordinate system and tool length.
    pub(super) fn system_and_tool(&mut self, block: &Block, claims: &Claims) -> Result<(), NcError> {
        if let Some(code) = block.code(Group::Offset)
            && let Code::System(number) = code.code
        {
            let index = usize::from(number) - 1;
            self.check_same_system(block, index)?;
            self.offsets.active = index;
            self.spline_end = None;
        }
        if block.has(Code::NoSystem) {
            self.check_same_system(block, NO_SYSTEM)?;
            self.offsets.active = NO_SYSTEM;
            self.spline_end = None;
        }
        let Some(code) = block.code(Group::ToolLength) else {
            return Ok(());
        };
        self.tool_length(block, claims, *code)
    }

    /// The codes that hold in their block only, but G4 and G53.
    pub(super) fn settings(&mut self, block: &Block, claims: &Claims, code: CodeWord) -> Result<(), NcError> {
        let place = code.place;
        let other_offsets = matches!(code.code, Code::SetOffsets | Code::LocalOffset | Code::OffsetHere);
        if other_offsets {
            self.check_no_foreign(code.name, place)?;
            self.check_no_tilt(code.name, place)?;
        }
        if other_offsets && self.offsets.has_frame() {
            let (code, why) = (
                code.name,
                "TRANS, ROT, MIRROR or SCALE hold: end them first by TRANS alone",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        match code.code {
            Code::Shift
            | Code::MoreShift
            | Code::Turn
            | Code::MoreTurn
            | Code::Mirror
            | Code::MoreMirror
            | Code::Scale
            | Code::MoreScale => {
                self.check_no_foreign(code.name, place)?;
                self.frame(block, claims, code.code, code.name)?;
            }
            Code::Tilt => self.tilt(block, claims, place)?,
            Code::ToolToPlane | Code::ToolToPlaneAtTip => self.turn_tool(claims, code.code, place)?,
            Code::MirrorAxes | Code::MirrorNoMore | Code::TurnAbout => {
                self.foreign_frame(block, claims, (code.code, code.name), place)?;
            }
            Code::Pole | Code::PoleFromTip | Code::PoleFromPole => self.set_pole(block, code.code, place)?,
            Code::SetOffsets => self.set_offsets(block, claims, place)?,
            Code::Home => self.home(block, 0, place)?,
            Code::SecondHome => self.home(block, 1, place)?,
            Code::SetHome => self.homes[0] = self.axes_here(place)?,
            Code::SetSecondHome => self.homes[1] = self.axes_here(place)?,
            Code::LocalOffset => {
                for (axis, value) in self.axis_values(block) {
                    self.offsets.local[axis] = value;
                }
                self.offsets.local_on = true;
            }
            Code::OffsetHere => {
                let values = self.axis_values(block);
                if values.is_empty() {
                    let (code, word) = ("G92", "an axis word");
                    return Err(Problem::Missing { code, word }.at(place));
                }
                let mut local = self.offsets.local_now();
                for (axis, value) in values {
                    let at = self.position(&self.offsets.with_coupled(&[axis]), place)?;
                    local[axis] = self.offsets.in_system(&at)[axis] - value;
                }
                (self.offsets.local, self.offsets.local_on) = (local, true);
            }
            Code::ForgetOffset => (self.offsets.local, self.offsets.local_on) = ([0.0; AXES], false),
            Code::SuspendOffset => self.offsets.local_on = false,
            Code::RestoreOffset => self.offsets.local_on = true,
            _ => {}
        }
        self.spline_end = None;
        Ok(())
    }

    /// Axis words in mm and degrees, as they are written.
    pub(super) fn axis_values(&self, block: &Block) -> Vec<(usize, f64)> {
        let value = |(axis, name): (usize, &&str)| {
            let unit = if axis < 3 { self.modal.unit() } else { 1.0 };
            block.word(name).map(|word| (axis, word.value * unit))
        };
        AXIS_WORDS.iter().enumerate().filter_map(value).collect()
    }

    /// G10.
    fn set_offsets(&mut self, block: &Block, claims: &Claims, place: SourcePosition) -> Result<(), NcError> {
        let code = Code::SetOffsets;
        let need = |word: &'static str| {
            let missing = Problem::Missing { code: "G10", word };
            claims.word(code, word).ok_or(missing.at(place))
        };
        let (l, p) = (need("L")?, need("P")?);
        let here = match l.value {
            2.0 => false,
            20.0 => true,
            1.0 | 10.0 | 11.0 => return self.set_tool(block, claims, [l, p], place),
            _ => {
                return Err(
                    l.value_error("L2 and L20 set coordinate systems, L1, L10 and L11 lengths of tools")
                );
            }
        };
        let index = match p.number_below(SYSTEMS as u8 + 1) {
            Some(0) if self.offsets.active == NO_SYSTEM => {
                return Err(p.value_error("with G500 no coordinate system holds: write its number"));
            }
            Some(0) => self.offsets.active,
            Some(number) => usize::from(number) - 1,
            None => {
                return Err(p.value_error(
                    "coordinate systems are 1 (G54) to 9 (G59.3), and 0 is the one that holds",
                ));
            }
        };
        if let Some(r) = claims.word(code, "R") {
            self.offsets.systems[index].rotation = r.value;
        }
        let values = self.axis_values(block);
        if !here {
            for (axis, value) in values {
                self.offsets.systems[index].offset[axis] = value;
            }
            return Ok(());
        }
        // The tip gets these coordinates in the system, whichever one holds.
        let axes: Vec<usize> = values.iter().map(|(axis, _)| *axis).collect();
        let at = match self.offsets.systems[index].rotation != 0.0 {
            true => self.position(&[0, 1, 2], place)?,
            false => self.position(&axes, place)?,
        };
        let local = self.offsets.local_now();
        let active = std::mem::replace(&mut self.offsets.active, index);
        let mut wanted = self.offsets.to_programmed(&at);
        for (axis, value) in values {
            wanted[axis] = value;
        }
        let mut moved: Coordinates = std::array::from_fn(|i| wanted[i] + local[i]);
        let turned = self.offsets.direction(linear(&moved));
        moved[..3].copy_from_slice(&turned);
        let coupled = self.offsets.coupled();
        for axis in 0..AXES {
            if axes.contains(&axis) || coupled.contains(&axis) {
                self.offsets.systems[index].offset[axis] = at[axis] - moved[axis];
            }
        }
        self.offsets.active = active;
        Ok(())
    }

    /// G28 and G30: by way of the place that axis words say, if there are any, to the home of these axes or of all.
    fn home(&mut self, block: &Block, index: usize, place: SourcePosition) -> Result<(), NcError> {
        self.check_come_back("G28 and G30", place)?;
        let said = self.said(block)?;
        if self.offsets.says_in_part(&said) {
            let code = if index == 0 { "G28" } else { "G30" };
            let why = "a part of the axes in a rotated coordinate system is read differently by controllers: write X and Y, in a tilted plane Z too, or end the rotation";
            return Err(Problem::Impossible { code, why }.at(place));
        }
        if said.iter().any(Option::is_some) {
            if !self.modal.tip {
                return Err(Problem::NotTip.at(place));
            }
            let words = self.tip_words(said, place)?;
            if self.learn(&words) {
                self.rapid(Way::Line, words, place)?;
            }
        }
        let all = said.iter().all(Option::is_none);
        let home = self.homes[index];
        let fitted = self.setup.fitted;
        let axes = std::array::from_fn(|axis| {
            let goes = fitted[axis] && (all || said[axis].is_some());
            goes.then_some(home[axis])
        });
        if axes == [None; AXES] {
            return Ok(());
        }
        self.go_in_axes(axes, place)
    }

    /// Where the axes are (mm, degrees).
    fn axes_here(&mut self, place: SourcePosition) -> Result<Coordinates, NcError> {
        let at = self.position(&[0, 1, 2, 3, 4, 5], place)?;
        let axes = self
            .setup
            .kinematics
            .as_ref()
            .and_then(|kinematics| kinematics.axes(&self.tip_of_machine(&at)));
        axes.ok_or(Problem::UnknownPosition.at(place))
    }
}
