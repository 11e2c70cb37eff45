//! CYCLE800: a tilted plane, and the tool that is turned to it.

use super::calls::arguments_by;
use super::expression;
use crate::codes::Code;
use crate::error::{NcError, Problem, SourcePosition};
use crate::frame::Frame;
use crate::interpreter::Interpreter;
use crate::parameters::Lookup;
use crate::scanner::Scanner;
use shared::io::AXES;

const NAME: &str = "CYCLE800";
/// Indices of its arguments.
const RETRACTION: usize = 0;
const DATA: usize = 1;
const STATE: usize = 2;
const MODE: usize = 3;
const BEFORE: usize = 4;
const ANGLES: usize = 7;
const BEHIND: usize = 10;
const DIRECTION: usize = 13;

/// What a CYCLE800 asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Swivel {
    /// The plane ends.
    End,
    Plane(Plane),
}

/// A plane, in units of the program and degrees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plane {
    /// It goes on from the one that holds.
    adds: bool,
    /// Shifts before and behind the rotations.
    shifts: [[f64; 3]; 2],
    /// Axes and angles, one after the other.
    turns: Vec<(usize, f64)>,
    /// Whether the tool is turned to it, and whether with the tip where it is.
    turns_tool: Option<bool>,
}

/// The arguments behind its name.
pub(super) fn read(scanner: &mut Scanner, lookup: &mut dyn Lookup) -> Result<Swivel, NcError> {
    let place = scanner.place();
    let wrong = |why| Err(Problem::Impossible { code: NAME, why }.at(place));
    scanner.skip_blanks();
    let mut data = None;
    let argument = |scanner: &mut Scanner, index| match scanner.peek() {
        Some('"') if index == DATA => {
            scanner.step();
            data = Some(scanner.take(|c| c != '"').to_owned());
            scanner.step();
            Ok(0.0)
        }
        _ => expression::value(scanner, lookup),
    };
    let given = match scanner.peek() {
        Some('(') => arguments_by(scanner, argument)?,
        _ => Vec::new(),
    };
    let get = |index: usize| given.get(index).copied().flatten().unwrap_or(0.0);
    let three = |first: usize| [get(first), get(first + 1), get(first + 2)];
    if get(RETRACTION) != 0.0 {
        return wrong(
            "its first argument asks for a retraction that is not known here: write 0, and a SUPA G0 before it",
        );
    }
    if given.is_empty() || data.is_some_and(|name| name == "0") {
        return Ok(Swivel::End);
    }
    let (adds, keeps_tip) = match get(STATE) {
        0.0 => (false, false),
        1.0 => (true, false),
        10.0 => (false, true),
        11.0 => (true, true),
        _ => {
            return wrong(
                "_ST is 0 for a new plane, 1 for one inside the last, and 10 more where the tip stays",
            );
        }
    };
    let turns_tool = match get(DIRECTION) {
        0.0 => None,
        1.0 | -1.0 => Some(keeps_tip),
        _ => return wrong("_DIR is -1 or 1, or 0 for a tool that is not turned"),
    };
    let Some(turns) = turns(get(MODE), three(ANGLES)) else {
        return wrong(
            "angles are about X, Y and Z one after the other (_MODE up to 63, as 57) or solid (64): projected ones and those of \
             rotary axes are not supported",
        );
    };
    Ok(Swivel::Plane(Plane {
        adds,
        shifts: [three(BEFORE), three(BEHIND)],
        turns,
        turns_tool,
    }))
}

/// The rotations of `_MODE`, whose bits name the axes of A, B and C; none of another kind of angles.
fn turns(mode: f64, angles: [f64; 3]) -> Option<Vec<(usize, f64)>> {
    if angles == [0.0; 3] {
        return Some(Vec::new());
    }
    let [a, b, c] = angles;
    let whole = mode.fract() == 0.0 && (0.0..256.0).contains(&mode);
    match whole.then_some(mode as usize)? {
        bits @ 0..64 => {
            let turn = |(index, angle): (usize, f64)| match (bits >> (2 * index) & 3, angle) {
                (0, 0.0) => Some(None),
                (0, _) => None,
                (axis, angle) => Some(Some((axis - 1, angle))),
            };
            let turns: Option<Vec<_>> = angles.into_iter().enumerate().map(turn).collect();
            Some(turns?.into_iter().flatten().collect())
        }
        64..128 if c == 0.0 => Some(vec![(2, a), (1, b)]),
        _ => None,
    }
}

impl Interpreter {
    /// Carries out a CYCLE800.
    pub(super) fn swivel(&mut self, swivel: &Swivel, place: SourcePosition) -> Result<(), NcError> {
        self.check_no_foreign(NAME, place)?;
        self.check_no_fanuc_tilt(NAME, place)?;
        self.check_whole_plane(place)?;
        let plane = match swivel {
            Swivel::End => {
                if self.end_tilt() {
                    let text = "CYCLE800() ends the tilted plane and moves no axis: turn the tool back by G0";
                    self.tell_once(text.to_owned(), place);
                }
                return Ok(());
            }
            Swivel::Plane(plane) => plane,
        };
        let mut frame = if plane.adds {
            self.offsets.frame
        } else {
            Frame::default()
        };
        let [before, behind] = plane.shifts.map(|shift| self.shift(shift));
        frame.shift(&before);
        for (axis, degrees) in &plane.turns {
            frame.turn(*axis, *degrees);
        }
        frame.shift(&behind);
        match frame.is_none() {
            // Not tilted, and nowhere else: what is programmed ends nevertheless.
            true => {
                self.end_tilt();
                self.offsets.frame = frame;
            }
            false => self.hold_tilt(frame, Code::Swivel),
        }
        match plane.turns_tool {
            Some(keeps_tip) => self.stand_on_plane(keeps_tip, NAME, place),
            None => Ok(()),
        }
    }

    fn shift(&self, by: [f64; 3]) -> [f64; AXES] {
        let mut shift = [0.0; AXES];
        for (own, by) in shift.iter_mut().zip(by) {
            *own = by * self.modal.unit();
        }
        shift
    }
}
