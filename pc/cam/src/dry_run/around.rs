//! The elements around the machine: their feeds, and what does not allow it to be faster.

use super::figures::QUANTITIES;
use super::row_name;
use nalgebra::Vector3;
use shared::geometry::angle;
use shared::io::AXES;
use shared::kinematics::{AxisLimits, Kinematics};
use shared::trajectory::{Element, Join, PathPoint, PathSpace, SHAPED, Tolerance, at_unit_speed};
use std::collections::VecDeque;
use std::f64::consts::PI;
use std::ops::Range;

/// Elements that are kept behind the machine: what it passes on short lines while it speeds up by a hundredth after a low
/// speed. Twice as many cost memory, with half of them a corner of very short lines may be forgotten.
const PASSED: usize = 32;
/// Places of an element that are looked at: curves between two of them bend evenly. Half as many miss the sharpest place
/// of a NURBS.
const PLACES: u32 = 8;
/// A limit explains a speed that is this part of what it allows, or more: the machine never uses a limit to the last, and the
/// output filter smooths short curves. Half of it takes a curve for the cause where a corner is one.
const EXPLAINS: f64 = 0.7;
/// What a rounded corner is long \[mm\]: within so much of the slowest place it is the cause, also of a rest. Twice as much
/// takes in the next corner of short lines, with half of it a rest just behind a corner has no cause.
const ROUNDED: f64 = 0.1;
/// Share of the tolerance that rounding has; the output filter has the rest (`FILTER_SHARE` of the planner). Half of it
/// makes corners 0.7 times as slow.
const ROUNDING: f64 = 0.6;
/// Places nearer to each other are one \[mm\].
const SAME: f64 = 1e-6;
/// The elements that the planner holds, and some that it has passed.
#[derive(Debug, Default)]
pub(super) struct Around {
    /// Where each ends \[mm\].
    elements: VecDeque<(f64, Element)>,
    start_s: f64,
    end_s: f64,
}

/// What an axis path is held to.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldTo<'a> {
    pub space: PathSpace,
    pub kinematics: &'a Kinematics,
    pub axes: &'a [AxisLimits; AXES],
    /// Length of the output filter, and by how much it is off: see [`shared::trajectory::PlanLimits`].
    pub filter: (f64, f64),
    /// Where the axes are, nearly (mm, rad).
    pub near: &'a [f64; AXES],
}

impl HeldTo<'_> {
    /// Speed past a corner with this `turn` \[rad\] that is rounded within `tolerance` \[mm\]: j·h/4 is cut off over a
    /// half-length h, at an acceleration of j·v²/(2h), j being the jump of the direction. An axis has its acceleration for
    /// it, or what its jerk comes to within the output filter.
    fn past_corner(&self, turn: f64, tolerance: f64) -> f64 {
        let linear = self.axes.iter().take(SHAPED);
        let acceleration = linear.map(|axis| axis.acceleration.min(axis.jerk * self.filter.0));
        let jump = 2.0 * libm::sin(0.5 * turn.min(PI));
        libm::sqrt(8.0 * ROUNDING * tolerance * acceleration.fold(f64::INFINITY, f64::min)) / jump
    }
}

impl Around {
    /// Of a path that begins at `s` \[mm\].
    pub fn from(s: f64) -> Self {
        Self {
            elements: VecDeque::new(),
            start_s: s,
            end_s: s,
        }
    }

    pub fn add(&mut self, element: &Element) {
        self.end_s += element.length;
        self.elements.push_back((self.end_s, element.clone()));
    }

    /// Whether the path begins at `s` or is to come to rest there.
    pub fn is_stop(&self, s: f64) -> bool {
        let stops = |(end, element): &(f64, Element)| element.join == Join::Stop && (end - s).abs() <= SAME;
        s - self.start_s <= SAME || self.elements.iter().any(stops)
    }

    fn index(&self, s: f64) -> usize {
        let index = self.elements.partition_point(|(end, _)| *end <= s);
        index.min(self.elements.len().saturating_sub(1))
    }

    /// Feed at `s`, which never decreases.
    pub fn feed_at(&mut self, s: f64) -> f64 {
        let index = self.index(s);
        self.elements.drain(..index.saturating_sub(PASSED));
        let here = self.elements.get(index.min(PASSED));
        here.map_or(0.0, |(_, element)| element.feed)
    }

    /// What does not let the machine be faster than `v` \[mm/s\] at `s` \[mm\].
    pub fn limit(&self, s: f64, v: f64, held: &HeldTo) -> String {
        // What it passes in the length of the output filter, it passes at one speed.
        let way = held.filter.0 * v + ROUNDED;
        let (from, to) = (s - way, s + way);
        let mut slowest = (f64::INFINITY, String::new());
        let mut by_jerk = (f64::INFINITY, String::new());
        let (mut turn, mut closest) = (0.0, f64::INFINITY);
        let mut before: Option<(PathPoint, Join)> = None;
        for (end, element) in self.elements.range(self.index(from)..=self.index(to)) {
            let start = end - element.length;
            let here = element.at(0.0);
            if let Some((before, _)) = &before
                && start >= from
                && start <= to
            {
                turn += angle(&direction(before), &direction(&here));
            }
            let tolerance = match (&element.join, &before) {
                (Join::Blend(tolerance), _) | (Join::Stop, Some((_, Join::Blend(tolerance)))) => {
                    Some(tolerance)
                }
                _ => None,
            };
            closest = tolerance.map_or(closest, |tolerance| closest.min(tolerance.position));
            let part = |place: u32| f64::from(place) / f64::from(PLACES);
            for place in 0..=PLACES {
                let along = from.max(start) + (to.min(*end) - from.max(start)) * part(place);
                let point = element.at((along - start).clamp(0.0, element.length));
                for (allowed, name) in allowed(&point, tolerance, held) {
                    if allowed < slowest.0 {
                        slowest = (allowed, name());
                    }
                }
                for (allowed, name) in allowed_in_passing(&point, held) {
                    if allowed < by_jerk.0 {
                        by_jerk = (allowed, name());
                    }
                }
            }
            before = Some((element.at(element.length), element.join));
        }
        if v >= EXPLAINS * slowest.0 {
            return slowest.1;
        }
        if v >= EXPLAINS * held.past_corner(turn, closest) {
            return format!("corner of {:.1}°", turn.to_degrees());
        }
        if v >= EXPLAINS * by_jerk.0 {
            return by_jerk.1;
        }
        "way to what follows: look-ahead, acceleration or jerk".to_owned()
    }
}

/// A speed along the path \[mm/s\], and what allows no more.
type Allowed = (f64, Box<dyn Fn() -> String>);

fn of_axis(speed: f64, quantity: usize, axis: usize) -> Allowed {
    let name = move || format!("{} of {}", QUANTITIES[quantity], row_name(axis + 1));
    (speed, Box::new(name))
}

/// Speeds that are allowed at `point`.
fn allowed(point: &PathPoint, tolerance: Option<&Tolerance>, held: &HeldTo) -> Vec<Allowed> {
    let mut all = Vec::new();
    if let Ok(axes) = at_unit_speed(held.kinematics, point, held.space, held.near) {
        for (axis, limits) in held.axes.iter().enumerate() {
            all.push(of_axis(limits.velocity / axes.velocity[axis].abs(), 0, axis));
            let bend = axes.acceleration[axis].abs();
            all.push(of_axis(libm::sqrt(limits.acceleration / bend), 1, axis));
        }
    }
    if let Some(tolerance) = tolerance {
        let norm = |channels: Range<usize>| {
            let square: f64 = point.second[channels].iter().map(|x| x * x).sum();
            libm::sqrt(square)
        };
        let accurate = |bend: f64, tolerance: f64| libm::sqrt(tolerance / (bend * held.filter.1));
        let position = tolerance.position;
        let name = move || format!("tolerance of {position} mm");
        all.push((accurate(norm(0..SHAPED), position), Box::new(name)));
        let attitude = norm(SHAPED..SHAPED + 3).max(norm(SHAPED + 3..SHAPED + 6));
        let degrees = tolerance.attitude.to_degrees();
        let name = move || format!("tolerance of {degrees:.3}° of the attitude");
        all.push((accurate(attitude, tolerance.attitude), Box::new(name)));
    }
    all
}

/// Speeds that are allowed at `point` if the bend there is passed within the length of the output filter: no acceleration
/// is come to then that takes longer at the jerk of an axis.
fn allowed_in_passing(point: &PathPoint, held: &HeldTo) -> Vec<Allowed> {
    let Ok(axes) = at_unit_speed(held.kinematics, point, held.space, held.near) else {
        return Vec::new();
    };
    let limits = held.axes.iter().enumerate();
    let speed = |axis: usize, jerk: f64| libm::sqrt(jerk * held.filter.0 / axes.acceleration[axis].abs());
    limits
        .map(|(axis, limits)| of_axis(speed(axis, limits.jerk), 2, axis))
        .collect()
}

fn direction(point: &PathPoint) -> Vector3<f64> {
    Vector3::new(point.first[0], point.first[1], point.first[2])
}
