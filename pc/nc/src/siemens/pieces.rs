//! Lines and arcs in the plane, and what is put between two of them: a rounding or a chamfer.

use crate::offsets::Coordinates;
use crate::program::{ArcForm, ArcWay, Plane, Way};
use nalgebra::Vector2;
use shared::geometry::Turn;
use shared::io::AXES;
use std::f64::consts::TAU;

/// Directions are one where the sine of the angle between them is less: nothing is put between them.
const SMOOTH: f64 = 1e-6;
/// Parts of a piece that numbers do not tell apart.
const SAME_PART: f64 = 1e-9;

/// A line or an arc of at most one turn in the plane \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(crate) plane: Plane,
    start: Vector2<f64>,
    end: Vector2<f64>,
    /// Centre and sense of an arc.
    arc: Option<(Vector2<f64>, Turn)>,
    /// No other axis moves.
    flat: bool,
}

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

impl Piece {
    /// The motion on `way` from one place of the tip to another, if it is a line or an arc that stays in `plane`.
    pub(crate) fn of(way: &Way, plane: Plane, from: &Coordinates, to: &Coordinates) -> Option<Self> {
        let [start, end] = [from, to].map(|at| Vector2::from(plane.axes().map(|axis| at[axis])));
        let arc = match way {
            Way::Line => None,
            Way::Arc(arc) if arc.plane == plane => Some((centre(arc, start, end)?, arc.turn)),
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
    pub(crate) fn starting(self, start: Vector2<f64>) -> Self {
        Self { start, ..self }
    }

    /// From its start to its centre, of an arc.
    pub(crate) fn to_centre(self) -> Option<Vector2<f64>> {
        self.arc.map(|(centre, _)| centre - self.start)
    }

    /// Direction at its end, of length 1; none of a line without length.
    pub(crate) fn heading(&self) -> Option<Vector2<f64>> {
        self.direction_at(self.end)
    }

    fn direction_at(&self, place: Vector2<f64>) -> Option<Vector2<f64>> {
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

    fn has(&self, place: Vector2<f64>) -> bool {
        (SAME_PART..=1.0 - SAME_PART).contains(&self.part_before(place))
    }

    /// The place of the piece that is next to `place`, on the line or circle that it is a part of.
    fn foot(&self, place: Vector2<f64>) -> Vector2<f64> {
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
    fn beside(&self, distance: f64) -> Option<Beside> {
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

/// Places beside a piece.
enum Beside {
    /// A place of it, and its direction.
    Line(Vector2<f64>, Vector2<f64>),
    /// Centre and radius.
    Circle(Vector2<f64>, f64),
}

/// Where two of them meet.
fn meet(first: &Beside, second: &Beside) -> [Option<Vector2<f64>>; 2] {
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
fn centre(arc: &ArcWay, start: Vector2<f64>, end: Vector2<f64>) -> Option<Vector2<f64>> {
    match arc.form {
        ArcForm::Centre(offset) => Some(start + Vector2::from(arc.plane.axes().map(|axis| offset[axis]))),
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
fn sense(turn: Turn) -> f64 {
    match turn {
        Turn::CounterClockwise => 1.0,
        Turn::Clockwise => -1.0,
    }
}

/// A direction turned to the left by a quarter turn.
fn left(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}
