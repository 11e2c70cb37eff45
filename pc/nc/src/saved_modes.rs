//! M70 to M73: modes that are saved and restored.

use super::block::Block;
use super::codes::{Code, Group};
use super::error::{NcError, Problem, SourcePosition};
use super::interpreter::Interpreter;
use super::modal::Modal;
use super::outputs::Spindle;

/// Modes of one moment.
#[derive(Clone, Debug)]
pub(super) struct Saved {
    /// Subroutines that it was in.
    depth: usize,
    /// M73: they come back where the subroutine ends.
    to_its_end: bool,
    modal: Modal,
    system: usize,
    spindle: Spindle,
    place: SourcePosition,
}

impl Interpreter {
    /// What M70 to M73 of a block ask for.
    pub(super) fn save_modes(&mut self, block: &Block) -> Result<(), NcError> {
        let Some(code) = block.code(Group::SavedModes) else {
            return Ok(());
        };
        let (depth, place) = (self.parameters.depth(), code.place);
        let own = self.saved.iter().position(|saved| saved.depth == depth);
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
                    self.saved.push(Saved {
                        depth,
                        to_its_end: code == Code::SaveModesOfSubroutine,
                        modal: self.modal.clone(),
                        system: self.offsets.active,
                        spindle: self.spindle.clone(),
                        place,
                    });
                }
                Ok(())
            }
        }
    }

    /// A subroutine with parameters of its own ends.
    pub(super) fn leave(&mut self) -> Result<(), NcError> {
        let depth = self.parameters.depth();
        self.parameters.leave();
        let own = self.saved.iter().position(|saved| saved.depth == depth);
        match own.map(|own| self.saved.remove(own)) {
            Some(saved) if saved.to_its_end => {
                let place = saved.place;
                self.restore(saved, place)
            }
            _ => Ok(()),
        }
    }

    /// All modes but that of motion, and S. A spindle is not switched on or off by this.
    fn restore(&mut self, saved: Saved, place: SourcePosition) -> Result<(), NcError> {
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
