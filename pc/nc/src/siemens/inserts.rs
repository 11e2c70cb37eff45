//! What is put into the corner between two lines or arcs: a rounding or a chamfer.

use crate::pieces::{Piece, meet};
use nalgebra::Vector2;
use shared::geometry::Turn;

/// Directions are one where the sine of the angle between them is less: nothing is put between them.
const SMOOTH: f64 = 1e-6;

/// What is put into a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Insert {
    /// An arc of this radius \[mm\].
    Rounding(f64),
    /// A line of this length \[mm\].
    Chamfer(f64),
    /// A line that begins so far before the corner \[mm\].
    ChamferLeg(f64),
}

/// A corner with something put into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    /// Where it begins and ends in the plane \[mm\].
    pub(crate) from: Vector2<f64>,
    pub(crate) to: Vector2<f64>,
    /// Centre and sense of a rounding.
    pub(crate) arc: Option<(Vector2<f64>, Turn)>,
}

/// Puts something into the corner between two pieces, of which the second begins where the first one ends. Nothing where
/// there is no corner; an error where it does not fit, or where they leave the plane.
pub(crate) fn cut(first: &Piece, second: &Piece, insert: Insert) -> Result<Option<Cut>, ()> {
    if first.plane != second.plane {
        return Err(());
    }
    let corner = first.end;
    let (Some(before), Some(after)) = (first.heading(), second.direction_at(second.start)) else {
        return Ok(None);
    };
    let turned = before.perp(&after);
    if turned.abs() < SMOOTH && before.dot(&after) > 0.0 {
        return Ok(None);
    }
    if !(first.flat && second.flat) {
        return Err(());
    }
    let fits = |from, to| first.has(from) && second.has(to);
    let leg = match insert {
        Insert::Rounding(radius) => {
            let side = turned.signum();
            let beside = |piece: &Piece| piece.beside(side * radius).ok_or(());
            let centres = meet(&beside(first)?, &beside(second)?);
            let distance = |centre: &Vector2<f64>| (centre - corner).norm();
            let fitting = centres
                .into_iter()
                .flatten()
                .filter(|centre| fits(first.foot(*centre), second.foot(*centre)));
            let centre = fitting
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .ok_or(())?;
            let turn = if side > 0.0 {
                Turn::CounterClockwise
            } else {
                Turn::Clockwise
            };
            return Ok(Some(Cut {
                from: first.foot(centre),
                to: second.foot(centre),
                arc: Some((centre, turn)),
            }));
        }
        // Of two equal legs, which turn by the angle between the directions.
        Insert::Chamfer(length) => length / (2.0 * ((1.0 + before.dot(&after)) / 2.0).sqrt()),
        Insert::ChamferLeg(leg) => leg,
    };
    let (from, to) = (corner - before * leg, corner + after * leg);
    if first.arc.is_some() || second.arc.is_some() || !fits(from, to) {
        return Err(());
    }
    Ok(Some(Cut { from, to, arc: None }))
}
