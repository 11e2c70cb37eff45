//! What a path asks of the axes and V slides, and the speed that they allow.

use super::shape::Shape;
use super::{PathError, PlannedPath, Planner};
use crate::machine::MachineFile;
use shared::io::{AXES, SIDES};
use shared::kinematics::{AXIS_UNIT, AxisLimits};
use shared::parameter::ParameterError;
use shared::tracking::SlideConfig;
use shared::trajectory::{CHANNELS, PathPoint, PathSpace, SpeedLimits};
use std::ops::Range;

/// The axes, then the extensions of the V slides.
pub(super) const DRIVES: usize = AXES + SIDES;
const DRIVE_NAMES: [&str; DRIVES] = ["X", "Y", "Z", "A", "B", "C", "V1", "V2"];
const ROTARY: Range<usize> = 3..AXES;
/// Distance of the places where a path is checked \[mm\], and how many there are at least.
const CHECK_STEP: f64 = 0.5;
const CHECK_COUNT: usize = 200;
/// Fastest rapid \[mm/s\], for moves that need next to no motion.
const FASTEST: f64 = 1000.0;
/// Part of an axis' acceleration that a curved rapid may spend on its curvature.
const CURVATURE_SHARE: f64 = 0.5;

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
                Some(unit) => Self::of_slide(&unit.board.slides[2 * (i - AXES) + 1]),
                None => Self::NO_SLIDE,
            },
        }))
    }
}

/// What a path asks of the drives at one place: position and derivatives over s.
pub(super) struct Demand {
    s: f64,
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
        let (path, length) = (planned.path(), planned.length_mm());
        let count = CHECK_COUNT.max((length / CHECK_STEP).ceil() as usize);
        let mut near = *from;
        let mut demands = Vec::with_capacity(count + 1);
        for i in 0..=count {
            let s = length * i as f64 / count as f64;
            if let Some(point) = path.at(s) {
                let (demand, axes) = self.demand(s, &point, planned.space, shape.line(s), &near)?;
                near = axes;
                demands.push(demand);
            }
        }
        Ok(demands)
    }

    fn demand(
        &self,
        s: f64,
        point: &PathPoint,
        space: PathSpace,
        line: u32,
        near: &[f64; AXES],
    ) -> Result<(Demand, [f64; AXES]), PathError> {
        let axes = match space {
            PathSpace::Tool => {
                let (pose, motion) = point
                    .pose_in_motion()
                    .map_err(|source| PathError::Pose { line, source })?;
                self.kinematics
                    .inverse_motion(&pose, &motion, near)
                    .map_err(|source| PathError::Kinematics { line, source })?
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
        let outside = demands.iter().flat_map(|demand| {
            (0..DRIVES).map(move |i| {
                let (limits, position) = (&self.drives[i], demand.position[i]);
                let beyond = (position - limits.max).max(limits.min - position) / limits.unit;
                (beyond, i, position / limits.unit, demand.s)
            })
        });
        match outside.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((beyond, i, position, s)) if beyond > 1e-6 => {
                let limits = &self.drives[i];
                Err(PathError::Travel {
                    line: shape.line(s),
                    axis: DRIVE_NAMES[i],
                    position,
                    beyond,
                    min: round_for_people(limits.min / limits.unit),
                    max: round_for_people(limits.max / limits.unit),
                    unit: if ROTARY.contains(&i) { "°" } else { "mm" },
                })
            }
            _ => Ok(()),
        }
    }

    /// The programmed speed, if every drive can follow: |q′|·F ≤ q̇max and |q″|·F² + |q′|·a ≤ q̈max (SPEC 0.3).
    pub(super) fn feed_limits(
        &self,
        demands: &[Demand],
        shape: &Shape,
        speed_mm_s: f64,
    ) -> Result<SpeedLimits, PathError> {
        if !(speed_mm_s.is_finite() && speed_mm_s > 0.0) {
            return Err(PathError::NoFeed(speed_mm_s * 60.0));
        }
        let along = self.planning.path_acceleration_mm_s2;
        let mut lowest = (f64::INFINITY, 0, "speed", 0.0);
        for demand in demands {
            for (i, limits) in self.drives.iter().enumerate() {
                let (first, second) = (demand.first[i].abs(), demand.second[i].abs());
                let by_speed = limits.velocity / first;
                let rest = (limits.acceleration - first * along).max(0.0);
                let by_acceleration = libm::sqrt(rest / second);
                for (largest, quantity) in [(by_speed, "speed"), (by_acceleration, "acceleration")] {
                    if largest < lowest.0 {
                        lowest = (largest, i, quantity, demand.s);
                    }
                }
            }
        }
        let (largest, drive, quantity, s) = lowest;
        if speed_mm_s > largest * (1.0 + 1e-9) {
            return Err(PathError::Feed {
                line: shape.line(s),
                feed: speed_mm_s * 60.0,
                largest: largest * 60.0,
                axis: DRIVE_NAMES[drive],
                quantity,
            });
        }
        Ok(SpeedLimits {
            velocity: speed_mm_s,
            acceleration: along,
            jerk: self.planning.path_jerk_mm_s3,
        })
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

/// Degrees that went through radians print without their last bits.
fn round_for_people(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}
