//! Plane curves as formulas, cut into short lines, and how fast each can be gone along.

use super::super::limits::Limits;
use super::super::way::{Move, ROTARY, Way};
use crate::random::Random;
use nalgebra::Vector3;
use shared::geometry::{Line, LineError};
use std::f64::consts::TAU;

/// Length of a curve \[mm\].
pub const LENGTH: f64 = 150.0;
/// Distance of the places of a curve by which its best constant speed is found \[mm\].
const FINE: f64 = 0.02;
/// Steps in which a curve is gone along to find places \[mm\], about.
const STEP: f64 = 2e-4;

/// A curve as a formula of its parameter; waves and loops go along X.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// Across: amplitude \[mm\], wavelength \[mm\], and phase \[rad\] of each wave.
    Waves(Vec<[f64; 3]>),
    /// Radius \[mm\].
    Circle(f64),
    /// Radius where it begins \[mm\], and by how much that grows in a turn \[mm\].
    Spiral(f64, f64),
    /// Radius \[mm\], and how far the centre goes in a turn \[mm\].
    Loops(f64, f64),
    /// A figure of eight: half its length along X \[mm\].
    Eight(f64),
}

/// A curve, and the lines that stand for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What it is called.
    pub name: String,
    shape: Shape,
    /// Length of a line \[mm\].
    line: f64,
}

impl Shape {
    /// Where the formula is at its parameter `u`: X of waves \[mm\], an angle \[rad\] of the others.
    fn at(&self, u: f64) -> [f64; 2] {
        match self {
            Self::Waves(waves) => {
                let height = |[amplitude, length, phase]: &[f64; 3]| {
                    let angle = TAU * u / length + phase;
                    amplitude * angle.sin()
                };
                [u, waves.iter().map(height).sum()]
            }
            Self::Circle(radius) => [radius * u.cos(), radius * u.sin()],
            Self::Spiral(radius, growth) => {
                let radius = radius + growth * u / TAU;
                [radius * u.cos(), radius * u.sin()]
            }
            Self::Loops(radius, pitch) => [radius * u.cos() + pitch * u / TAU, radius * u.sin()],
            Self::Eight(half) => [half * u.sin(), half * u.sin() * u.cos()],
        }
    }

    /// Places on it, `apart` \[mm\] along it, over the [`LENGTH`].
    fn places(&self, apart: f64) -> Vec<[f64; 2]> {
        let (mut u, mut du, mut gone) = (0.0, STEP, 0.0);
        let mut here = self.at(u);
        let mut places = vec![here];
        while places.len() as f64 * apart <= LENGTH {
            let next = self.at(u + du);
            let way = (next[0] - here[0]).hypot(next[1] - here[1]);
            let left = places.len() as f64 * apart - gone;
            if way >= left {
                places.push(self.at(u + left / way * du));
            }
            (u, gone, here) = (u + du, gone + way, next);
            du *= (STEP / way).clamp(0.5, 2.0);
        }
        places
    }
}

impl Curve {
    /// Some of each kind, and then `random` ones, from `seed` on.
    pub fn all(random: u64, seed: u64) -> Vec<Self> {
        let wave = |amplitude, length, line| Self {
            name: format!("wave {amplitude} × {length}"),
            shape: Shape::Waves(vec![[amplitude, length, 0.0]]),
            line,
        };
        let other = |name: &str, shape, line| Self {
            name: name.to_owned(),
            shape,
            line,
        };
        let known = [
            wave(3.0, 22.0, 0.1),
            wave(3.0, 22.0, 0.5),
            wave(1.0, 10.0, 0.1),
            wave(10.0, 60.0, 0.1),
            wave(8.0, 60.0, 0.2),
            wave(0.2, 4.0, 0.1),
            wave(0.5, 6.0, 0.05),
            wave(2.0, 15.0, 0.1),
            wave(1.0, 40.0, 1.0),
            other("circle 3", Shape::Circle(3.0), 0.1),
            other("circle 8", Shape::Circle(8.0), 0.5),
            other("circle 25", Shape::Circle(25.0), 0.5),
            other("spiral 1 + 2", Shape::Spiral(1.0, 2.0), 0.1),
            other("loops 4 × 6", Shape::Loops(4.0, 6.0), 0.1),
            other("loops 2 × 20", Shape::Loops(2.0, 20.0), 0.1),
            other("eight 12", Shape::Eight(12.0), 0.2),
        ];
        let mut curves: Vec<Self> = known
            .into_iter()
            .chain((seed..seed + random).map(Self::random))
            .collect();
        for curve in &mut curves {
            curve.name += &format!(", lines {:.2}", curve.line);
        }
        curves
    }

    /// One to four waves of 4 to 80 mm, each up to a fifth of its length high, in lines of 0.05 to 1 mm.
    fn random(seed: u64) -> Self {
        let mut random = Random(seed);
        // From 1 to 20, as many in each octave.
        let mut factor = || 20f64.powf(random.within(0.0, 1.0));
        let number = 1 + factor() as usize / 6;
        let mut wave = || {
            let length = 4.0 * factor();
            [0.01 * length * factor(), length, factor()]
        };
        let waves = (0..number).map(|_| wave()).collect();
        Self {
            name: format!("seed {seed}"),
            shape: Shape::Waves(waves),
            line: 0.05 * factor(),
        }
    }

    /// The highest constant speed \[mm/s\] at which no axis is beyond `limits` on the curve itself, by differences of
    /// places on it.
    pub fn constant_speed(&self, limits: &Limits) -> f64 {
        let places = self.shape.places(FINE);
        let highest = |order: usize| {
            let of_axis = |axis: usize| {
                let mut d: Vec<f64> = places.iter().map(|place| place[axis]).collect();
                for _ in 0..order {
                    d = d.windows(2).map(|two| (two[1] - two[0]) / FINE).collect();
                }
                d.into_iter().fold(0.0, |highest: f64, x| highest.max(x.abs()))
            };
            of_axis(0).max(of_axis(1))
        };
        let by_acceleration = (limits.acceleration(true) / highest(2)).sqrt();
        by_acceleration.min((limits.jerk(true) / highest(3)).cbrt())
    }

    /// The program: lines from place to place, at a feed \[mm/s\].
    pub fn program(&self, feed: f64) -> Result<Vec<Move>, LineError> {
        let places = self.shape.places(self.line);
        let vector = |[x, y]: [f64; 2]| Vector3::new(x, y, 0.0);
        (1..)
            .zip(places.windows(2))
            .map(|(number, ends)| {
                let line = Line::new(vector(ends[0]), vector(ends[1]))?;
                Ok(Move {
                    line: number,
                    way: Way::Line(line),
                    rotary: [[0.0; ROTARY]; 2],
                    length: line.length(),
                    feed,
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::limits::HEAVY;
    use super::*;

    /// Accelerations and jerks of a circle and of a wave by their formulas.
    #[test]
    fn the_best_constant_speed_is_that_of_the_formula() {
        for curve in Curve::all(0, 0) {
            let speed = match &curve.shape {
                Shape::Circle(radius) => (1000.0 * radius).sqrt().min((20_000.0 * radius * radius).cbrt()),
                // Of a low wave, along which the way is nearly that along X.
                Shape::Waves(waves) if waves[0][0] < 0.03 * waves[0][1] => {
                    let rate = TAU / waves[0][1];
                    (1000.0 / waves[0][0]).sqrt().min((20_000.0 / waves[0][0]).cbrt()) / rate
                }
                _ => continue,
            };
            let found = curve.constant_speed(&HEAVY);
            assert!(
                (found / speed - 1.0).abs() < 0.03,
                "{}: {found}, not {speed}",
                curve.name
            );
        }
    }

    #[test]
    fn lines_are_as_long_as_they_are_to_be_and_cover_the_length() {
        for curve in Curve::all(20, 7) {
            let moves = curve.program(1.0).expect("lines");
            let length: f64 = moves.iter().map(|one| one.length).sum();
            assert!(
                length <= LENGTH && length > 0.9 * LENGTH,
                "{}: {length}",
                curve.name
            );
            for one in &moves {
                assert!(one.length <= curve.line * (1.0 + 1e-6), "{}", curve.name);
            }
        }
    }
}
