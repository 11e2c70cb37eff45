//! From program paths to what the boards run: knots, events and limits, checked against the machine.

mod error;
mod limits;
mod planned;
mod shape;
#[cfg(test)]
mod tests;

pub use error::PathError;
pub use planned::PlannedPath;

use crate::machine::{MachineFile, PlanningConfig};
use crate::nc::{Motion, Program, ProgramEvent, ProgramPath, Target, Tip};
use limits::{DRIVES, DriveLimits};
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::kinematics::{AXIS_UNIT, Kinematics};
use shared::motion::MAX_EVENTS;
use shared::parameter::ParameterError;
use shared::protocol::{PathAction, PathEvent};
use shared::trajectory::{PathSpace, SpeedLimits};

/// Most knots of one path: what the boards hold.
pub const CAPACITY: usize = 512;

/// Plans program paths for one machine.
#[derive(Clone, Debug)]
pub struct Planner {
    kinematics: Kinematics,
    drives: [DriveLimits; DRIVES],
    /// Of each beam \[W\].
    largest_power: [f64; SIDES],
    planning: PlanningConfig,
}

impl Planner {
    /// A planner for `machine`; errors name the parameter.
    pub fn build(machine: &MachineFile) -> Result<Self, ParameterError> {
        Ok(Self {
            drives: DriveLimits::build_all(machine)?,
            kinematics: machine.motion.kinematics()?,
            largest_power: machine
                .motion
                .beams
                .clone()
                .map(|beam| beam.map_or(0.0, |beam| beam.power_at_10v_w)),
            planning: machine.planning.clone(),
        })
    }

    /// Kinematics of the machine.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Where the tip is when the axes stand at `axes` (mm, degrees); V slides at zero.
    pub fn tip(&self, axes: &[f64; AXES]) -> Tip {
        let inner = std::array::from_fn(|i| axes[i] * AXIS_UNIT[i]);
        let pose = self.kinematics.forward(&inner);
        Tip {
            position_mm: pose.position.into(),
            angles_deg: [axes[3], axes[4], axes[5]],
            extension_mm: [0.0; SIDES],
        }
    }

    /// The pose of `tip` (SPEC 0.2).
    pub fn pose(&self, tip: &Tip) -> Pose {
        let [a, b, c] = tip.angles_deg.map(f64::to_radians);
        Pose {
            position: tip.position_mm.into(),
            ..self.kinematics.forward(&[0.0, 0.0, 0.0, a, b, c])
        }
    }

    /// All paths of a program; the first starts where the axes stand at `from` (mm, degrees). `speed_mm_s`
    /// replaces the programmed feed.
    pub fn program(
        &self,
        program: &Program,
        from: &[f64; AXES],
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        let mut from = self.tip(from);
        program
            .paths
            .iter()
            .map(|path| {
                let planned = self.path(path, &from, speed_mm_s)?;
                from = end_of(path).tip;
                Ok(planned)
            })
            .collect()
    }

    /// From the axes `from` (mm, degrees) to the park position of the machine, in axis space: first the axes that
    /// go first, then all.
    pub fn park(&self, from: &[f64; AXES]) -> Result<Vec<PlannedPath>, PathError> {
        let park = self.planning.park_axes();
        let mut first = *from;
        for axis in &self.planning.park_first {
            let axis = *axis as usize;
            first[axis] = park[axis];
        }
        let inner = |axes: &[f64; AXES]| std::array::from_fn(|i| axes[i] * AXIS_UNIT[i]);
        [(from, &first), (&first, &park)]
            .into_iter()
            .filter(|(from, to)| from != to)
            .map(|(from, to)| self.axes_path(&inner(from), &inner(to)))
            .collect()
    }

    /// A rapid on the straight line of axis space between two places (mm, rad).
    fn axes_path(&self, from: &[f64; AXES], to: &[f64; AXES]) -> Result<PlannedPath, PathError> {
        let shape = Self::axes_line(from, to, &[0.0; SIDES], 0);
        let mut planned = PlannedPath {
            motion: Motion::Rapid,
            space: PathSpace::Axes,
            dwell_before_s: 0.0,
            limits: UNLIMITED,
            events: Vec::new(),
            speed_error: 0.0,
            knots: shape.knots.clone(),
        };
        let demands = self.demands(&planned, &shape, from)?;
        self.check_travel(&demands, &shape)?;
        planned.limits = self.rapid_limits(&demands);
        Ok(planned)
    }

    /// One path, which starts at `from`. `speed_mm_s` replaces the programmed feed.
    pub fn path(
        &self,
        path: &ProgramPath,
        from: &Tip,
        speed_mm_s: Option<f64>,
    ) -> Result<PlannedPath, PathError> {
        let shape = self.shape(path, from)?;
        if shape.knots.len() > CAPACITY {
            return Err(PathError::TooLong {
                line: path.targets[0].line,
                knots: shape.knots.len(),
            });
        }
        if path.events.len() > MAX_EVENTS {
            return Err(PathError::TooManyEvents {
                line: path.targets[0].line,
                events: path.events.len(),
            });
        }
        self.check_powers(&path.events)?;
        let mut planned = PlannedPath {
            motion: path.motion,
            space: PathSpace::Tool,
            dwell_before_s: path.dwell_before_s,
            limits: UNLIMITED,
            events: path
                .events
                .iter()
                .map(|event| PathEvent {
                    s_mm: event
                        .with_target
                        .checked_sub(1)
                        .map_or(0.0, |i| shape.targets[i].0),
                    action: event.action,
                })
                .collect(),
            speed_error: shape.speed_error,
            knots: shape.knots.clone(),
        };
        let [a, b, c] = from.angles_deg.map(f64::to_radians);
        let near = [0.0, 0.0, 0.0, a, b, c];
        let demands = self.demands(&planned, &shape, &near)?;
        self.check_travel(&demands, &shape)?;
        planned.limits = match path.motion {
            Motion::Rapid => self.rapid_limits(&demands),
            Motion::Feed(mm_min) => {
                self.feed_limits(&demands, &shape, speed_mm_s.unwrap_or(mm_min / 60.0))?
            }
        };
        Ok(planned)
    }

    fn check_powers(&self, events: &[ProgramEvent]) -> Result<(), PathError> {
        for event in events {
            let PathAction::Power { side, watt } = event.action else {
                continue;
            };
            let largest = self.largest_power[usize::from(side)];
            if watt > largest {
                let line = event.line;
                return Err(PathError::Power {
                    line,
                    side,
                    watt,
                    largest,
                });
            }
        }
        Ok(())
    }
}

/// Stands in a path until its limits are known.
const UNLIMITED: SpeedLimits = SpeedLimits {
    velocity: f64::INFINITY,
    acceleration: f64::INFINITY,
    jerk: f64::INFINITY,
};

/// The last target of a path, which has at least one.
fn end_of(path: &ProgramPath) -> &Target {
    &path.targets[path.targets.len() - 1]
}
