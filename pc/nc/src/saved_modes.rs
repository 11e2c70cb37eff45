//! M70 to M73, and SAVE of Siemens subprograms: modes that are saved and restored.

use super::block::Block;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::frame::Frame;
use super::interpreter::Interpreter;
use super::modal::Modal;
use super::outputs::Spindle;
use super::tilt::Tilt;

/// Modes of one moment.
#[derive(Clone, Debug)]
pub(super) struct Saved {
    /// Subroutines that it was in.
    depth: usize,
    by: By,
    modal: Modal,
    system: usize,
    frame: Frame,
    tilt: Option<Tilt>,
    spindle: Spindle,
    place: SourcePosition,
}

/// What saved modes, and so when they come back.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    /// M70: at M72.
    Program,
    /// M73: where the subroutine ends, and at M72.
    Subroutine,
    /// SAVE behind PROC: where the subprogram ends, with the frame and the tilted plane.
    Header,
}

impl Interpreter {
    /// SAVE: G codes and frame come back where the subprogram ends, which begins here.
    pub(super) fn save_codes(&mut self, place: SourcePosition) {
        self.save(By::Header, place);
    }

    fn save(&mut self, by: By, place: SourcePosition) {
        self.saved.push(Saved {
            depth: self.parameters.depth(),
            by,
            modal: self.modal.clone(),
            system: self.offsets.active,
            frame: self.offsets.frame,
            tilt: self.offsets.tilt,
            spindle: self.spindle.clone(),
            place,
        });
    }

    /// What M70 to M73 of a block ask for.
    pub(super) fn save_modes(&mut self, block: &Block) -> Result<(), NcError> {
        let Some(code) = block.code(Group::SavedModes) else {
            return Ok(());
        };
        let (depth, place) = (self.parameters.depth(), code.place);
        let of_codes = |saved: &Saved| saved.depth == depth && saved.by != By::Header;
        let own = self.saved.iter().position(of_codes);
        match code.code {
            Code::RestoreModes => {
                let (code, why) = ("M72", "no modes were saved here by M70");
                let Some(own) = own else {
                    return Err(Problem::Impossible { code, why }.at(place));
                };
                let saved = self.saved[own].clone();
                self.restore(saved, place)
            }
            code => {
                if let Some(own) = own {
                    self.saved.remove(own);
                }
                if code != Code::ForgetModes {
                    let by = match code {
                        Code::SaveModesOfSubroutine => By::Subroutine,
                        _ => By::Program,
                    };
                    self.save(by, place);
                }
                Ok(())
            }
        }
    }

    /// A subroutine with parameters of its own ends.
    pub(super) fn leave(&mut self) -> Result<(), NcError> {
        let depth = self.parameters.depth();
        self.parameters.leave();
        while let Some(saved) = self.saved.pop_if(|saved| saved.depth == depth) {
            match saved.by {
                By::Program => {}
                By::Subroutine => {
                    let place = saved.place;
                    self.restore(saved, place)?;
                }
                By::Header => {
                    self.check_off("SAVE", saved.place)?;
                    self.modal.restore_codes(saved.modal);
                    self.offsets.active = saved.system;
                    (self.offsets.frame, self.offsets.tilt) = (saved.frame, saved.tilt);
                    self.spline_end = None;
                }
            }
        }
        Ok(())
    }

    /// All modes but that of motion, and S. A spindle is not switched on or off by this.
    fn restore(&mut self, saved: Saved, place: SourcePosition) -> Result<(), NcError> {
        self.check_off("M72", place)?;
        if saved.spindle.turns() != self.spindle.turns() {
            let (code, why) = (
                "M72",
                "the spindle is not as it was at M70 or M73: write M3 or M5 before",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        }
        if let Some(pending) = self.spindle.restore(saved.spindle, place) {
            self.wait(pending);
        }
        let motion = self.modal.motion;
        self.modal = saved.modal;
        self.modal.motion = motion;
        self.offsets.active = saved.system;
        self.spline_end = None;
        Ok(())
    }
}
