//! The way of the centre of a tool whose side goes along a contour: beside each line and arc, around outside corners, and to where
//! the ways meet in inside corners.

use crate::pieces::{Beside, Piece, left, meet, sense};
use nalgebra::Vector2;
use shared::geometry::{Arc, Turn};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Corners of less are none, as for LinuxCNC \[rad\].
const SMOOTH: f64 = 0.05;
/// An arc may turn by so much more than its contour does: rounding \[rad\].
const SAME_SWEEP: f64 = 1e-3;
/// Shortest radius of an arc \[mm\].
const SHORTEST_RADIUS: f64 = 1e-6;

/// Why there is no way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Gouge {
    /// The motion to the contour is too short.
    ShortEntry,
    /// The arc to the contour does not lead to it.
    EntryArc,
    /// The radii at the ends of an arc differ.
    Radii,
    /// The tool does not fit into an arc.
    SmallArc,
    /// The tool does not come to the inside corner at the end of the motion.
    Corner,
    /// The corners at both ends leave nothing of the motion.
    NothingLeft,
}

/// A line or an arc of a contour, and the way beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffsetPiece {
    /// Of the contour.
    piece: Piece,
    /// How far the way is to the left \[mm\].
    offset: f64,
    /// Directions of the contour at its start and end.
    leaves: Vector2<f64>,
    arrives: Vector2<f64>,
    /// The arc of the way: about this centre with this radius.
    arc: Option<(Vector2<f64>, f64, Turn)>,
    /// How far the arc turns as it is programmed \[rad\].
    sweep: f64,
    /// It leads to the contour.
    enters: bool,
}

/// What is where two motions meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Corner {
    /// Nothing.
    Smooth,
    /// An arc about the corner, to this place.
    Around {
        centre: Vector2<f64>,
        to: Vector2<f64>,
        turn: Turn,
    },
    /// The ways meet here.
    Inside(Vector2<f64>),
}

impl Gouge {
    /// As part of a sentence, with what to do.
    pub(super) fn reason(self) -> &'static str {
        match self {
            Self::ShortEntry => {
                "the motion that leads to the contour must be longer than that: begin farther away from it"
            }
            Self::EntryArc => {
                "this arc does not lead to the contour from where the tool is: begin with a line, or elsewhere"
            }
            Self::Radii => "the radii at start and end of this arc differ: correct I J K or R",
            Self::SmallArc => "the tool does not fit into this arc: take a smaller tool, or a larger radius",
            Self::Corner => {
                "the tool does not come to both motions of the inside corner at the end of this one: take a smaller tool, or change the contour"
            }
            Self::NothingLeft => {
                "the tool does not come to this motion between the corners at its ends: take a smaller tool, or change the contour"
            }
        }
    }
}

impl OffsetPiece {
    /// Beside a motion along the contour.
    pub(super) fn along(piece: &Piece, offset: f64) -> Result<Self, Gouge> {
        let [leaves, arrives] = [piece.start, piece.end].map(|place| piece.direction_at(place));
        let leaves = leaves.ok_or(Gouge::NothingLeft)?;
        let arrives = arrives.ok_or(Gouge::NothingLeft)?;
        let (mut arc, mut sweep) = (None, 0.0);
        if let Some((centre, turn)) = piece.arc {
            let [first, last] = [piece.start, piece.end].map(|place| (place - centre).norm());
            if (first - last).abs() > Arc::radius_tolerance(last) {
                return Err(Gouge::Radii);
            }
            let radius = last - sense(turn) * offset;
            if radius < SHORTEST_RADIUS {
                return Err(Gouge::SmallArc);
            }
            arc = Some((centre, radius, turn));
            sweep = swept(piece.start, centre, turn, piece.end);
        }
        Ok(Self {
            piece: *piece,
            offset,
            leaves,
            arrives,
            arc,
            sweep,
            enters: false,
        })
    }

    /// The motion from a place anywhere to where the tool is beside the end of `piece`.
    pub(super) fn entering(piece: &Piece, offset: f64) -> Result<Self, Gouge> {
        if (piece.end - piece.start).norm() <= offset.abs() {
            return Err(Gouge::ShortEntry);
        }
        let mut entry = Self {
            enters: true,
            ..Self::along(piece, offset)?
        };
        if let Some((centre, _, turn)) = entry.arc {
            // Another arc, with its centre on the line through that of the contour and the end.
            let (end, start) = (entry.end(), piece.start);
            let inward = (centre - end).normalize();
            let chord = start - end;
            let radius = chord.norm_squared() / (2.0 * chord.dot(&inward));
            if !(SHORTEST_RADIUS..=1e9).contains(&radius) {
                return Err(Gouge::EntryArc);
            }
            let centre = end + inward * radius;
            entry.arc = Some((centre, radius, turn));
            entry.sweep = swept(start, centre, turn, end);
        }
        Ok(entry)
    }

    /// Where the way ends beside the end of the contour.
    pub(super) fn end(&self) -> Vector2<f64> {
        self.piece.end + left(self.arrives) * self.offset
    }

    /// Centre and sense of an arc.
    pub(super) fn arc(&self) -> Option<(Vector2<f64>, Turn)> {
        self.arc.map(|(centre, _, turn)| (centre, turn))
    }

    /// Whether the tool is inside of the arc.
    fn is_inside(&self) -> bool {
        self.arc
            .is_some_and(|(_, _, turn)| sense(turn) * self.offset > 0.0)
    }

    /// Refuses the way from one place of it to another where it would lead backwards.
    pub(super) fn check(&self, from: Vector2<f64>, to: Vector2<f64>) -> Result<(), Gouge> {
        let forward = match self.arc {
            _ if self.enters && self.arc.is_none() => true,
            None => (to - from).dot(&self.leaves) >= 0.0,
            Some((centre, _, turn)) => swept(from, centre, turn, to) <= self.sweep + SAME_SWEEP,
        };
        forward.then_some(()).ok_or(Gouge::NothingLeft)
    }

    /// What is between this motion and the `next` one.
    pub(super) fn corner(&self, next: &Self) -> Result<Corner, Gouge> {
        let right = -self.offset.signum();
        let turned = right
            * self
                .arrives
                .perp(&next.leaves)
                .atan2(self.arrives.dot(&next.leaves));
        // From -90 to 270 degrees, positive away from the tool.
        let away = if turned < -FRAC_PI_2 { turned + TAU } else { turned };
        // Back along itself, into the tool.
        let back = match next.arc {
            Some(_) => (away - PI).abs() < SMOOTH && !next.is_inside(),
            None => away > PI - SMOOTH && self.arc.is_some() && !self.is_inside(),
        };
        if back || !(-SMOOTH..=PI + SMOOTH).contains(&away) {
            return self.meeting(next).map(Corner::Inside).ok_or(Gouge::Corner);
        }
        if away <= SMOOTH {
            return Ok(Corner::Smooth);
        }
        let centre = next.piece.start;
        Ok(Corner::Around {
            centre,
            to: centre + left(next.leaves) * self.offset,
            turn: if self.offset > 0.0 {
                Turn::Clockwise
            } else {
                Turn::CounterClockwise
            },
        })
    }

    /// Where the ways meet, of two such places the one that is come to.
    fn meeting(&self, next: &Self) -> Option<Vector2<f64>> {
        let from = match (self.arc, next.arc) {
            // The corner is taken to be on the circle of the end, from which rounded numbers may lead it off.
            (None, Some((centre, ..))) => {
                let radius = (next.piece.end - centre).norm();
                let corner = centre + (next.piece.start - centre).normalize() * radius;
                self.carrier(corner + left(self.arrives) * self.offset, self.arrives)
            }
            _ => self.carrier(self.end(), self.arrives),
        };
        let to = next.carrier(next.start(), next.leaves);
        let second = match (self.arc, next.arc) {
            (None, None) => false,
            // Out of a circle forward, into one from behind.
            (None, Some(_)) => !next.is_inside(),
            (Some(_), None) => self.is_inside(),
            // To the side of the tool, but where one arc bends towards it and the other one away.
            (Some(_), Some(_)) => (self.is_inside() == next.is_inside()) == (self.offset < 0.0),
        };
        meet(&from, &to)[usize::from(second)].filter(|place| place.iter().all(|value| value.is_finite()))
    }

    fn start(&self) -> Vector2<f64> {
        self.piece.start + left(self.leaves) * self.offset
    }

    /// The line or circle that the way is a part of, through a place of it in a direction.
    fn carrier(&self, place: Vector2<f64>, direction: Vector2<f64>) -> Beside {
        match self.arc {
            None => Beside::Line(place, direction),
            Some((centre, radius, _)) => Beside::Circle(centre, radius),
        }
    }
}

/// The angle of an arc, of one turn where it ends at its start.
fn swept(from: Vector2<f64>, centre: Vector2<f64>, turn: Turn, to: Vector2<f64>) -> f64 {
    let (from, to) = (from - centre, to - centre);
    let angle = (sense(turn) * from.perp(&to).atan2(from.dot(&to))).rem_euclid(TAU);
    if angle > 0.0 { angle } else { TAU }
}
