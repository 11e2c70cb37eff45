//! The state of a program before a block.

use crate::interpreter::Interpreter;
use crate::modal::Modal;
use crate::offsets::{Coordinates, Offsets};
use crate::outputs::Pending;
use crate::reader::Reader;
use shared::geometry::Turn;
use shared::io::AXES;

/// What is compared with the state after the block.
pub(super) struct Before {
    /// The line that was read last, in the file and the subroutines that the block is in.
    pub(super) line: u32,
    pub(super) file: Option<String>,
    pub(super) depth: usize,
    pub(super) modal: Modal,
    pub(super) offsets: Offsets,
    pub(super) homes: [Coordinates; 2],
    pub(super) tools: [u32; 2],
    pub(super) tool_length: f64,
    pub(super) spindle_speed: f64,
    pub(super) turns: Option<Turn>,
    pub(super) saved: usize,
    /// A hole after every motion.
    pub(super) drills: bool,
    /// How far to the left of a contour the tip goes \[mm\].
    pub(super) beside: Option<f64>,
    /// Where the tip is (mm, degrees), of which axes that is known, and whether no start can be assumed for the others.
    pub(super) at: Coordinates,
    pub(super) known: [bool; AXES],
    pub(super) lost: bool,
    pub(super) in_nurbs: bool,
    /// Waits before what follows, events that wait for a motion, and a dwell \[s\].
    pub(super) waits: usize,
    pub(super) pending: Vec<Pending>,
    pub(super) dwell_s: f64,
    /// How many of each there are; targets and events of the last path.
    pub(super) paths: usize,
    pub(super) targets: usize,
    pub(super) events: usize,
    pub(super) notices: usize,
}

impl Before {
    pub(super) fn of(reader: &Reader) -> Self {
        let state: &Interpreter = &reader.interpreter;
        let last = state.paths.last();
        Self {
            line: reader.position.here().line,
            file: reader.position.file().map(str::to_owned),
            depth: reader.position.depth(),
            modal: state.modal.clone(),
            offsets: state.offsets.clone(),
            homes: state.homes,
            tools: state.tool_numbers,
            tool_length: state.tools.length,
            spindle_speed: state.spindle.speed(),
            turns: state.spindle.turns(),
            saved: state.saved.len(),
            drills: state.modal_drilling.is_some(),
            beside: state.compensation.left(),
            at: state.place(),
            known: state.known,
            lost: state.lost,
            in_nurbs: state.nurbs.is_some(),
            waits: state.waits.len(),
            pending: state.pending.clone(),
            dwell_s: state.dwell_s(),
            paths: state.paths.len(),
            targets: last.map_or(0, |path| path.targets.len()),
            events: last.map_or(0, |path| path.events.len()),
            notices: state.notices.len(),
        }
    }
}
