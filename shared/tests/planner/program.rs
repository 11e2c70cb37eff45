//! Programs made of moves that are relative to one another, so that any of them can be left out.

use super::bench::Bench;
use curves::ArcLengthPieces;
use curves::nurbs::Nurbs;
use nalgebra::Vector3;
use shared::geometry::{Arc, Line, Turn, rotate};
use shared::trajectory::{CHANNELS, Cubic, Element, Join, PathSpace, SHAPED, Shape, Tolerance};
use std::f64::consts::TAU;

/// A move, relative to where and in which direction the one before ended.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    pub kind: Kind,
    /// By how much it turns away from the direction so far \[rad\]: π goes back, 0 straight on.
    pub corner: f64,
    /// To which side \[rad\].
    pub side: f64,
    /// About its length \[mm\].
    pub size: f64,
    pub feed: f64,
    /// By how much other axes, or the attitude, turn meanwhile \[rad\].
    pub turn: [f64; 3],
    /// Comes to rest at its end.
    pub stop: bool,
}

#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Line,
    /// An arc or helix of this sweep \[rad\], which rises by this share of its size.
    Arc {
        sweep: f64,
        rise: f64,
    },
    /// A NURBS through control points off the straight line by these shares of its size.
    Nurbs {
        off: [f64; 4],
        weight: f64,
    },
    /// Spans of a spline, along an arc of this sweep \[rad\].
    Spans {
        sweep: f64,
    },
    /// So many lines, with a corner of this angle between them, all to one side or to both in turn.
    Chain {
        lines: u8,
        angle: f64,
        both: bool,
    },
    /// The tool stands, or axes X Y Z do.
    Stand,
}

/// Longest time that an element may take at its feed \[s\]: slow ones are short.
const LONGEST: f64 = 1.0;

/// Makes elements of moves.
struct Maker<'a> {
    bench: &'a Bench,
    tolerance: Tolerance,
    elements: Vec<Element>,
    line: u32,
    feed: f64,
    /// Relative to home.
    position: Vector3<f64>,
    direction: Vector3<f64>,
    attitude: Vector3<f64>,
}

/// Elements of a program on `bench`; rounded corners are off by `tolerance` at most. The last one ends in a stop.
pub fn elements(bench: &Bench, moves: &[Move], tolerance: Tolerance) -> Vec<Element> {
    let mut maker = Maker {
        bench,
        tolerance,
        elements: Vec::new(),
        line: 0,
        feed: 1.0,
        position: Vector3::zeros(),
        direction: Vector3::x(),
        attitude: Vector3::zeros(),
    };
    for one in moves {
        maker.line += 1;
        maker.append(one);
        if let Some(last) = maker.elements.last_mut().filter(|_| one.stop) {
            last.join = Join::Stop;
        }
    }
    if let Some(last) = maker.elements.last_mut() {
        last.join = Join::Stop;
    }
    maker.elements
}

impl Maker<'_> {
    fn append(&mut self, one: &Move) {
        let side = self.side(one.side);
        let mut ahead = rotate(&side, one.corner, &self.direction);
        // Back towards the middle where there is no more room.
        if self.position.norm() > self.bench.room {
            ahead = -self.position.normalize();
        }
        self.direction = ahead;
        let side = self.side(one.side);
        let across = side.cross(&ahead);
        self.feed = one.feed;
        let most = self.bench.turn;
        let turned = (self.attitude + most * Vector3::from(one.turn)).map(|angle| angle.clamp(-most, most));
        let size = one.size.min(0.5 * self.bench.room);
        let start = self.position;
        match one.kind {
            Kind::Line => self.line_to(start + ahead * size, turned),
            Kind::Arc { sweep, rise } => {
                let radius = size / sweep.max(1.0);
                let centre = start + across * radius;
                let end = centre + rotate(&side, sweep, &(start - centre)) + side * (rise * size);
                let turns = (sweep / TAU - 1e-9) as u32;
                let arc = Arc::with_turns(start, end, centre, side, Turn::CounterClockwise, turns);
                if let Ok(arc) = arc {
                    self.shapes(&[(Shape::Arc(self.placed(arc)), arc.length())], turned);
                }
            }
            Kind::Nurbs { off, weight } => {
                let at = |part: f64, off: f64, up: f64| {
                    start + ahead * (part * size) + across * (off * size) + side * (up * size)
                };
                let points = [
                    start,
                    at(0.2, 0.0, 0.0),
                    at(0.5, off[0], off[1]),
                    at(0.7, off[2], off[3]),
                    at(1.0, off[1], off[2]),
                ]
                .map(|point| self.bench_point(&point));
                let weights = [1.0, 1.0, weight, 1.0, 1.0];
                let knots = [0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0];
                let nurbs = Nurbs::new(3, &points, &weights, &knots).expect("a curve");
                let pieces: Vec<_> = ArcLengthPieces::new(&nurbs)
                    .map_while(Result::ok)
                    .map(|piece| (Shape::Curve(piece.curve), piece.curve.length()))
                    .collect();
                self.shapes(&pieces, turned);
            }
            Kind::Spans { sweep } => {
                let radius = size / sweep.max(1.0);
                let centre = start + across * radius;
                let count = (sweep / 0.1).ceil() as u32;
                let piece = sweep / f64::from(count);
                let at = |k: u32| {
                    let arm = rotate(&side, piece * f64::from(k), &(start - centre));
                    (self.bench_point(&(centre + arm)), side.cross(&arm) / radius)
                };
                let length = piece * radius;
                let span = |k: u32| {
                    let ((from, ahead), (to, on)) = (at(k), at(k + 1));
                    let cubic = |i: usize| Cubic::hermite([from[i], ahead[i]], [to[i], on[i]], length);
                    (Shape::Span(std::array::from_fn(cubic)), length)
                };
                let spans: Vec<_> = (0..count).map(span).collect();
                self.shapes(&spans, turned);
            }
            Kind::Chain { lines, angle, both } => {
                let (from, mut ahead) = (self.attitude, ahead);
                let length = size / f64::from(lines);
                for k in 1..=lines {
                    let part = f64::from(k) / f64::from(lines);
                    self.line_to(self.position + ahead * length, from + (turned - from) * part);
                    let way = if both && k % 2 == 0 { -angle } else { angle };
                    ahead = rotate(&side, way, &ahead);
                }
            }
            Kind::Stand => {
                let [from, to] = [self.attitude, turned].map(|a| self.bench.channels(&start, &a));
                let length = (0..CHANNELS).map(|i| (to[i] - from[i]).abs()).fold(0.0, f64::max);
                let shape = Shape::Point([from[0], from[1], from[2]]);
                self.shapes(&[(shape, length)], turned);
            }
        }
    }

    /// A unit vector perpendicular to the direction so far.
    fn side(&self, angle: f64) -> Vector3<f64> {
        let other = Vector3::ith(self.direction.iamin(), 1.0);
        let side = self.direction.cross(&other).normalize();
        rotate(&self.direction, angle, &side)
    }

    fn bench_point(&self, position: &Vector3<f64>) -> Vector3<f64> {
        let channels = self.bench.channels(position, &Vector3::zeros());
        Vector3::from_column_slice(&channels[..3])
    }

    /// The same arc on the bench.
    fn placed(&self, arc: Arc) -> Arc {
        let [start, end, centre] =
            [arc.start(), arc.end(), arc.centre()].map(|point| self.bench_point(&point));
        let (axis, turns) = (arc.axis(), arc.more_turns());
        let placed = Arc::with_turns(start, end, centre, axis, Turn::CounterClockwise, turns);
        placed.expect("it was an arc before it was moved")
    }

    fn line_to(&mut self, end: Vector3<f64>, attitude: Vector3<f64>) {
        let ends = [self.position, end].map(|point| self.bench_point(&point));
        if let Ok(line) = Line::new(ends[0], ends[1]) {
            self.shapes(&[(Shape::Line(line), line.length())], attitude);
        }
    }

    /// Appends shapes that make one move, over which the attitude turns evenly.
    fn shapes(&mut self, shapes: &[(Shape, f64)], attitude: Vector3<f64>) {
        let whole: f64 = shapes.iter().map(|(_, length)| length).sum();
        let from = self.attitude;
        let mut gone = 0.0;
        for (shape, length) in shapes {
            if *length <= 0.0 {
                continue;
            }
            let ends = [gone, gone + length].map(|s| {
                let attitude = from + (attitude - from) * (s / whole);
                self.bench.channels(&Vector3::zeros(), &attitude)
            });
            gone += length;
            let mut rest = [Cubic::default(); CHANNELS - SHAPED];
            for (i, cubic) in rest.iter_mut().enumerate() {
                *cubic = Cubic::linear(ends[0][SHAPED + i], ends[1][SHAPED + i], *length);
            }
            self.elements.push(Element {
                line: self.line,
                shape: shape.clone(),
                rest,
                length: *length,
                feed: self.feed.max(length / LONGEST),
                join: Join::Blend(self.tolerance),
            });
        }
        let Some(last) = self.elements.last().filter(|_| gone > 0.0) else {
            return;
        };
        let end = last.at(last.length);
        let part = |channels: &[f64]| Vector3::from_column_slice(&channels[..3]);
        self.position = part(&end.value) - self.bench_point(&Vector3::zeros());
        if self.bench.space == PathSpace::Tool || part(&end.first).norm() > 0.5 {
            let ahead = part(&end.first);
            if ahead.norm() > 0.5 {
                self.direction = ahead.normalize();
            }
        }
        self.attitude = attitude;
    }
}
