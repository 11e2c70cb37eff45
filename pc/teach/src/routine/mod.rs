//! Teaching a line on a surface with a moving probe (mathematics 2): from guide point to guide point, on
//! each a ring to turn the probe towards the surface, then rings until the normal is good enough.
//!
//! The probe stands where the nozzle does. Its beam meets the focus at the reference distance d₀: with the tip at
//! P and the axis N, a distance d means the surface point P − N(d − d₀). What is taught is the point of the surface
//! that is nearest to the guide point.

mod error;
mod lesson;

pub use error::{PointError, TeachError};

use crate::{Halving, HalvingConfig, TaughtPoint};
use config::machine::MachineFile;
use config::probe::{Probe, ProbeUnit, Reading};
use config::{RangeError, in_range};
use error::PointFailure;
use lesson::Lesson;
use nalgebra::Vector3;
use nc::text::decimal;
use serde::Deserialize;
use shared::geometry::{Pose, angle};
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AXIS_UNIT, Kinematics, KinematicsError};
use std::error::Error as StdError;
use std::ops::Range;

/// Decimals of lengths \[mm\] and of angles \[deg\] in the moves.
const LENGTH_DECIMALS: i32 = 5;
const ANGLE_DECIMALS: i32 = 6;
const ROTARY: Range<usize> = 3..AXES;

/// How to teach.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TeachingConfig {
    /// Readings of each distance.
    pub readings: usize,
    /// Height over the surface on the way from point to point \[mm\].
    pub approach_mm: f64,
    /// The probe is turned until it stands along the normal within this \[deg\].
    pub aim_deg: f64,
    /// It is turned at most so often for one point.
    pub most_turns: usize,
    /// Largest angle of a normal with the vertical \[deg\].
    pub steepest_deg: f64,
    /// Nearer to the vertical than this a rotary axis whose pole is there stays, and the tool leans by less than
    /// this \[deg\].
    pub upright_deg: f64,
    /// The rings.
    pub rings: HalvingConfig,
}

impl TeachingConfig {
    /// Checks the settings for a probe.
    pub fn check(&self, unit: &ProbeUnit) -> Result<(), RangeError> {
        let readings = self.readings as f64;
        let enough = self.readings >= unit.output.least_readings;
        in_range(
            "readings",
            readings,
            enough,
            "least_readings of the probe or more",
        )?;
        in_range(
            "approach_mm",
            self.approach_mm,
            self.approach_mm >= 0.0,
            "0 or more",
        )?;
        in_range("aim_deg", self.aim_deg, self.aim_deg > 0.0, "above 0")?;
        in_range(
            "upright_deg",
            self.upright_deg,
            self.upright_deg >= 0.0,
            "0 or more",
        )?;
        let steepest = self.steepest_deg;
        in_range(
            "steepest_deg",
            steepest,
            steepest > 0.0 && steepest <= 90.0,
            "above 0, at most 90",
        )?;
        self.rings.build()?;
        Ok(())
    }
}

/// Where an operator would jog to: the tip a few mm, the attitude a few degrees off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuidePoint {
    /// Tip \[mm\].
    pub position: Vector3<f64>,
    /// A B C \[deg\].
    pub angles_deg: [f64; 3],
}

/// The interface to a machine with a probe, for teaching.
pub trait ProbeMachine {
    /// Why it does not do what it is asked.
    type Error: StdError + 'static;

    /// Runs an NC program of rapids from where the axes stand, `slower` times as slowly as the machine can. They stand
    /// at its end when it is done.
    fn run(&mut self, program: &str, slower: f64) -> Result<(), Self::Error>;

    /// The axes at rest, and `readings` of the probe meanwhile.
    fn look(&mut self, readings: usize) -> Result<Look, Self::Error>;

    /// `done` points are taught; an implementation can report them.
    fn taught(&mut self, done: &[TaughtPoint]);
}

/// What there is to see where the machine stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The machine's clock \[µs\].
    pub time_us: u64,
    /// Axes by their gratings (mm, rad).
    pub axes: [f64; AXES],
    /// Readings of the probe.
    pub readings: Vec<Reading>,
}

/// Teaches with one machine.
#[derive(Clone, Debug)]
pub struct Teacher<'a> {
    kinematics: &'a Kinematics,
    fitted: [bool; AXES],
    safe_height: f64,
    reference: f64,
    probe: Probe,
    halving: Halving,
    config: &'a TeachingConfig,
}

/// The axes at which the tool stands at `position` along `normal`. A `normal` that is nearer to the vertical than
/// `upright` \[rad\] is turned into the plane across the T that the machine has at `near`: so the axis whose pole is
/// there stays.
pub fn aim(
    kinematics: &Kinematics,
    position: &Vector3<f64>,
    normal: &Vector3<f64>,
    near: &[f64; AXES],
    upright: f64,
) -> Result<[f64; AXES], KinematicsError> {
    let tangent = kinematics.forward(near).tangent;
    let normal = if angle(normal, &Vector3::z()) < upright {
        (normal - tangent * tangent.dot(normal)).normalize()
    } else {
        *normal
    };
    let pose = Pose {
        position: *position,
        tangent,
        normal,
    };
    kinematics.inverse(&pose, near)
}

impl<'a> Teacher<'a> {
    /// Checks probe and settings.
    pub fn build(
        machine: &MachineFile,
        kinematics: &'a Kinematics,
        unit: &ProbeUnit,
        config: &'a TeachingConfig,
    ) -> Result<Self, RangeError> {
        let probe = unit.build()?;
        config.check(unit)?;
        Ok(Self {
            kinematics,
            fitted: std::array::from_fn(|i| machine.motion.axes[i].is_some()),
            safe_height: machine.planning.safe_height_mm,
            reference: unit.reference_distance_mm,
            probe,
            halving: config.rings.build()?,
            config,
        })
    }

    /// Teaches all points. The axes stand still before and afterwards.
    pub fn teach<A: ProbeMachine>(
        &self,
        arm: &mut A,
        guides: &[GuidePoint],
    ) -> Result<Vec<TaughtPoint>, TeachError<A::Error>> {
        let Some(first) = guides.first() else {
            return Ok(Vec::new());
        };
        let here = arm
            .look(0)
            .map_err(|source| TeachError::Machine { number: 1, source })?;
        let mut lesson = Lesson {
            teacher: self,
            arm,
            axes: here.axes,
            time_us: here.time_us,
        };
        let mut points = Vec::new();
        for (index, guide) in guides.iter().enumerate() {
            let place = guide.position;
            let name = |trouble| match trouble {
                PointFailure::Machine(source) => TeachError::Machine {
                    number: index + 1,
                    source,
                },
                PointFailure::Point(reason) => TeachError::Point {
                    number: index + 1,
                    x: place.x,
                    y: place.y,
                    z: place.z,
                    reason,
                },
            };
            let before = lesson.time_us;
            if index == 0 {
                lesson.approach(first).map_err(name)?;
            }
            let mut point = lesson.point(guide).map_err(name)?;
            point.time_s = (lesson.time_us - before) as f64 * 1e-6;
            points.push(point);
            lesson.arm.taught(&points);
        }
        Ok(points)
    }

    fn radians(angles_deg: &[f64; 3]) -> [f64; 3] {
        angles_deg.map(f64::to_radians)
    }

    /// The axes of a guide's attitude with the tip at `position`.
    fn axes_of(&self, position: &Vector3<f64>, angles_deg: &[f64; 3]) -> [f64; AXES] {
        let [a, b, c] = Self::radians(angles_deg);
        let arm = self.kinematics.forward(&[0.0, 0.0, 0.0, a, b, c]).position;
        let base = position - arm;
        [base.x, base.y, base.z, a, b, c]
    }

    /// Words of `values` (mm, rad) for the axes that the machine has.
    fn axis_words(&self, values: &[f64; AXES]) -> String {
        let words = (0..AXES).filter(|i| self.fitted[*i]).map(|i| {
            let decimals = if ROTARY.contains(&i) {
                ANGLE_DECIMALS
            } else {
                LENGTH_DECIMALS
            };
            format!("{}{}", AXIS_NAMES[i], decimal(values[i] / AXIS_UNIT[i], decimals))
        });
        words.collect::<Vec<_>>().join(" ")
    }
}
