//! The way of one layer over its length: lead-in, bead, overlap, lead-out.

use super::error::BeadError;
use super::length_table::LengthTable;
use super::points::LONGEST;
use curves::nurbs::{self, Curve, Nurbs};
use nalgebra::Vector3;
use shared::geometry::{Moving, angle};

/// A change of direction that the spline through the points makes nothing of \[rad\].
const KINK: f64 = 1e-3;
/// Ends of a closed curve are the same point to this much \[mm\].
const CLOSED: f64 = 1e-6;
/// Places in each span where the curve must have a direction.
const LOOKS: u32 = 16;

/// The exact curve with its leads. Its parameter is the length \[mm\] from the start of the lead-in.
///
/// A closed bead has its leads on the curve itself: the tip comes along the end of the curve and is at speed where
/// the bead begins; it goes once around, on over the beginning by the overlap, and leaves along the curve. An open
/// bead is led into and out of on its tangents.
#[derive(Clone, Debug)]
pub(super) struct Route<'a> {
    nurbs: Nurbs<'a>,
    table: LengthTable,
    closed: bool,
    lead: f64,
    overlap: f64,
}

impl<'a> Route<'a> {
    /// The way along `nurbs`, which came from `place`, with a lead on both sides, and an overlap if it is closed.
    pub(super) fn build(nurbs: Nurbs<'a>, place: &str, lead: f64, overlap: f64) -> Result<Self, BeadError> {
        let mut ends: Option<Vector3<f64>> = None;
        for piece in nurbs.pieces() {
            for i in 0..=LOOKS {
                let t = f64::from(i) / f64::from(LOOKS);
                let at = piece.curve.at(t);
                // Of its own length, so that no unit matters.
                if at.first.norm() < 1e-9 * hull(piece.curve.points()) {
                    let u = piece.from + t * (piece.to - piece.from);
                    let [x, y, z] = at.value.into();
                    let place = place.to_owned();
                    return Err(BeadError::NoDirection { place, u, x, y, z });
                }
            }
            if let Some(before) = ends {
                check_kink(place, &before, &piece.curve.at(0.0), piece.from)?;
            }
            ends = Some(piece.curve.at(1.0).first);
        }
        let [start, end] = nurbs.domain().map(|u| nurbs.at(u));
        let closed = (end.value - start.value).norm() <= CLOSED && angle(&end.first, &start.first) <= KINK;
        let exact = nurbs::length(&nurbs);
        if exact > LONGEST || exact.is_nan() {
            return Err(BeadError::TooLong {
                place: place.to_owned(),
                length: exact,
                most: LONGEST,
            });
        }
        let table = LengthTable::build(&nurbs);
        let (ends, length) = (lead + overlap, table.length());
        if closed && ends > length / 2.0 {
            return Err(BeadError::EndsTooLong { ends, length });
        }
        Ok(Self {
            nurbs,
            table,
            closed,
            lead,
            overlap: if closed { overlap } else { 0.0 },
        })
    }

    /// Length of the curve \[mm\].
    pub(super) fn length(&self) -> f64 {
        self.table.length()
    }

    /// The curve ends where it began, in the same direction.
    pub(super) fn closed(&self) -> bool {
        self.closed
    }

    /// Where the arc begins and ends to burn.
    pub(super) fn bead(&self) -> [f64; 2] {
        [self.lead, self.lead + self.length() + self.overlap]
    }

    /// Length on the curve, from 0, of a place of the bead.
    pub(super) fn on_curve(&self, t: f64) -> f64 {
        let s = t - self.lead;
        if self.closed {
            s.rem_euclid(self.length())
        } else {
            s
        }
    }

    /// The place nearest to `p` around `t`: its parameter.
    pub(super) fn nearest(&self, p: &Vector3<f64>, mut t: f64) -> f64 {
        for _ in 0..4 {
            let at = self.at(t);
            let off = at.value - p;
            let slope = 1.0 + off.dot(&at.second);
            // Beyond the centre of curvature there is no nearest place around here.
            if slope <= 0.1 {
                break;
            }
            t -= off.dot(&at.first) / slope;
        }
        t
    }
}

impl Curve for Route<'_> {
    fn domain(&self) -> [f64; 2] {
        [0.0, self.bead()[1] + self.lead]
    }

    /// Derivatives over length: the direction, and the curvature towards its centre.
    fn at(&self, t: f64) -> Moving {
        let s = self.on_curve(t);
        let inside = s.clamp(0.0, self.length());
        let at = self.nurbs.at(self.table.parameter(inside));
        let speed = at.first.norm();
        let first = at.first / speed;
        let bend = (at.second - first * first.dot(&at.second)) / (speed * speed);
        Moving {
            value: at.value + first * (s - inside),
            first,
            second: if s == inside { bend } else { Vector3::zeros() },
        }
    }

    /// Where the arc is switched: these are to be points of the program.
    fn next_break(&self, t: f64) -> f64 {
        let [_, end] = self.domain();
        self.bead().into_iter().find(|at| *at > t).unwrap_or(end)
    }
}

fn check_kink(place: &str, before: &Vector3<f64>, after: &Moving, u: f64) -> Result<(), BeadError> {
    let turn = angle(before, &after.first);
    if turn <= KINK {
        return Ok(());
    }
    let [x, y, z] = after.value.into();
    Err(BeadError::Kink {
        place: place.to_owned(),
        degrees: turn.to_degrees(),
        u,
        x,
        y,
        z,
    })
}

/// Length of the control polygon.
fn hull(points: &[Vector3<f64>]) -> f64 {
    points.windows(2).map(|p| (p[1] - p[0]).norm()).sum()
}
