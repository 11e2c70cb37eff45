//! Demands of a path on the axes and V slides, and the speed that they allow.

use super::shape::Shape;
use super::targets::ROTARY;
use super::{Bound, FeedTooHigh, PathError, PlannedPath, Planner, TooFast};
use config::machine::MachineFile;
use config::table::FARTHEST_MM;
use nc::SourcePosition;
use shared::config::SlideConfig;
use shared::io::{AXES, SIDES};
use shared::kinematics::{AXIS_UNIT, AxisLimits};
use shared::parameter::ParameterError;
use shared::trajectory::{CHANNELS, Knot, PathPoint, PathSpace, SpeedLimits};

/// The axes, then the extensions of the V slides.
pub(super) const DRIVES: usize = AXES + SIDES;
const DRIVE_NAMES: [&str; DRIVES] = ["X", "Y", "Z", "A", "B", "C", "V1", "V2"];
/// Distance of the places where a path is checked \[mm\], and how many there are at least.
pub(super) const CHECK_STEP: f64 = 0.5;
const CHECK_COUNT: usize = 200;
/// What an axis may move more between two such places than its rates say \[mm or °\].
const JUMP: f64 = 1.0;
/// What is no more than this outside the travel of an axis \[mm or °\], or faster than it allows, is rounding.
pub(super) const BEYOND: f64 = 1e-6;
pub(super) const TOO_FAST: f64 = 1.0 + 1e-9;
/// Fastest rapid \[mm/s\], for moves that need next to no motion.
const FASTEST: f64 = 1000.0;
/// Part of an axis' acceleration that a curved path, or a change at a join, may spend on that.
pub(super) const CURVATURE_SHARE: f64 = 0.5;

/// Limits of an axis or a V slide in inner units.
#[derive(Clone, Copy, Debug)]
pub(super) struct DriveLimits {
    min: f64,
    max: f64,
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
    /// The boards plan no jerk for slides: infinite there.
    jerk: f64,
    /// Inner units in one mm or degree.
    pub(super) unit: f64,
}

impl DriveLimits {
    /// A slide that the machine does not have stands at 0.
    const NO_SLIDE: Self = Self {
        min: 0.0,
        max: 0.0,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        unit: 1.0,
    };

    fn of_slide(slide: &SlideConfig) -> Self {
        Self {
            min: slide.travel_min_mm,
            max: slide.travel_max_mm,
            velocity: slide.max_velocity_mm_s,
            acceleration: slide.max_acceleration_mm_s2,
            jerk: f64::INFINITY,
            unit: 1.0,
        }
    }

    /// Lowest and highest position \[mm or °\].
    pub(super) fn travel(&self) -> [f64; 2] {
        [self.min / self.unit, self.max / self.unit]
    }

    /// Those of all drives of `machine`; errors name the parameter.
    pub(super) fn build_all(machine: &MachineFile) -> Result<[Self; DRIVES], ParameterError> {
        let axes = AxisLimits::build_all(&machine.motion.axes)?;
        Ok(std::array::from_fn(|i| match axes.get(i) {
            Some(axis) => Self {
                min: axis.min,
                max: axis.max,
                velocity: axis.velocity,
                acceleration: axis.acceleration,
                jerk: axis.jerk,
                unit: AXIS_UNIT[i],
            },
            None => match &machine.tracking {
                Some(unit) => {
                    (unit.board.slides.get(2 * (i - AXES) + 1)).map_or(Self::NO_SLIDE, Self::of_slide)
                }
                None => Self::NO_SLIDE,
            },
        }))
    }
}

/// The worst of several errors, which is reported.
#[derive(Debug, Default)]
pub(super) struct Worst(Option<(f64, PathError)>);

impl Worst {
    fn see(&mut self, size: f64, error: impl FnOnce() -> PathError) {
        if self.0.as_ref().is_none_or(|(largest, _)| size > *largest) {
            self.0 = Some((size, error()));
        }
    }

    /// The worst as an error, if anything is wrong.
    pub(super) fn found(self) -> Result<(), PathError> {
        self.0.map_or(Ok(()), |(_, error)| Err(error))
    }
}

/// What a path asks of the drives at one place: position and derivatives over s.
pub(super) struct Demand {
    pub(super) s: f64,
    position: [f64; DRIVES],
    first: [f64; DRIVES],
    second: [f64; DRIVES],
}

impl Planner {
    /// What the path from `from` asks of the drives at many places.
    pub(super) fn demands(
        &self,
        planned: &PlannedPath,
        shape: &Shape,
        from: &[f64; AXES],
    ) -> Result<Vec<Demand>, PathError> {
        check_length(shape)?;
        let path = planned.path();
        let mut near = *from;
        let mut demands = Vec::new();
        for s in places(shape) {
            if let Some(point) = path.at(s) {
                let (demand, axes) = self.demand(s, &point, planned.space, shape.place(s), &near)?;
                near = axes;
                if let Some(before) = demands.last() {
                    check_continuous(before, &demand, shape.place(s))?;
                }
                demands.push(demand);
            }
        }
        Ok(demands)
    }

    pub(super) fn demand(
        &self,
        s: f64,
        point: &PathPoint,
        space: PathSpace,
        place: SourcePosition,
        near: &[f64; AXES],
    ) -> Result<(Demand, [f64; AXES]), PathError> {
        let axes = match space {
            PathSpace::Tool => {
                let (pose, motion) = point
                    .pose_in_motion()
                    .map_err(|source| PathError::Pose { place, source })?;
                self.kinematics
                    .inverse_motion(&pose, &motion, near)
                    .map_err(|source| PathError::Kinematics { place, source })?
            }
            PathSpace::Axes => point.axes(),
        };
        // The extensions are the last channels of a path.
        let join = |axes: &[f64; AXES], channels: &[f64; CHANNELS]| {
            std::array::from_fn(|i| axes.get(i).copied().unwrap_or(channels[CHANNELS - DRIVES + i]))
        };
        let demand = Demand {
            s,
            position: join(&axes.position, &point.value),
            first: join(&axes.velocity, &point.first),
            second: join(&axes.acceleration, &point.second),
        };
        Ok((demand, axes.position))
    }

    /// Names the drive that leaves its travel furthest in its own units.
    pub(super) fn check_travel(&self, demands: &[Demand], shape: &Shape) -> Result<(), PathError> {
        let mut worst = Worst::default();
        for demand in demands {
            self.see_travel(demand, shape.place(demand.s), &mut worst);
        }
        worst.found()
    }

    /// Tells `worst` how far the drives are outside their travel, in their own units.
    pub(super) fn see_travel(&self, demand: &Demand, place: SourcePosition, worst: &mut Worst) {
        for (i, limits) in self.drives.iter().enumerate() {
            let position = demand.position[i];
            let beyond = (position - limits.max).max(limits.min - position) / limits.unit;
            if beyond > BEYOND {
                worst.see(beyond, || PathError::Travel {
                    place,
                    axis: DRIVE_NAMES[i],
                    position: position / limits.unit,
                    beyond,
                    min: round_for_people(limits.min / limits.unit),
                    max: round_for_people(limits.max / limits.unit),
                    unit: if ROTARY.contains(&i) { "°" } else { "mm" },
                });
            }
        }
    }

    /// Tells `too_fast` where a speed \[mm/s\], a sixtieth of F in its unit, is more than a drive allows, with a beam `on`
    /// or without.
    pub(super) fn see_feed(
        &self,
        demand: &Demand,
        (speed, unit): (f64, &'static str),
        place: SourcePosition,
        on: bool,
        too_fast: &mut TooFast,
    ) {
        for i in 0..DRIVES {
            for (largest, quantity) in self.allowed(demand, i) {
                if speed / largest <= TOO_FAST {
                    continue;
                }
                let found = FeedTooHigh {
                    place,
                    feed: speed * 60.0,
                    largest: largest * 60.0,
                    unit,
                    axis: DRIVE_NAMES[i],
                    quantity,
                };
                if i < AXES {
                    too_fast.see_axis(found, on);
                } else {
                    too_fast.see_slide(&found);
                }
            }
        }
    }

    /// The highest speed along the path at which no axis is faster there than it can be \[mm/s\].
    pub(super) fn fastest(&self, demand: &Demand) -> f64 {
        let axes = self.drives.iter().zip(demand.first).take(AXES);
        axes.map(|(limits, first)| limits.velocity / first.abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// Speed, acceleration and jerk along a path with these `speeds` on the way to each target, of which the first one is
    /// given: |q′|·F ≤ q̇max and |q″|·F² + |q′|·a ≤ q̈max (mathematics 0.3), F being less where an axis does not allow it.
    ///
    /// The acceleration a along the path is that of the machine file, less where it would take more than half of
    /// what a drive has; so is the jerk, where it would take more than all.
    pub(super) fn feed_limits(&self, demands: &[Demand], shape: &Shape, speeds: &[f64]) -> SpeedLimits {
        let mut acceleration = self.planning.path_acceleration_mm_s2;
        let mut jerk = self.planning.path_jerk_mm_s3;
        for demand in demands {
            let allowed = (0..DRIVES).flat_map(|i| self.allowed(demand, i));
            let programmed = speeds[shape.target(demand.s)];
            let speed = allowed.fold(programmed, |speed, (largest, _)| speed.min(largest));
            for (i, limits) in self.drives.iter().enumerate() {
                let (first, second) = (demand.first[i].abs(), demand.second[i].abs());
                acceleration = acceleration.min((limits.acceleration - second * speed * speed) / first);
                jerk = jerk.min(limits.jerk / first);
            }
        }
        SpeedLimits {
            velocity: speeds[0],
            acceleration,
            jerk,
        }
    }

    /// Largest speeds along the path that drive `i` allows at a place of a feed, by its speed and by its
    /// acceleration \[mm/s\].
    fn allowed(&self, demand: &Demand, i: usize) -> [(f64, &'static str); 2] {
        let limits = &self.drives[i];
        let (first, second) = (demand.first[i].abs(), demand.second[i].abs());
        let along = first * self.planning.path_acceleration_mm_s2;
        let rest = (limits.acceleration - along).max(CURVATURE_SHARE * limits.acceleration);
        [
            (limits.velocity / first, "speed"),
            (libm::sqrt(rest / second), "acceleration"),
        ]
    }

    /// Where the drives allow the least speed along a feed.
    pub(super) fn bound(&self, demands: &[Demand]) -> Option<Bound> {
        let bounds = demands.iter().filter_map(|demand| self.bound_at(demand));
        bounds.min_by(|a, b| a.largest_mm_s.total_cmp(&b.largest_mm_s))
    }

    /// What the drives allow at a place of a feed, if they do not allow everything.
    pub(super) fn bound_at(&self, demand: &Demand) -> Option<Bound> {
        let bounds = (0..DRIVES).flat_map(|i| {
            let bound = move |(largest, quantity)| Bound {
                largest_mm_s: largest,
                axis: DRIVE_NAMES[i],
                quantity,
                s_mm: demand.s,
            };
            self.allowed(demand, i).map(bound)
        });
        bounds
            .filter(|bound| bound.largest_mm_s.is_finite())
            .min_by(|a, b| a.largest_mm_s.total_cmp(&b.largest_mm_s))
    }

    /// As fast as the machine's rapid fraction of every limit allows.
    pub(super) fn rapid_limits(&self, demands: &[Demand]) -> SpeedLimits {
        let part = self.planning.rapid_fraction;
        let pairs = || demands.iter().flat_map(|d| (0..DRIVES).map(move |i| (d, i)));
        let velocity = pairs()
            .map(|(d, i)| {
                let limits = &self.drives[i];
                let by_speed = part * limits.velocity / d.first[i].abs();
                let share = CURVATURE_SHARE * part * limits.acceleration;
                by_speed.min(libm::sqrt(share / d.second[i].abs()))
            })
            .fold(FASTEST, f64::min);
        let acceleration = pairs()
            .map(|(d, i)| {
                let spent = d.second[i].abs() * velocity * velocity;
                (part * self.drives[i].acceleration - spent) / d.first[i].abs()
            })
            .fold(10.0 * FASTEST, f64::min);
        let jerk = pairs()
            .map(|(d, i)| part * self.drives[i].jerk / d.first[i].abs())
            .fold(100.0 * FASTEST, f64::min);
        SpeedLimits {
            velocity,
            acceleration,
            jerk,
        }
    }
}

/// Whether the axes go from one place to the next, as their rates say, and do not jump.
pub(super) fn check_continuous(from: &Demand, to: &Demand, place: SourcePosition) -> Result<(), PathError> {
    for (axis, unit) in AXIS_UNIT.into_iter().enumerate() {
        let fastest = from.first[axis].abs().max(to.first[axis].abs());
        let way = (to.position[axis] - from.position[axis]).abs();
        if way > 2.0 * fastest * (to.s - from.s) + JUMP * unit {
            return Err(PathError::Jump {
                place,
                axis: DRIVE_NAMES[axis],
                from: from.position[axis] / unit,
                to: to.position[axis] / unit,
            });
        }
    }
    Ok(())
}

/// What is longer would be looked at for ever, and what has no length that is a number cannot be looked at.
fn check_length(shape: &Shape) -> Result<(), PathError> {
    let length = shape.knots.last().map_or(0.0, |knot| knot.s_mm);
    let finite = |knot: &Knot| knot.value.iter().chain(&knot.slope).all(|x| x.is_finite());
    if length <= FARTHEST_MM && shape.knots.iter().all(finite) {
        return Ok(());
    }
    let place = shape.place(length);
    Err(PathError::TooFar { place, length })
}

/// Where a path is looked at: evenly, in the middle of every span, and at every target, in order.
fn places(shape: &Shape) -> Vec<f64> {
    let length = shape.knots.last().map_or(0.0, |knot| knot.s_mm);
    let count = CHECK_COUNT.max((length / CHECK_STEP).ceil() as usize);
    let mut places: Vec<f64> = (0..=count).map(|i| length * i as f64 / count as f64).collect();
    places.extend(
        shape
            .knots
            .windows(2)
            .map(|span| (span[0].s_mm + span[1].s_mm) / 2.0),
    );
    places.extend(shape.targets.iter().map(|goal| goal.s));
    places.sort_by(f64::total_cmp);
    places
}

/// The axes at a target, which is one of the places of `demands` (mm, rad).
pub(super) fn axes_at(demands: &[Demand], s: f64) -> [f64; AXES] {
    let after = demands.partition_point(|demand| demand.s < s);
    let demand = &demands[after.min(demands.len() - 1)];
    std::array::from_fn(|i| demand.position[i])
}

/// Degrees that went through radians print without their last bits.
fn round_for_people(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}
