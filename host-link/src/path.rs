//! From program paths to what the boards run: knots, events and limits, checked against the machine.

use crate::curve::{Curve, distance};
use crate::machine::{MachineFile, PlanningConfig};
use crate::nc::{Motion, Program, ProgramPath, Target, Tip};
use nalgebra::Vector3;
use shared::geometry::{AttitudeError, Pose, PoseError, SplineError, angle, interpolate};
use shared::io::{AXES, SIDES};
use shared::kinematics::{AXIS_UNIT, AxisLimits, DualBeam, KinematicsError};
use shared::motion::MAX_EVENTS;
use shared::parameter::ParameterError;
use shared::protocol::{Knot, PathAction, PathEvent};
use shared::trajectory::{CHANNELS, Path, PathPoint, SpeedLimits, SpeedProfile};
use std::ops::Range;
use thiserror::Error;

/// Most knots of one path: what the boards hold.
pub const CAPACITY: usize = 512;
/// Largest turn of the head between two knots of a straight move \[rad\].
const STRAIGHT_TURN: f64 = 0.05;
/// Largest angle between two chords of a path \[rad\]: a spline through a sharper corner would swing out.
const MAX_CORNER: f64 = 0.35;
/// Distance of the places where a path is checked \[mm\], and how many there are at least.
const CHECK_STEP: f64 = 0.5;
const CHECK_COUNT: usize = 200;
/// Path length of a move that turns or stretches without moving the tip \[mm per degree or mm\].
const LENGTH_PER_TURN: f64 = 1.0;
/// Shortest path \[mm\] and fastest rapid \[mm/s\], for moves that need next to no motion.
const SHORTEST: f64 = 1e-3;
const FASTEST: f64 = 1000.0;
/// Part of an axis' acceleration that a curved rapid may spend on its curvature.
const CURVATURE_SHARE: f64 = 0.5;
/// The axes, then the extensions of the V slides.
const DRIVES: usize = AXES + SIDES;
const DRIVE_NAMES: [&str; DRIVES] = ["X", "Y", "Z", "A", "B", "C", "V1", "V2"];
const ROTARY: Range<usize> = 3..AXES;

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

/// Why a program path cannot be run on this machine.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PathError {
    /// An axis would leave its travel.
    #[error(
        "line {line}: axis {axis} would have to go to {position:.3}, {beyond:.3} beyond its travel ({min}…{max} {unit})"
    )]
    Travel {
        /// Line of the program.
        line: u32,
        /// Axis or V slide.
        axis: &'static str,
        /// Where it would go.
        position: f64,
        /// By how much too far.
        beyond: f64,
        /// Travel.
        min: f64,
        /// Travel.
        max: f64,
        /// mm or °.
        unit: &'static str,
    },
    /// An axis cannot follow that fast.
    #[error(
        "line {line}: the feed of {feed:.0} mm/min is too high, the {quantity} of {axis} allows {largest:.0} mm/min"
    )]
    Feed {
        /// Line of the program.
        line: u32,
        /// Wanted \[mm/min\].
        feed: f64,
        /// Possible \[mm/min\].
        largest: f64,
        /// Axis or V slide.
        axis: &'static str,
        /// Speed or acceleration.
        quantity: &'static str,
    },
    /// The speed must be positive.
    #[error("a feed of {0} mm/min is not possible")]
    NoFeed(f64),
    /// G1 without travel of the tip.
    #[error("line {line}: G1 must move the tip; turn the head alone with G0")]
    NoTravel {
        /// Line of the program.
        line: u32,
    },
    /// A corner within a smooth path.
    #[error(
        "line {line}: a corner of {degrees:.0}° within a path, which must be smooth; stop at the corner with G61.1"
    )]
    Corner {
        /// Line of the program.
        line: u32,
        /// Its angle.
        degrees: f64,
    },
    /// Two points between which the head would turn by half a turn.
    #[error("line {line}: the head cannot turn there: {source}")]
    Attitude {
        /// Line of the program.
        line: u32,
        /// Why.
        source: AttitudeError,
    },
    /// The pose has no solution.
    #[error("line {line}: the machine cannot take this pose: {source}")]
    Kinematics {
        /// Line of the program.
        line: u32,
        /// Why.
        source: KinematicsError,
    },
    /// The channels are no pose.
    #[error("line {line}: the path is no pose there: {source}")]
    Pose {
        /// Line of the program.
        line: u32,
        /// Why.
        source: PoseError,
    },
    /// No spline through the points.
    #[error("line {line}: no smooth curve through these points: {source}")]
    Spline {
        /// Line of the program.
        line: u32,
        /// Why.
        source: SplineError,
    },
    /// More knots than the boards hold.
    #[error("line {line}: the path has {knots} points, the boards hold {CAPACITY}; use fewer G1 blocks")]
    TooLong {
        /// First line of the path.
        line: u32,
        /// How many.
        knots: usize,
    },
    /// More events than the motion board holds.
    #[error(
        "line {line}: the path has {events} M62, M63 and M67, the motion board holds {MAX_EVENTS}; use fewer"
    )]
    TooManyEvents {
        /// First line of the path.
        line: u32,
        /// How many.
        events: usize,
    },
}

/// Plans program paths for one machine.
#[derive(Clone, Debug)]
pub struct Planner {
    kinematics: DualBeam,
    drives: [DriveLimits; DRIVES],
    planning: PlanningConfig,
}

/// Limits of an axis or a V slide in inner units.
#[derive(Clone, Copy, Debug)]
struct DriveLimits {
    min: f64,
    max: f64,
    velocity: f64,
    acceleration: f64,
    /// The boards plan no jerk for slides: infinite there.
    jerk: f64,
    /// Inner units in one mm or degree.
    unit: f64,
}

/// What a path asks of the drives at one place: position and derivatives over s.
struct Demand {
    s: f64,
    position: [f64; DRIVES],
    first: [f64; DRIVES],
    second: [f64; DRIVES],
}

/// A path before it is timed.
struct Shape {
    knots: Vec<Knot>,
    speed_error: f64,
    /// s and program line of each target, in their order.
    targets: Vec<(f64, u32)>,
}

impl Shape {
    /// Program line of the motion at `s`.
    fn line(&self, s: f64) -> u32 {
        let index = self.targets.partition_point(|(end, _)| *end < s);
        self.targets[index.min(self.targets.len() - 1)].1
    }
}

impl Planner {
    /// A planner for `machine`; errors name the parameter.
    pub fn build(machine: &MachineFile) -> Result<Self, ParameterError> {
        let axes = AxisLimits::build_all(&machine.motion.axes)?;
        let drives = std::array::from_fn(|i| match axes.get(i) {
            Some(axis) => DriveLimits {
                min: axis.min,
                max: axis.max,
                velocity: axis.velocity,
                acceleration: axis.acceleration,
                jerk: axis.jerk,
                unit: AXIS_UNIT[i],
            },
            None => {
                let slide = &machine.tracker.slides[2 * (i - AXES) + 1];
                DriveLimits {
                    min: slide.travel_min_mm,
                    max: slide.travel_max_mm,
                    velocity: slide.max_velocity_mm_s,
                    acceleration: slide.max_acceleration_mm_s2,
                    jerk: f64::INFINITY,
                    unit: 1.0,
                }
            }
        });
        Ok(Self {
            kinematics: machine.motion.kinematics.build()?,
            drives,
            planning: machine.planning.clone(),
        })
    }

    /// Kinematics of the machine.
    pub fn kinematics(&self) -> &DualBeam {
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
        let park = self.tip(&self.planning.park.to_array());
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
        let demands = self.demands(&planned, &shape)?;
        self.check_travel(&demands, &shape)?;
        planned.limits = match path.motion {
            Motion::Rapid => self.rapid_limits(&demands),
            Motion::Feed(mm_min) => {
                self.feed_limits(&demands, &shape, speed_mm_s.unwrap_or(mm_min / 60.0))?
            }
        };
        Ok(planned)
    }

    fn shape(&self, path: &ProgramPath, from: &Tip) -> Result<Shape, PathError> {
        if let (Motion::Feed(_), [_, _, ..]) = (path.motion, path.targets.as_slice()) {
            self.smooth(path, from)
        } else {
            self.straight(path, from)
        }
    }

    /// The curve through all targets.
    fn smooth(&self, path: &ProgramPath, from: &Tip) -> Result<Shape, PathError> {
        let mut points = vec![self.channels(from)];
        points.extend(path.targets.iter().map(|target| self.channels(&target.tip)));
        for (pair, target) in points.windows(2).zip(&path.targets) {
            if distance(&pair[0], &pair[1]) < SHORTEST {
                return Err(PathError::NoTravel { line: target.line });
            }
        }
        for (three, target) in points.windows(3).zip(&path.targets[1..]) {
            let chord = |i: usize| position(&three[i + 1]) - position(&three[i]);
            let turn = angle(&chord(0), &chord(1));
            if turn > MAX_CORNER {
                return Err(PathError::Corner {
                    line: target.line,
                    degrees: turn.to_degrees(),
                });
            }
        }
        let line = path.targets[0].line;
        let curve = Curve::by_length(&points).map_err(|source| PathError::Spline { line, source })?;
        let ends = curve.parameters()[1..].iter();
        Ok(Shape {
            speed_error: curve.speed_error(),
            targets: ends.zip(&path.targets).map(|(s, t)| (*s, t.line)).collect(),
            knots: knots_of(&curve),
        })
    }

    /// A straight line of the tip while the head turns about one axis.
    fn straight(&self, path: &ProgramPath, from: &Tip) -> Result<Shape, PathError> {
        let Target { tip, line } = *end_of(path);
        let (start, end) = (self.pose(from), self.pose(&tip));
        let travel = (end.position - start.position).norm();
        if matches!(path.motion, Motion::Feed(_)) && travel < SHORTEST {
            return Err(PathError::NoTravel { line });
        }
        // Not the angle of the turn, but not smaller than half of it, which is all that counts here.
        let turn = angle(&start.tangent, &end.tangent) + angle(&start.normal, &end.normal);
        let stretch = (0..SIDES)
            .map(|k| (tip.extension_mm[k] - from.extension_mm[k]).abs())
            .fold(0.0, f64::max);
        let length = match path.motion {
            Motion::Feed(_) => travel,
            Motion::Rapid => travel
                .max(LENGTH_PER_TURN * turn.to_degrees())
                .max(stretch)
                .max(SHORTEST),
        };
        let count = (turn / STRAIGHT_TURN).ceil().max(1.0) as usize;
        let mut points = Vec::new();
        for i in 0..=count {
            let part = i as f64 / count as f64;
            let pose =
                interpolate(&start, &end, part).map_err(|source| PathError::Attitude { line, source })?;
            let extension: [f64; SIDES] = std::array::from_fn(|k| {
                from.extension_mm[k] + (tip.extension_mm[k] - from.extension_mm[k]) * part
            });
            points.push(channels(&pose, &extension));
        }
        let s = (0..=count).map(|i| length * i as f64 / count as f64).collect();
        let curve = Curve::through(s, &points).map_err(|source| PathError::Spline { line, source })?;
        Ok(Shape {
            knots: knots_of(&curve),
            speed_error: 0.0,
            targets: vec![(length, line)],
        })
    }

    fn channels(&self, tip: &Tip) -> [f64; CHANNELS] {
        channels(&self.pose(tip), &tip.extension_mm)
    }

    /// What the path asks of the drives at many places.
    fn demands(&self, planned: &PlannedPath, shape: &Shape) -> Result<Vec<Demand>, PathError> {
        let (path, length) = (planned.path(), planned.length_mm());
        let count = CHECK_COUNT.max((length / CHECK_STEP).ceil() as usize);
        (0..=count)
            .map(|i| length * i as f64 / count as f64)
            .filter_map(|s| path.at(s).map(|point| self.demand(s, &point, shape.line(s))))
            .collect()
    }

    fn demand(&self, s: f64, point: &PathPoint, line: u32) -> Result<Demand, PathError> {
        let (pose, motion) = point
            .pose_in_motion()
            .map_err(|source| PathError::Pose { line, source })?;
        let axes = self
            .kinematics
            .inverse_motion(&pose, &motion)
            .map_err(|source| PathError::Kinematics { line, source })?;
        // The extensions are the last channels of a path.
        let join = |axes: &[f64; AXES], channels: &[f64; CHANNELS]| {
            std::array::from_fn(|i| axes.get(i).copied().unwrap_or(channels[CHANNELS - DRIVES + i]))
        };
        Ok(Demand {
            s,
            position: join(&axes.position, &point.value),
            first: join(&axes.velocity, &point.first),
            second: join(&axes.acceleration, &point.second),
        })
    }

    /// Names the drive that leaves its travel furthest in its own units.
    fn check_travel(&self, demands: &[Demand], shape: &Shape) -> Result<(), PathError> {
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
    fn feed_limits(
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
    fn rapid_limits(&self, demands: &[Demand]) -> SpeedLimits {
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

fn position(channels: &[f64; CHANNELS]) -> Vector3<f64> {
    Vector3::new(channels[0], channels[1], channels[2])
}

fn channels(pose: &Pose, extension: &[f64; SIDES]) -> [f64; CHANNELS] {
    let [d, t, n] = [pose.position, pose.tangent, pose.normal];
    [
        d.x,
        d.y,
        d.z,
        t.x,
        t.y,
        t.z,
        n.x,
        n.y,
        n.z,
        extension[0],
        extension[1],
    ]
}

fn knots_of(curve: &Curve<CHANNELS>) -> Vec<Knot> {
    let knot = |&s_mm: &f64| {
        let [value, slope, _] = curve.at(s_mm);
        Knot { s_mm, value, slope }
    };
    curve.parameters().iter().map(knot).collect()
}

/// Degrees that went through radians print without their last bits.
fn round_for_people(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::{Options, interpret};
    use std::fmt::Write;

    fn planner() -> Planner {
        let text = include_str!("../../machines/dual-beam-gantry.toml");
        Planner::build(&MachineFile::parse("m.toml", text).unwrap()).unwrap()
    }

    /// Plans `body` with the tip at X1000 Y1000 Z100, all angles zero.
    fn plan(body: &str) -> Result<Vec<PlannedPath>, PathError> {
        let text = format!("G43.4\nG0 X1000 Y1000 Z100 A0 B0 C0\n{body}\nM2\n");
        let program = interpret(&text, Options::default()).unwrap();
        let planner = planner();
        let from = planner.tip(&[100.0, 100.0, 900.0, 0.0, 0.0, 0.0]);
        planner.program(&program, &from, None)
    }

    #[test]
    fn a_path_begins_where_the_machine_stands_and_ends_at_its_target() {
        let planned = plan("G0 X1200 A30 C-20").unwrap();
        let planner = planner();
        let at = |path: &PlannedPath, s: f64| {
            let pose = path.path().at(s).unwrap().pose().unwrap();
            planner.kinematics().inverse(&pose).unwrap()
        };
        let start = at(&planned[0], 0.0);
        for (axis, wanted) in [100.0, 100.0, 900.0, 0.0, 0.0, 0.0].into_iter().enumerate() {
            assert!(
                (start[axis] - wanted).abs() < 1e-9,
                "axis {axis}: {}",
                start[axis]
            );
        }
        let end = at(&planned[1], planned[1].length_mm());
        assert!((end[3].to_degrees() - 30.0).abs() < 1e-9 && (end[5].to_degrees() + 20.0).abs() < 1e-9);
        let tip = planner.kinematics().forward(&end).position;
        assert!((tip - Vector3::new(1200.0, 1000.0, 100.0)).norm() < 1e-9);
    }

    #[test]
    fn a_straight_move_turns_the_head_about_one_axis_at_an_even_rate() {
        let planned = plan("G0 X1100 A80 B20 C60").unwrap();
        let path = planned[1].path();
        let length = planned[1].length_mm();
        let (start, end) = (
            path.at(0.0).unwrap().pose().unwrap(),
            path.at(length).unwrap().pose().unwrap(),
        );
        for i in 0..=100 {
            let part = f64::from(i) / 100.0;
            let pose = path.at(part * length).unwrap().pose().unwrap();
            let exact = interpolate(&start, &end, part).unwrap();
            assert!((pose.position - exact.position).norm() < 1e-9);
            let off = angle(&pose.normal, &exact.normal).max(angle(&pose.tangent, &exact.tangent));
            assert!(off < 1e-4, "{off} rad off the geodesic at {part}");
        }
    }

    #[test]
    fn rapids_use_their_part_of_the_limits_and_no_more() {
        // Turning the head makes the pivot swing: there the acceleration is shared with the curvature.
        for (body, least) in [("G0 Y1500", 0.49), ("G0 Z50", 0.49), ("G0 A60 B10", 0.24)] {
            let planned = plan(body).unwrap();
            let planner = planner();
            let path = planned[1].path();
            let profile =
                SpeedProfile::rest_to_rest(0.0, planned[1].length_mm(), &planned[1].limits).unwrap();
            let mut used: f64 = 0.0;
            for i in 0..=500 {
                let state = profile.at(profile.duration() * f64::from(i) / 500.0);
                let at = shared::trajectory::reference(planner.kinematics(), &path, state).unwrap();
                for axis in 0..AXES {
                    let limits = &planner.drives[axis];
                    let speed = at.velocity[axis].abs() / limits.velocity;
                    let acceleration = at.acceleration[axis].abs() / limits.acceleration;
                    assert!(
                        speed <= 0.501 && acceleration <= 0.501,
                        "{body}: axis {axis} {speed} {acceleration}"
                    );
                    used = used.max(speed).max(acceleration);
                }
            }
            assert!(used > least, "{body} uses only {used} of every limit");
        }
    }

    fn arc(radius: f64, feed: f64) -> String {
        let mut body = format!("F{feed}\nG1\n");
        for i in 1..=40 {
            let phi = f64::from(i) * 10.0 / radius;
            let (x, y) = (1000.0 + radius * phi.sin(), 1000.0 + radius * (1.0 - phi.cos()));
            let c = phi.to_degrees();
            writeln!(body, "X{x:.6} Y{y:.6} C{c:.6} V1={:.4}", 0.01 * f64::from(i)).unwrap();
        }
        body
    }

    #[test]
    fn a_smooth_path_runs_by_its_length_through_every_point() {
        let planned = plan(&arc(600.0, 5000.0)).unwrap();
        let weld = &planned[1];
        assert!((weld.length_mm() - 400.0).abs() < 1e-3);
        assert!(weld.speed_error < 1e-4, "{}", weld.speed_error);
        assert_eq!(weld.knots.len(), 41);
        let last = weld.knots[40];
        assert!((last.value[9] - 0.4).abs() < 1e-9);
        let middle = weld.path().at(205.0).unwrap().pose().unwrap();
        let phi = 205.0_f64 / 600.0;
        let exact = Vector3::new(1000.0 + 600.0 * phi.sin(), 1600.0 - 600.0 * phi.cos(), 100.0);
        assert!(
            (middle.position - exact).norm() < 2e-4,
            "{}",
            (middle.position - exact).norm()
        );
    }

    #[test]
    fn events_happen_where_their_motion_starts() {
        let body = "F5000\nM67 E0 Q100\nG1 X1010\nM62 P0\nX1110\nM63 P0\nX1120";
        let weld = &plan(body).unwrap()[1];
        let places: Vec<f64> = weld.events.iter().map(|event| event.s_mm).collect();
        for (seen, wanted) in places.iter().zip([0.0, 10.0, 110.0]) {
            assert!((seen - wanted).abs() < 1e-9);
        }
        let (on, off) = weld.weld().unwrap();
        assert!((on - 10.0).abs() < 1e-9 && (off - 110.0).abs() < 1e-9);
    }

    #[test]
    fn leaving_the_travel_names_axis_amount_and_line() {
        let error = plan("G0 X1000\nG0 Y3020").unwrap_err();
        assert_eq!(
            error.to_string(),
            "line 4: axis Y would have to go to 3020.000, 20.000 beyond its travel (0…3000 mm)"
        );
        let error = plan("G0 B31").unwrap_err();
        assert!(matches!(error, PathError::Travel { axis: "B", beyond, .. } if (beyond - 1.0).abs() < 1e-6));
        let error = plan("G0 X1010 V2=12.5").unwrap_err();
        assert!(matches!(error, PathError::Travel { axis: "V2", beyond, .. } if (beyond - 0.5).abs() < 1e-6));
    }

    #[test]
    fn a_feed_above_the_axes_names_the_limiting_one() {
        // The head stands upright: only the tip's own speed counts, 20 m/min along Y.
        let error = plan("F21000\nG1 Y1400").unwrap_err();
        assert_eq!(
            error.to_string(),
            "line 4: the feed of 21000 mm/min is too high, the speed of Y allows 20000 mm/min"
        );
        assert!(plan(&arc(600.0, 9000.0)).is_ok());
    }

    #[test]
    fn what_is_not_smooth_is_refused_with_its_line() {
        let error = plan("F600\nG1 X1010\nY1010").unwrap_err();
        assert!(matches!(error, PathError::Corner { line: 5, degrees } if (degrees - 90.0).abs() < 1e-9));
        assert_eq!(plan("F600\nG1 A10").unwrap_err(), PathError::NoTravel { line: 4 });
        assert!(plan("F600\nG61.1\nG1 X1010\nY1010").is_ok());
        let events = MAX_EVENTS + 1;
        let error = plan(&format!("{}F600\nG1 X1010", "M62 P0\n".repeat(events))).unwrap_err();
        assert!(matches!(error, PathError::TooManyEvents { events: seen, .. } if seen == events));
        let points: String = (1..=CAPACITY).map(|i| format!("G1 X{}\n", 1000 + i)).collect();
        let error = plan(&format!("F600\n{points}")).unwrap_err();
        assert_eq!(
            error,
            PathError::TooLong {
                line: 4,
                knots: CAPACITY + 1
            }
        );
    }

    #[test]
    fn parking_ends_at_the_park_position() {
        let planner = planner();
        let from = planner.tip(&[1000.0, 1000.0, 700.0, 20.0, 5.0, -10.0]);
        let paths = planner.park(&from).unwrap();
        let last = paths.last().unwrap();
        let pose = last.path().at(last.length_mm()).unwrap().pose().unwrap();
        let axes = planner.kinematics().inverse(&pose).unwrap();
        for (axis, wanted) in planner.planning.park.to_array().into_iter().enumerate() {
            assert!((axes[axis] / planner.drives[axis].unit - wanted).abs() < 1e-6);
        }
    }
}
