//! The words of G2 and G3: centre or radius in the plane, and full turns.

use super::claims::Claims;
use super::codes::Code;
use super::error::{NcError, Problem, SourcePosition};
use super::program::{ArcForm, ArcWay, Plane};
use shared::geometry::Turn;

/// Words of the centre, X to Z.
pub(super) const CENTRE_WORDS: [&str; 3] = ["I", "J", "K"];
/// Most turns of one arc: a number beyond is a slip.
const MOST_TURNS: f64 = 10_000.0;

/// The way of the arc `mode`, whose words begin at `place`, with its lengths as they are written; its form may be known already.
pub(super) fn way(
    claims: &Claims,
    mode: Code,
    plane: Plane,
    place: SourcePosition,
    known: Option<ArcForm>,
) -> Result<ArcWay, NcError> {
    let turn = match mode {
        Code::ArcClockwise => Turn::Clockwise,
        _ => Turn::CounterClockwise,
    };
    let more_turns = match claims.word(mode, "P") {
        Some(p) if p.value.fract() == 0.0 && (1.0..=MOST_TURNS).contains(&p.value) => p.value as u32 - 1,
        Some(p) => {
            return Err(p.value_error("the turns of an arc are 1, 2, 3 and so on up to 10000"));
        }
        None => more_turns(claims, mode)?,
    };
    Ok(ArcWay {
        about: plane.normal(),
        turn,
        form: match known {
            Some(form) => form,
            None => form(claims, mode, plane, place)?,
        },
        more_turns,
    })
}

/// TURN=, turns besides the arc.
fn more_turns(claims: &Claims, mode: Code) -> Result<u32, NcError> {
    match claims.word(mode, "TURN") {
        None => Ok(0),
        Some(turns) if turns.value.fract() == 0.0 && (0.0..MOST_TURNS).contains(&turns.value) => {
            Ok(turns.value as u32)
        }
        Some(turns) => Err(turns.value_error("the turns besides an arc are 0, 1, 2 and so on up to 9999")),
    }
}

fn form(claims: &Claims, mode: Code, plane: Plane, place: SourcePosition) -> Result<ArcForm, NcError> {
    let mut centre = CENTRE_WORDS.map(|name| claims.word(mode, name));
    let (code, words) = match plane {
        Plane::Xy => ("G17", "I and J"),
        Plane::Zx => ("G18", "I and K"),
        Plane::Yz => ("G19", "J and K"),
    };
    // Some CAM systems say all three.
    let off = centre[plane.axis()].take().filter(|off| off.value != 0.0);
    if let Some(off) = off {
        let (word, plane) = (off.label(), code);
        return Err(Problem::OffPlane { word, plane, words }.at(off.place));
    }
    let any = centre.iter().any(Option::is_some);
    let [r, cr] = ["R", "CR"].map(|name| claims.word(mode, name));
    if let (Some(_), Some(second)) = (r, cr) {
        return Err(Problem::Twice(second.label()).at(second.place));
    }
    match (any, r.or(cr)) {
        (true, Some(r)) => Err(Problem::CentreAndRadius.at(r.place)),
        (true, None) => Ok(ArcForm::Centre(centre.map(|word| word.map_or(0.0, |w| w.value)))),
        (false, Some(r)) if r.value == 0.0 => Err(r.value_error("the radius must not be 0")),
        (false, Some(r)) => Ok(ArcForm::Radius(r.value)),
        (false, None) => {
            let (code, word) = (mode.name(), "a centre (I J K) or R");
            Err(Problem::Missing { code, word }.at(place))
        }
    }
}
