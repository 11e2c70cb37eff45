//! How far the machine was from what was programmed: the true distance to the nearest point of the program, and the
//! other way round.

use super::way::{Course, Move};
use curves::nurbs::{Curve, length_between};
use nalgebra::Vector3;

/// The nearest point is looked for so far before and after the path length that was given \[mm\]: more than a rounded
/// corner takes, ...
const AROUND: f64 = 5.0;
/// ... and more than is gone in so many ticks.
const TICKS: f64 = 20.0;
/// Steps towards the nearest point of a curve. They end long before.
const STEPS: usize = 20;
/// A step \[mm\] that leads nowhere: points are that exact.
const FINE: f64 = 1e-12;

/// The programmed path, cut into chords.
pub struct Contour<'a> {
    chords: Vec<Chord<'a>>,
}

struct Chord<'a> {
    /// Path length at start and end.
    s: [f64; 2],
    ends: [Vector3<f64>; 2],
    /// What it is a chord of, between two parameters; nothing of a straight one.
    of: Option<(Course<'a>, [f64; 2])>,
    /// The curve is nowhere farther from the chord than this \[mm\].
    bulge: f64,
}

/// The nearest point of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// How far it is \[mm\].
    pub distance: f64,
    /// At which path length \[mm\].
    pub s: f64,
}

impl<'a> Contour<'a> {
    /// Of a program.
    pub fn new(moves: &'a [Move]) -> Self {
        let mut chords = Vec::new();
        let mut s = 0.0;
        for one in moves {
            let Some(course) = one.way.course() else {
                chords.push(Chord {
                    s: [s, s + one.length],
                    ends: [one.way.start(), one.way.end()],
                    of: None,
                    bulge: 0.0,
                });
                s += one.length;
                continue;
            };
            let mut begin = s;
            for range in course.parts() {
                chords.push(Chord::new(course, range, begin));
                begin = chords[chords.len() - 1].s[1];
            }
            s += one.length;
        }
        Self { chords }
    }

    /// The point of the path nearest to `point`, near the path length `s` \[mm\] when `speed` mm go by in a tick; where
    /// there is no path, of all of it.
    pub fn nearest(&self, point: &Vector3<f64>, s: f64, speed: f64) -> Nearest {
        let around = AROUND + TICKS * speed;
        let first = self.chords.partition_point(|chord| chord.s[1] < s - around);
        let end = self.chords.partition_point(|chord| chord.s[0] <= s + around);
        if first < end {
            nearest(&self.chords[first..end], point)
        } else {
            nearest(&self.chords, point)
        }
    }
}

fn nearest(chords: &[Chord], point: &Vector3<f64>) -> Nearest {
    let farthest = |chord: &Chord| chord.distance(point).0 + chord.bulge;
    let bound = chords.iter().map(farthest).fold(f64::INFINITY, f64::min);
    let mut nearest = Nearest {
        distance: f64::INFINITY,
        s: f64::NAN,
    };
    for chord in chords {
        let (distance, part) = chord.distance(point);
        if distance - chord.bulge > bound {
            continue;
        }
        let found = match &chord.of {
            None => Nearest {
                distance,
                s: chord.s[0] + (chord.s[1] - chord.s[0]) * part,
            },
            Some((course, [low, high])) => {
                let (distance, u) = on_curve(course, point, [*low, *high], low + (high - low) * part);
                Nearest {
                    distance,
                    s: chord.s[0] + length_between(course, *low, u),
                }
            }
        };
        if found.distance < nearest.distance {
            nearest = found;
        }
    }
    nearest
}

/// Distance \[mm\] of `point` from the part of a curve between two parameters, and the parameter of the nearest point,
/// looked for from one between them on.
fn on_curve(course: &Course, point: &Vector3<f64>, [low, high]: [f64; 2], from: f64) -> (f64, f64) {
    let mut nearest = (f64::INFINITY, from);
    let mut u = from;
    for _ in 0..STEPS {
        let here = course.at(u);
        let to = here.value - point;
        if to.norm() < nearest.0 {
            nearest = (to.norm(), u);
        }
        // Newton on the derivative of half the squared distance; downhill where that is not convex.
        let speed = here.first.norm_squared();
        let convex = speed + to.dot(&here.second);
        let step = to.dot(&here.first) / if convex > 0.0 { convex } else { speed };
        let next = (u - step).clamp(low, high);
        if (next - u).abs() * speed.sqrt() < FINE {
            break;
        }
        u = next;
    }
    for end in [low, high] {
        let distance = (course.point(end) - point).norm();
        if distance < nearest.0 {
            nearest = (distance, end);
        }
    }
    nearest
}

impl<'a> Chord<'a> {
    /// Between two parameters of `course`, from path length `s` on.
    fn new(course: Course<'a>, range: [f64; 2], s: f64) -> Self {
        let ends = range.map(|u| course.point(u));
        let off = |i: u32| {
            let part = f64::from(i) / 8.0;
            distance(&ends, &course.point(range[0] + (range[1] - range[0]) * part)).0
        };
        Self {
            s: [s, s + length_between(&course, range[0], range[1])],
            ends,
            of: Some((course, range)),
            // Between those looked at it is hardly more.
            bulge: 1.5 * (1..8).map(off).fold(0.0, f64::max),
        }
    }

    /// Distance of `point` \[mm\], and after which part of the chord.
    fn distance(&self, point: &Vector3<f64>) -> (f64, f64) {
        distance(&self.ends, point)
    }
}

/// Distance of `point` from the straight between `ends` \[mm\], and after which part of it the nearest point comes.
fn distance(ends: &[Vector3<f64>; 2], point: &Vector3<f64>) -> (f64, f64) {
    let way = ends[1] - ends[0];
    let square = way.norm_squared();
    let part = if square > 0.0 {
        ((point - ends[0]).dot(&way) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    ((ends[0] + way * part - point).norm(), part)
}

/// Largest distance \[mm\] of an end of a move from the way through `points`: what is cut off and never reached shows
/// here, as it does not in [`Contour::nearest`]. `s` are path lengths of the points.
pub fn cut_off(moves: &[Move], points: &[Vector3<f64>], s: &[f64]) -> f64 {
    let mut end = 0.0;
    let mut largest = 0.0_f64;
    for one in moves {
        end += one.length;
        let target = one.way.end();
        let mut nearest = f64::MAX;
        for i in 1..points.len() {
            if (s[i] - end).abs() <= AROUND + TICKS * (s[i] - s[i - 1]).abs() {
                nearest = nearest.min(distance(&[points[i - 1], points[i]], &target).0);
            }
        }
        largest = largest.max(nearest);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::super::seg;
    use super::super::way::Way;
    use super::*;

    #[test]
    fn a_known_offset_is_the_error() {
        let moves = seg::read("L 100 0 0 0 0 0 10\nL 100 50 0 0 0 0 10\n", "x").expect("a program");
        let contour = Contour::new(&moves);
        for (point, s, error) in [
            ([40.0, 0.03, 0.0], 41.0, 0.03),
            ([40.0, 0.03, -0.04], 40.0, 0.05),
            ([99.9, 0.1, 0.0], 100.0, 0.1),
            ([100.3, -0.4, 0.0], 100.0, 0.5),
            ([100.0, 50.7, 0.0], 150.0, 0.7),
        ] {
            assert!((contour.nearest(&point.into(), s, 0.1).distance - error).abs() < 1e-12);
        }
    }

    /// Against every one of a million points of the curve.
    #[test]
    fn the_distance_from_arcs_helices_and_spirals_is_the_true_one() {
        for program in [
            "C 0 0 0 5 0 0 0 0 1 0 10",
            // Steep: the point at the same angle is far from the nearest.
            "C 0 0 300 2 0 0 0 0 1 3 10",
            // Flat: the turns are 0.3 mm apart.
            "C 0 0 3 5 0 0 0 0 1 -10 10",
            "C 30 0 1 5 0 0 0 0 1 2 10",
        ] {
            let moves = seg::read(program, "x").expect("a program");
            let contour = Contour::new(&moves);
            let Way::Spiral(spiral) = moves[0].way else {
                panic!("an arc")
            };
            let count = 1_000_000;
            let points: Vec<_> = (0..=count)
                .map(|i| spiral.point(spiral.sweep() * f64::from(i) / f64::from(count)))
                .collect();
            // Not at the ends: those of a circle are near, but not along the path.
            for i in 1..12 {
                let u = spiral.sweep() * f64::from(i) / 12.0;
                let near = spiral.at(u);
                let s = length_between(&spiral, 0.0, u);
                for off in [
                    Vector3::new(0.0, 0.0, 0.05),
                    Vector3::new(0.02, -0.03, 0.0),
                    near.second.normalize() * 0.04,
                ] {
                    let point = near.value + off;
                    let true_one = points
                        .iter()
                        .map(|p| (p - point).norm_squared())
                        .fold(f64::INFINITY, f64::min)
                        .sqrt();
                    let error = contour.nearest(&point, s, 0.1).distance;
                    assert!(error <= true_one + 1e-12, "{program}: {error} {true_one}");
                    assert!(true_one - error < 1e-5, "{program}: {error} {true_one}");
                }
            }
        }
    }

    #[test]
    fn what_is_never_reached_shows() {
        // There and back: who turns early is never beside the path.
        let moves = seg::read("L 10 0 0 0 0 0 10\nL 0 0 0 0 0 0 10\n", "x").expect("a program");
        let way = |turn: f64| -> (Vec<Vector3<f64>>, Vec<f64>) {
            [[0.0, 0.0], [turn, turn], [turn, 20.0 - turn], [0.0, 20.0]]
                .map(|[x, s]| (Vector3::new(x, 0.0, 0.0), s))
                .into_iter()
                .unzip()
        };
        let (points, s) = way(9.93);
        assert!((cut_off(&moves, &points, &s) - 0.07).abs() < 1e-12);
        let (points, s) = way(10.0);
        assert_eq!(cut_off(&moves, &points, &s), 0.0);
    }
}
