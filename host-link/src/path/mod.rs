//! From program paths to what the boards run: knots, events and limits, checked against the machine.

mod error;
mod limits;
mod shape;
#[cfg(test)]
mod tests;

pub use error::PathError;

use crate::machine::{MachineFile, PlanningConfig};
use crate::nc::{Motion, Program, ProgramEvent, ProgramPath, Target, Tip};
use limits::{DRIVES, DriveLimits};
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::kinematics::{AXIS_UNIT, Kinematics};
use shared::motion::MAX_EVENTS;
use shared::parameter::ParameterError;
use shared::protocol::{Knot, PathAction, PathEvent};
use shared::trajectory::{Path, SpeedLimits, SpeedProfile};

/// Most knots of one path: what the boards hold.
pub const CAPACITY: usize = 512;

/// A path that the boards can run.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPath {
    /// Rapid or feed.
    pub motion: Motion,
    /// Value and slope of every channel, s from 0.
    pub knots: Vec<Knot>,
    /// What happens on the way, s not decreasing.
    pub events: Vec<PathEvent>,
    /// Speed, acceleration and jerk along the path.
    pub limits: SpeedLimits,
    /// Largest | |dP/ds| − 1 | of a feed path: how exact its speed is.
    pub speed_error: f64,
}

impl PlannedPath {
    /// Length \[mm\].
    pub fn length_mm(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.s_mm)
    }

    /// Time from rest to rest \[s\].
    pub fn duration_s(&self) -> f64 {
        SpeedProfile::rest_to_rest(0.0, self.length_mm(), &self.limits).map_or(0.0, |p| p.duration())
    }

    /// From where the first beam goes on to where the last one goes off \[mm\]; `None` without beams.
    pub fn weld(&self) -> Option<(f64, f64)> {
        let places = |wanted: bool| {
            self.events
                .iter()
                .filter(move |event| matches!(event.action, PathAction::Beam { on, .. } if on == wanted))
                .map(|event| event.s_mm)
        };
        let start = places(true).next()?;
        Some((start, places(false).next_back().unwrap_or(self.length_mm())))
    }

    /// The path as the boards see it.
    pub fn path(&self) -> Box<Path<CAPACITY>> {
        let mut path = Box::new(Path::new());
        for knot in &self.knots {
            path.push(*knot).expect("planned knots are in order and fit");
        }
        path
    }
}

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

    /// All paths of a program; the first starts at `from`. `speed_mm_s` replaces the programmed feed.
    pub fn program(
        &self,
        program: &Program,
        from: &Tip,
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        let mut from = *from;
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

    /// From `from` up to the safe height and on to the park position of the machine.
    pub fn park(&self, from: &Tip) -> Result<Vec<PlannedPath>, PathError> {
        let mut up = *from;
        up.position_mm[2] = up.position_mm[2].max(self.planning.safe_height_mm);
        let park = self.tip(&self.planning.park_axes());
        let mut above = park;
        above.position_mm[2] = up.position_mm[2];
        let mut from = *from;
        let mut paths = Vec::new();
        for tip in [up, above, park] {
            if tip != from {
                paths.push(self.path(&rapid(tip), &from, None)?);
                from = tip;
            }
        }
        Ok(paths)
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
            limits: SpeedLimits {
                velocity: 0.0,
                acceleration: 0.0,
                jerk: 0.0,
            },
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
        let demands = self.demands(&planned, &shape, from)?;
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

/// A path of one G0 to `tip`.
fn rapid(tip: Tip) -> ProgramPath {
    ProgramPath {
        motion: Motion::Rapid,
        targets: vec![Target { tip, line: 0 }],
        events: Vec::new(),
    }
}

/// The last target of a path, which has at least one.
fn end_of(path: &ProgramPath) -> &Target {
    &path.targets[path.targets.len() - 1]
}
