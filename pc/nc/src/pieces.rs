//! Lines and arcs in the plane: their directions, what lies beside them, and where that meets.

use super::offsets::Coordinates;
use super::program::{ArcForm, ArcWay, Plane, Way};
use nalgebra::Vector2;
use shared::geometry::Turn;
use shared::io::AXES;
use std::f64::consts::TAU;

/// Parts of a piece that numbers do not tell apart.
const SAME_PART: f64 = 1e-9;

/// A line or an arc of at most one turn in the plane \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) plane: Plane,
    pub(super) start: Vector2<f64>,
    pub(super) end: Vector2<f64>,
    /// Centre and sense of an arc.
    pub(super) arc: Option<(Vector2<f64>, Turn)>,
    /// No other axis moves.
    pub(super) flat: bool,
}

impl Piece {
    /// The motion on `way` from one place of the tip to another, if it is a line or an arc that stays in `plane`.
    pub(super) fn of(way: &Way, plane: Plane, from: &Coordinates, to: &Coordinates) -> Option<Self> {
        let [start, end] = [from, to].map(|at| Vector2::from(plane.axes().map(|axis| at[axis])));
        let arc = match way {
            Way::Line => None,
            Way::Arc(arc) if arc.about == plane.normal() => Some((centre(arc, plane, start, end)?, arc.turn)),
            Way::Arc(_) | Way::Nurbs(_) | Way::Axes | Way::Wait(_) => return None,
        };
        Some(Self {
            plane,
            start,
            end,
            arc,
            flat: (0..AXES).all(|axis| plane.axes().contains(&axis) || from[axis] == to[axis]),
        })
    }

    /// The same motion from another start on it.
    pub(super) fn starting(self, start: Vector2<f64>) -> Self {
        Self { start, ..self }
    }

    /// From its start to its centre, of an arc.
    pub(super) fn to_centre(self) -> Option<Vector2<f64>> {
        self.arc.map(|(centre, _)| centre - self.start)
    }

    /// Direction at its end, of length 1; none of a line without length.
    pub(super) fn heading(&self) -> Option<Vector2<f64>> {
        self.direction_at(self.end)
    }

    pub(super) fn direction_at(&self, place: Vector2<f64>) -> Option<Vector2<f64>> {
        let along = match self.arc {
            None => self.end - self.start,
            Some((centre, turn)) => {
                let out = place - centre;
                left(out) * sense(turn)
            }
        };
        along.try_normalize(0.0)
    }

    /// What part of the piece lies before a place on it.
    fn part_before(&self, place: Vector2<f64>) -> f64 {
        match self.arc {
            None => {
                let along = self.end - self.start;
                (place - self.start).dot(&along) / along.norm_squared()
            }
            Some((centre, turn)) => {
                let angle = |place: Vector2<f64>| {
                    let out = place - centre;
                    sense(turn) * out[1].atan2(out[0])
                };
                let from_start = |place| (angle(place) - angle(self.start)).rem_euclid(TAU);
                let whole = from_start(self.end);
                from_start(place) / if whole > 0.0 { whole } else { TAU }
            }
        }
    }

    pub(super) fn has(&self, place: Vector2<f64>) -> bool {
        (SAME_PART..=1.0 - SAME_PART).contains(&self.part_before(place))
    }

    /// The place of the piece that is next to `place`, on the line or circle that it is a part of.
    pub(super) fn foot(&self, place: Vector2<f64>) -> Vector2<f64> {
        match self.arc {
            None => {
                let along = self.end - self.start;
                self.start + along * self.part_before(place)
            }
            Some((centre, _)) => {
                let radius = (self.start - centre).norm();
                centre + (place - centre).normalize() * radius
            }
        }
    }

    /// Where places are that lie `distance` to the left of the piece.
    pub(super) fn beside(&self, distance: f64) -> Option<Beside> {
        match self.arc {
            None => {
                let along = self.direction_at(self.start)?;
                Some(Beside::Line(self.start + left(along) * distance, along))
            }
            Some((centre, turn)) => {
                let radius = (self.start - centre).norm() - sense(turn) * distance;
                (radius > 0.0).then_some(Beside::Circle(centre, radius))
            }
        }
    }
}

/// Places beside a piece.
pub(super) enum Beside {
    /// A place of it, and its direction.
    Line(Vector2<f64>, Vector2<f64>),
    /// Centre and radius.
    Circle(Vector2<f64>, f64),
}

/// Where two of them meet.
pub(super) fn meet(first: &Beside, second: &Beside) -> [Option<Vector2<f64>>; 2] {
    match (first, second) {
        (Beside::Line(a, along), Beside::Line(b, other)) => {
            let way = (b - a).perp(other) / along.perp(other);
            [way.is_finite().then(|| a + along * way), None]
        }
        (Beside::Line(a, along), Beside::Circle(centre, radius))
        | (Beside::Circle(centre, radius), Beside::Line(a, along)) => {
            let nearest = a + along * (centre - a).dot(along);
            either_side(
                nearest,
                *along,
                radius * radius - (nearest - centre).norm_squared(),
            )
        }
        (Beside::Circle(a, first), Beside::Circle(b, second)) => {
            let between = b - a;
            let distance = between.norm();
            let along = between / distance;
            let way = (distance * distance + first * first - second * second) / (2.0 * distance);
            either_side(a + along * way, left(along), first * first - way * way)
        }
    }
}

/// The places that lie the root of `squared` before and behind another.
fn either_side(place: Vector2<f64>, along: Vector2<f64>, squared: f64) -> [Option<Vector2<f64>>; 2] {
    [1.0, -1.0].map(|sign| (squared >= 0.0).then(|| place + along * (sign * squared.sqrt())))
}

/// The centre of an arc between two places of its plane; none if there is no such circle.
fn centre(arc: &ArcWay, plane: Plane, start: Vector2<f64>, end: Vector2<f64>) -> Option<Vector2<f64>> {
    match arc.form {
        ArcForm::Centre(offset) => Some(start + Vector2::from(plane.axes().map(|axis| offset[axis]))),
        ArcForm::Radius(radius) => {
            let chord = end - start;
            let length = chord.norm();
            let rest = (radius * radius / (length * length) - 0.25).max(0.0).sqrt();
            // The centre of the shorter arc lies on the side to which it turns.
            let aside = sense(arc.turn) * radius.signum() * rest;
            (length > 0.0).then(|| start + chord * 0.5 + left(chord) * aside)
        }
    }
}

/// 1 to the left, -1 to the right.
pub(super) fn sense(turn: Turn) -> f64 {
    match turn {
        Turn::CounterClockwise => 1.0,
        Turn::Clockwise => -1.0,
    }
}

/// A direction turned to the left by a quarter turn.
pub(super) fn left(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}
