//! HOLES1 and HOLES2: the cycle of MCALL at holes in a row or on a circle.

use super::calls::arguments;
use crate::error::{NcError, Problem, SourcePosition};
use crate::interpreter::Interpreter;
use crate::parameters::Lookup;
use crate::program::Way;
use crate::scanner::Scanner;
use nalgebra::Vector2;
use shared::io::AXES;

/// Most holes of a pattern.
const MOST: f64 = 10_000.0;

/// Holes in the plane, in the units of the program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Holes {
    name: &'static str,
    places: Vec<Vector2<f64>>,
}

/// The pattern `name`, if it is one of these, with its arguments at the scanner.
pub(super) fn pattern(
    name: &str,
    scanner: &mut Scanner,
    lookup: &mut dyn Lookup,
    place: SourcePosition,
) -> Result<Option<Holes>, NcError> {
    let Some(name) = ["HOLES1", "HOLES2"].into_iter().find(|own| *own == name) else {
        return Ok(None);
    };
    scanner.skip_blanks();
    let given = match scanner.peek() {
        Some('(') => arguments(scanner, lookup)?,
        _ => Vec::new(),
    };
    let wrong = |why| Problem::Impossible { code: name, why }.at(place);
    let [x, y, third, fourth, fifth, count] =
        std::array::from_fn(|index| given.get(index).copied().flatten().unwrap_or(0.0));
    if given.len() > 6 {
        return Err(wrong("it has six arguments: leave the others out"));
    }
    if !(count.fract() == 0.0 && (1.0..=MOST).contains(&count)) {
        return Err(wrong("its last argument, the number of holes, is 1 to 10000"));
    }
    let first = Vector2::new(x, y);
    let direction = |angle: f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        Vector2::new(cos, sin)
    };
    let hole = |index: u32| {
        let steps = f64::from(index);
        match name {
            // SPCA, SPCO, STA1, FDIS, DBH: a row from a point, its angle, how far the first hole is, and between holes.
            "HOLES1" => first + direction(third) * (fourth + steps * fifth),
            // CPA, CPO, RAD, STA1, INDA: a circle, the angle of the first hole and between holes; without one they share it.
            _ => {
                let step = if fifth == 0.0 { 360.0 / count } else { fifth };
                first + direction(fourth + steps * step) * third
            }
        }
    };
    let places = (0..count as u32).map(hole).collect();
    Ok(Some(Holes { name, places }))
}

impl Interpreter {
    /// Goes to each hole, and drills it as MCALL says.
    pub(crate) fn drill_all(&mut self, holes: &Holes, place: SourcePosition) -> Result<(), NcError> {
        let Some(drilling) = self.modal_drilling.clone() else {
            let (code, why) = (
                holes.name,
                "it drills what MCALL says before it: MCALL CYCLE81(…)",
            );
            return Err(Problem::Impossible { code, why }.at(place));
        };
        if !self.modal.tip {
            return Err(Problem::NotTip.at(place));
        }
        for hole in &holes.places {
            let mut said = [None; AXES];
            for (axis, value) in self.modal.plane.axes().into_iter().zip(hole.iter()) {
                said[axis] = Some(value * self.modal.unit());
            }
            let words = self.tip_words(said, place)?;
            if self.learn(&words) {
                self.rapid(Way::Line, words, place)?;
            }
            self.drill(&drilling, place)?;
        }
        Ok(())
    }
}
