//! What a corner may use of the two elements that meet there.

use super::limits::{Bounds, FILTER_SHARE};
use super::track::Piece;
use crate::trajectory::Join;

/// What a corner may use of an element; `whole` if the machine comes to rest at its other end.
pub(super) fn share(piece: &Piece, whole: bool) -> f64 {
    if whole {
        piece.element.length
    } else {
        0.5 * piece.element.length
    }
}

/// What a corner may use of the two elements that meet there \[mm\].
pub(super) fn between(before: &Piece, after: &Piece) -> f64 {
    libm::fmin(
        share(before, before.stop),
        share(after, after.element.join == Join::Stop),
    )
}

/// The same, but no more than is needed to keep the feed where the direction turns by `turn`.
pub(super) fn room(before: &Piece, after: &Piece, turn: f64, bounds: &Bounds) -> f64 {
    let feed = libm::fmin(before.element.feed, after.element.feed);
    libm::fmin(between(before, after), feed * feed * turn / (1.2 * bounds.corner))
}

/// Half length of a corner that turns by `turn` and stays within `tolerance` \[mm\].
pub(super) fn plain(turn: f64, tolerance: f64) -> f64 {
    4.0 * (1.0 - FILTER_SHARE) * tolerance / turn
}
