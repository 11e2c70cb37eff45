//! How C follows the contour within its travel (mathematics 4.3).

use super::contour::Contour;
use super::error::StirError;
use std::f64::consts::TAU;

/// C may be this far beyond its travel \[rad\]: less than the digits of a program.
const SLACK: f64 = 1e-9;
/// Shortest part of a contour that is welded between two plunges \[mm\].
const SHORTEST: f64 = 1.0;

/// A part of the contour that is welded without lifting the pin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Where it begins \[mm\].
    pub from: f64,
    /// Where it ends \[mm\].
    pub to: f64,
    /// C minus heading \[rad\].
    pub offset: f64,
}

/// The passes of `contour`, with C = heading + `offset` + whole turns within `travel` \[rad\]. It is one, begun at the
/// turn of C from which the whole contour fits; else, with `rewind`, a new pass begins wherever C comes to the end of
/// its travel.
pub fn passes(
    contour: &Contour,
    offset: f64,
    travel: [f64; 2],
    rewind: bool,
) -> Result<Vec<Pass>, StirError> {
    let travel = [travel[0] - SLACK, travel[1] + SLACK];
    let mut passes: Vec<Pass> = Vec::new();
    let mut from = 0.0;
    loop {
        let pass = furthest(contour, from, offset, travel)?;
        passes.push(pass);
        if pass.to >= contour.length() {
            return Ok(passes);
        }
        if !rewind || pass.to - from < SHORTEST {
            return Err(beyond(contour, &pass, travel));
        }
        from = pass.to;
    }
}

/// The pass from `from` on that gets furthest; of several, the one that begins nearest to C = 0.
fn furthest(contour: &Contour, from: f64, offset: f64, travel: [f64; 2]) -> Result<Pass, StirError> {
    let start = contour.at(from).1 + offset;
    let first = ((travel[0] - start) / TAU).ceil() as i64;
    let last = ((travel[1] - start) / TAU).floor() as i64;
    let candidates = (first..=last).map(|turns| {
        let offset = offset + turns as f64 * TAU;
        Pass {
            from,
            to: reach(contour, from, offset, travel),
            offset,
        }
    });
    let begin = |pass: &Pass| (contour.at(from).1 + pass.offset).abs();
    candidates
        .max_by(|a, b| a.to.total_cmp(&b.to).then(begin(b).total_cmp(&begin(a))))
        .ok_or_else(|| StirError::Heading {
            segment: contour.segment_at(from) + 1,
            c: start.to_degrees(),
            min: travel[0].to_degrees(),
            max: travel[1].to_degrees(),
        })
}

/// How far C = heading + `offset` stays within `travel` from `from` on \[mm\].
fn reach(contour: &Contour, from: f64, offset: f64, travel: [f64; 2]) -> f64 {
    let segments = contour.segments();
    for segment in &segments[contour.segment_at(from)..] {
        let end = segment.end_heading() + offset;
        let limit = if end > travel[1] {
            travel[1] - SLACK
        } else if end < travel[0] {
            travel[0] + SLACK
        } else {
            continue;
        };
        let part = (limit - offset - segment.heading) / segment.turn;
        return (segment.start_s + segment.length() * part).clamp(from, contour.length());
    }
    contour.length()
}

/// What `pass` would ask of C.
fn beyond(contour: &Contour, pass: &Pass, travel: [f64; 2]) -> StirError {
    let c = |heading: f64| (heading + pass.offset).to_degrees();
    let outside = |heading: f64| {
        let c = heading + pass.offset;
        c < travel[0] || c > travel[1]
    };
    let first = contour.segment_at(pass.to);
    let segments = contour.segments().iter().enumerate().skip(first);
    let (index, segment) = segments
        .clone()
        .find(|(_, segment)| outside(segment.end_heading()))
        .unwrap_or((first, &contour.segments()[first]));
    StirError::Travel {
        segment: index + 1,
        from: c(contour.at(pass.from).1),
        to: c(segment.end_heading()),
        min: travel[0].to_degrees(),
        max: travel[1].to_degrees(),
    }
}
