//! Where the feed is kept for certain, by geometry: limits of axes, path and tolerance are far away at that speed.

use shared::io::AXES;
use shared::kinematics::{AxisLimits, AxisMotion, Kinematics};
use shared::trajectory::{
    CHANNELS, Element, Join, PathPoint, PathSpace, PlanLimits, SHAPED, Shape, Tolerance, at_unit_speed,
};

/// Distance of the places looked at \[mm\], and how many there are at least between the ends of what is not a line.
const STEP: f64 = 0.5;
const PLACES: f64 = 2.0;
/// The part of a limit that is used at most: of the speed,
const OF_SPEED: f64 = 0.9;
/// of the acceleration that bends take, and of the tolerance that the output filter takes of them,
const OF_BEND: f64 = 0.25;
/// and of the acceleration that speeding up as fast as counted on takes.
const OF_RAMP: f64 = 0.5;
/// Directions of elements that meet are no farther apart (of the axes, mm/mm and rad/mm): at any corner the planner may do more than
/// is felt.
const SAME_DIRECTION: f64 = 1e-6;
/// Time that the planner needs besides, to look ahead \[s\].
const LOOK_AHEAD_S: f64 = 0.3;
/// Feeds that differ by no more than this part are one: what is told of is a feed that is kept to less than 1 %.
const SAME_FEED: f64 = 0.002;
/// Elements that meet are no farther apart (mm, rad).
const SAME: f64 = 1e-6;
/// Tolerance of the attitude that goes with one of the position, where none is programmed \[rad/mm\].
const ATTITUDE_OF_POSITION: f64 = 0.02;

/// What is looked at, element after element, and what it is held to.
#[derive(Debug)]
pub(super) struct Calm<'a> {
    kinematics: &'a Kinematics,
    axes: &'a [AxisLimits; AXES],
    space: PathSpace,
    /// Length of the output filter \[s\], and its share of the tolerance for each unit of acceleration \[s²\].
    filter: f64,
    off: f64,
    tolerance: Tolerance,
    /// Acceleration along the path that is counted on \[mm/s²\].
    ramp: f64,
    /// Axes where the last element ends.
    near: [f64; AXES],
    before: End,
}

/// What the last element ends with.
#[derive(Debug)]
struct End {
    value: [f64; CHANNELS],
    velocity: [f64; AXES],
    feed: f64,
    stop: bool,
}

impl End {
    const REST: Self = Self {
        value: [0.0; CHANNELS],
        velocity: [0.0; AXES],
        feed: 0.0,
        stop: true,
    };
}

/// Acceleration along the path that is counted on \[mm/s²\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp(f64);

impl Ramp {
    /// Way from rest to a feed \[mm\], or back to rest, where it is kept for certain: with plenty to spare, also for the planner
    /// to look ahead.
    pub fn way(self, feed: f64) -> f64 {
        feed * (feed / self.0 + LOOK_AHEAD_S)
    }
}

impl<'a> Calm<'a> {
    /// From the axes `near` on.
    pub fn new(
        kinematics: &'a Kinematics,
        axes: &'a [AxisLimits; AXES],
        space: PathSpace,
        limits: &PlanLimits,
        near: &[f64; AXES],
    ) -> Self {
        Self {
            kinematics,
            axes,
            space,
            filter: limits.filter_s(),
            off: limits.filter_off(),
            tolerance: Tolerance {
                position: limits.tolerance,
                attitude: limits.tolerance * ATTITUDE_OF_POSITION,
            },
            ramp: OF_RAMP * limits.path_acceleration,
            near: *near,
            before: End::REST,
        }
    }

    /// How fast a feed is reached.
    pub fn ramp(&self) -> Ramp {
        Ramp(self.ramp)
    }

    /// Axes `s` \[mm\] after the start of `element`, where they are at `axes`.
    pub fn follow(&self, element: &Element, s: f64, axes: &[f64; AXES]) -> Option<[f64; AXES]> {
        let places = (s / STEP).ceil();
        let places = (1..=places as u32).map(|place| s * f64::from(place) / places);
        places.into_iter().try_fold(*axes, |near, s| {
            let motion = at_unit_speed(self.kinematics, &element.at(s), self.space, &near);
            motion.ok().map(|motion| motion.position)
        })
    }

    /// Axes where the last element seen ends (mm, rad).
    pub fn axes(&self) -> [f64; AXES] {
        self.near
    }

    /// Looks at the next element; whether nothing is felt where it begins, and whether its feed is kept on it.
    pub fn look(&mut self, element: &Element) -> (bool, bool) {
        let places = match element.shape {
            Shape::Line(_) => (element.length / STEP).ceil(),
            _ => (element.length / STEP).ceil().max(PLACES),
        };
        let tolerance = self.tolerance_of(element);
        let (mut joins, mut kept) = (false, true);
        let mut end = End::REST;
        for place in 0..=places as u32 {
            let point = element.at(element.length * f64::from(place) / places);
            let Ok(motion) = at_unit_speed(self.kinematics, &point, self.space, &self.near) else {
                (kept, end) = (false, End::REST);
                break;
            };
            if place == 0 {
                joins = self.goes_on(element, &point, &motion);
            }
            kept = kept && self.allows(&point, &motion, element.feed, &tolerance);
            self.near = motion.position;
            end = End {
                value: point.value,
                velocity: motion.velocity,
                feed: element.feed,
                stop: element.join == Join::Stop,
            };
        }
        self.before = end;
        (joins, kept)
    }

    fn tolerance_of(&self, element: &Element) -> Tolerance {
        match element.join {
            Join::Blend(tolerance) => Tolerance {
                position: tolerance.position.min(self.tolerance.position),
                attitude: tolerance.attitude.min(self.tolerance.attitude),
            },
            Join::Stop => self.tolerance,
        }
    }

    /// Nothing is felt where an element begins.
    fn goes_on(&self, element: &Element, point: &PathPoint, motion: &AxisMotion) -> bool {
        let before = &self.before;
        let near = |(here, there): (&f64, &f64)| (here - there).abs() <= SAME;
        let turns = motion.velocity.iter().zip(&before.velocity);
        !before.stop
            && (element.feed - before.feed).abs() <= SAME_FEED * before.feed
            && point.value.iter().zip(&before.value).all(near)
            && turns
                .into_iter()
                .all(|(to, from)| (to - from).abs() <= SAME_DIRECTION)
    }

    /// All limits are far away at a place.
    fn allows(&self, point: &PathPoint, motion: &AxisMotion, feed: f64, tolerance: &Tolerance) -> bool {
        let square = feed * feed;
        let axes = self
            .axes
            .iter()
            .zip(motion.velocity.iter().zip(&motion.acceleration));
        let norm = |channels: std::ops::Range<usize>| {
            let square: f64 = point.second[channels].iter().map(|x| x * x).sum();
            libm::sqrt(square)
        };
        let attitude = norm(SHAPED..SHAPED + 3).max(norm(SHAPED + 3..SHAPED + 6));
        axes.into_iter().all(|(axis, (first, second))| {
            first.abs() * feed <= OF_SPEED * axis.velocity
                && first.abs() * self.ramp <= OF_RAMP * axis.acceleration
                && second.abs() * square <= OF_BEND * axis.acceleration.min(axis.jerk * self.filter)
        }) && norm(0..SHAPED) * square * self.off <= OF_BEND * tolerance.position
            && attitude * square * self.off <= OF_BEND * tolerance.attitude
    }
}
