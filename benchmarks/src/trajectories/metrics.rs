//! What a run was like, by its output positions alone.

use super::TICK;
use super::contour::{Contour, cut_off};
use super::limits::{Limits, is_linear};
use super::run::Sample;
use super::way::Move;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use shared::io::AXES;

/// An axis moves if it is farther than this from where it stood (mm, rad).
const STANDS: f64 = 1e-9;
/// Ticks of rest that are looked at before and after.
const REST: usize = 3;
/// The feed that counts is the highest within so many ticks: filters mix that long.
const FEED_TICKS: usize = 20;

/// Figures of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// From the first tick that moves to the last \[s\].
    pub time: f64,
    /// Peak acceleration of an axis, over its limit.
    pub acceleration: f64,
    /// Peak jerk of an axis, over its limit.
    pub jerk: f64,
    /// Peak jerk of the published path length, over its limit.
    pub path_jerk: f64,
    /// Peak speed of X Y Z over the feed programmed around there.
    pub feed: f64,
    /// Largest distance of a sample from the program \[mm\].
    pub contour: f64,
    /// Largest distance of an end of a move from the way gone \[mm\].
    pub cut_off: f64,
    /// Largest difference of an axis from the programmed end, after the last tick (mm, rad).
    pub end: f64,
    /// Largest step back of the published path length \[mm\].
    pub back: f64,
}

impl Figures {
    /// Of a run of `moves` inside `limits`, that began with the axes at `start`.
    pub fn of(moves: &[Move], start: &[f64; AXES], samples: &[Sample], limits: &Limits) -> Self {
        let positions: Vec<_> = std::iter::once(*start)
            .chain(samples.iter().map(|sample| sample.axes))
            .collect();
        let s: Vec<f64> = std::iter::once(0.0)
            .chain(samples.iter().map(|sample| sample.s))
            .collect();
        let points: Vec<_> = positions.iter().map(|p| Vector3::new(p[0], p[1], p[2])).collect();
        let contour = Contour::new(moves);
        let error = |i: usize| {
            let speed = if i > 0 { (s[i] - s[i - 1]).abs() } else { 0.0 };
            contour.nearest(&points[i], s[i], speed).distance
        };
        Self {
            time: time(&positions),
            acceleration: peak(&positions, 2, limits),
            jerk: peak(&positions, 3, limits),
            path_jerk: differences(&s, 3) / limits.path_jerk(),
            feed: feed(moves, &points, &s),
            contour: (0..points.len()).map(error).fold(0.0, f64::max),
            cut_off: cut_off(moves, &points, &s),
            end: end(moves, &positions),
            back: s.windows(2).map(|two| two[0] - two[1]).fold(0.0, f64::max),
        }
    }
}

fn time(positions: &[[f64; AXES]]) -> f64 {
    let away = |from: &[f64; AXES]| {
        let from = *from;
        move |p: &[f64; AXES]| (0..AXES).any(|axis| (p[axis] - from[axis]).abs() > STANDS)
    };
    let (Some(first), Some(last)) = (positions.first(), positions.last()) else {
        return 0.0;
    };
    let begin = positions.iter().position(away(first));
    let end = positions.iter().rposition(away(last));
    match (begin, end) {
        // From the last tick at the start to the first at the end.
        (Some(begin), Some(end)) => (end + 2 - begin) as f64 * TICK,
        _ => 0.0,
    }
}

/// Largest derivative of `order` of any axis, over its limit.
fn peak(positions: &[[f64; AXES]], order: usize, limits: &Limits) -> f64 {
    let ratio = |axis: usize| {
        let values: Vec<f64> = positions.iter().map(|p| p[axis]).collect();
        let linear = is_linear(axis);
        let limit = match order {
            2 => limits.acceleration(linear),
            _ => limits.jerk(linear),
        };
        differences(&values, order) / limit
    };
    (0..AXES).map(ratio).fold(0.0, f64::max)
}

/// Largest derivative of `order` by differences, with rest before and after.
fn differences(values: &[f64], order: usize) -> f64 {
    let (Some(first), Some(last)) = (values.first(), values.last()) else {
        return 0.0;
    };
    let mut d: Vec<f64> = [[*first; REST].as_slice(), values, &[*last; REST]].concat();
    for _ in 0..order {
        d = d.windows(2).map(|two| (two[1] - two[0]) / TICK).collect();
    }
    d.into_iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// Largest speed over the highest feed of the moves that go by within [`FEED_TICKS`].
fn feed(moves: &[Move], points: &[Vector3<f64>], s: &[f64]) -> f64 {
    let mut ends = Vec::with_capacity(moves.len());
    let mut end = 0.0;
    for one in moves {
        end += one.length;
        ends.push(end);
    }
    let last = s.len().saturating_sub(1);
    let ratio = |i: usize| {
        let speed = (points[i] - points[i - 1]).norm() / TICK;
        let from = s[i.saturating_sub(FEED_TICKS)];
        let to = s[(i + FEED_TICKS).min(last)];
        let begin = ends.partition_point(|end| *end < from).min(moves.len() - 1);
        let highest = (begin + 1..moves.len())
            .take_while(|next| ends[next - 1] <= to)
            .fold(moves[begin].feed, |most, next| most.max(moves[next].feed));
        speed / highest
    };
    (1..s.len()).map(ratio).fold(0.0, f64::max)
}

fn end(moves: &[Move], positions: &[[f64; AXES]]) -> f64 {
    let (Some(last), Some(position)) = (moves.last(), positions.last()) else {
        return 0.0;
    };
    let target = last.way.end();
    let target = target.iter().chain(&last.rotary[1]);
    let off = position.iter().zip(target).map(|(p, t)| (p - t).abs());
    off.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::limits::QUICK;
    use super::super::seg;
    use super::*;
    use std::f64::consts::TAU;

    fn sampled(ticks: usize, at: impl Fn(f64) -> ([f64; AXES], f64)) -> Vec<Sample> {
        (0..=ticks)
            .map(|i| at(i as f64 * TICK))
            .map(|(axes, s)| Sample { axes, s, pushed: 0 })
            .collect()
    }

    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() < tolerance, "{value}, not {expected}");
    }

    /// s(t) for a way in a time with zero speed, acceleration and jerk at both ends.
    fn smooth(part: f64) -> f64 {
        part.powi(4) * (35.0 - 84.0 * part + 70.0 * part * part - 20.0 * part.powi(3))
    }

    #[test]
    fn a_smooth_line_has_the_peaks_of_its_polynomial() {
        let moves = seg::read("L 0 60 80 0 0 0 1000\n", "x").expect("a program");
        let samples = sampled(1000, |t| {
            let s = 100.0 * smooth(t);
            ([0.0, 0.6 * s, 0.8 * s, 0.0, 0.0, 0.0], s)
        });
        let figures = Figures::of(&moves, &[0.0; AXES], &samples, &QUICK);
        // Peaks of the polynomial over its time: 7.5132 and 52.5 (in the middle).
        close(figures.acceleration, 80.0 * 7.5132 / 2000.0, 1e-4);
        close(figures.jerk, 80.0 * 52.5 / 200_000.0, 1e-5);
        close(figures.path_jerk, 100.0 * 52.5 / 200_000.0, 1e-5);
        // At its middle the speed is 35/16 of the mean.
        close(figures.feed, 100.0 * 35.0 / 16.0 / 1000.0, 1e-6);
        // The first and last ticks move less than what counts as standing.
        close(figures.time, 1.0, 0.02);
        assert!(figures.contour < 1e-12 && figures.cut_off < 1e-12 && figures.end < 1e-12);
        assert_eq!(figures.back, 0.0);
    }

    #[test]
    fn a_circle_at_known_speed_and_offset_gives_its_acceleration_and_error() {
        let moves = seg::read("C 0 0 0 20 0 0 0 0 1 0 100\n", "x").expect("a program");
        let (radius, speed) = (20.03, 100.0);
        let ticks = (TAU * radius / speed / TICK) as usize;
        let samples = sampled(ticks, |t| {
            let angle = speed / radius * t;
            let axes = [
                20.0 - radius * angle.cos(),
                -radius * angle.sin(),
                0.0,
                0.0,
                0.0,
                0.0,
            ];
            (axes, angle * 20.0)
        });
        let inside = &samples[10..samples.len() - 10];
        let points: Vec<_> = inside.iter().map(|sample| sample.axes[0]).collect();
        let d: Vec<_> = points
            .windows(3)
            .map(|p| (p[0] - 2.0 * p[1] + p[2]) / TICK / TICK)
            .collect();
        close(
            d.iter().fold(0.0, |most: f64, a| most.max(a.abs())),
            speed * speed / radius,
            0.01,
        );
        let figures = Figures::of(&moves, &samples[0].axes, &samples, &QUICK);
        close(figures.contour, 0.03, 1e-9);
        close(figures.feed, 1.0, 1e-5);
        // It starts at full speed: Y changes by that within a tick.
        close(figures.acceleration, speed / TICK / 2000.0, 0.01);
    }

    #[test]
    fn time_end_and_steps_back_are_seen() {
        let moves = seg::read("L 1 0 0 0 0 9 100\n", "x").expect("a program");
        let c = 9_f64.to_radians();
        let samples = [0.0, 0.3, 0.2, 1.0].map(|s| Sample {
            axes: [s, 0.0, 0.0, 0.0, 0.0, s * (c + 0.01)],
            s,
            pushed: 0,
        });
        let figures = Figures::of(&moves, &[0.0; AXES], &samples, &QUICK);
        close(figures.back, 0.1, 1e-12);
        close(figures.end, 0.01, 1e-12);
        // Rest before and after does not count.
        let resting = [&[samples[0]; 7], &samples[..], &[samples[3]; 5]].concat();
        for samples in [&samples[..], &resting] {
            close(
                Figures::of(&moves, &[0.0; AXES], samples, &QUICK).time,
                3.0 * TICK,
                1e-12,
            );
        }
    }
}
