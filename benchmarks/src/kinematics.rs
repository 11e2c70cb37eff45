//! The functions of every machine's kinematics, through [`Kinematics`] as the path tick calls them.
//!
//! Every function gets the same samples: regular poses, at random inside the travel and away from poles, in random
//! motion, with the axes of a moment before.

use crate::Failure;
use crate::machine::machines;
use crate::meter::Meter;
use crate::random::Random;
use crate::record::{Checksum, NOTHING, Record, Tally};

use core::fmt;
use core::hint::black_box;
use nalgebra::Vector3;
use shared::geometry::{Pose, PoseMotion};
use shared::io::AXES;
use shared::kinematics::{AxisLimits, AxisMotion, Kinematics, KinematicsError, violations};

/// Samples a machine.
pub const SAMPLES: usize = 500;

/// How far from its pole, at 0, a tilting axis stays \[rad\].
const AWAY: f64 = 0.05;
/// How far the axes of a moment before are away (mm, rad).
const MOMENT: f64 = 0.01;
/// Random tries for one sample.
const TRIES: usize = 1000;

const A: usize = 3;
const B: usize = 4;

/// What the functions are called with.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Where the axes stand (mm, rad).
    pub axes: [f64; AXES],
    /// Axes of a moment before.
    pub near: [f64; AXES],
    /// The pose that `axes` realise.
    pub pose: Pose,
    /// How the tool moves.
    pub motion: PoseMotion,
}

impl Sample {
    /// A random one; `None` if the machine has next to no regular poses.
    fn random(random: &mut Random, kinematics: &Kinematics, limits: &[AxisLimits; AXES]) -> Option<Self> {
        (0..TRIES).find_map(|_| {
            let axes = limits.map(|limit| random.within(limit.min, limit.max));
            let near: [f64; AXES] = core::array::from_fn(|i| {
                let moved = axes[i] + random.within(-MOMENT, MOMENT);
                if fitted(&limits[i]) { moved } else { axes[i] }
            });
            let motion = PoseMotion {
                velocity: random.vector(100.0),
                angular_velocity: random.vector(0.5),
                acceleration: random.vector(1000.0),
                angular_acceleration: random.vector(5.0),
            };
            if [A, B]
                .into_iter()
                .any(|i| fitted(&limits[i]) && axes[i].abs() < AWAY)
            {
                return None;
            }
            let pose = kinematics.forward(&axes);
            // Another solution may be nearer, or the only one that the machine takes.
            let axes = kinematics.inverse_motion(&pose, &motion, &near).ok()?.position;
            (!violations(&axes, limits).any()).then_some(Self {
                axes,
                near,
                pose,
                motion,
            })
        })
    }
}

fn fitted(limit: &AxisLimits) -> bool {
    limit.max > limit.min
}

/// The samples of a machine; `None` in place of one that could not be found.
pub fn samples(kinematics: &Kinematics, limits: &[AxisLimits; AXES]) -> impl Iterator<Item = Option<Sample>> {
    let mut random = Random(1);
    (0..SAMPLES).map(move |_| Sample::random(&mut random, kinematics, limits))
}

/// What a function gives.
pub trait Outcome {
    /// Passes every number of it on; what failed passes NaN.
    fn each(&self, take: &mut impl FnMut(f64));
}

impl Outcome for () {
    fn each(&self, _: &mut impl FnMut(f64)) {}
}

impl Outcome for [f64; AXES] {
    fn each(&self, take: &mut impl FnMut(f64)) {
        self.iter().for_each(|x| take(*x));
    }
}

impl Outcome for Vector3<f64> {
    fn each(&self, take: &mut impl FnMut(f64)) {
        self.iter().for_each(|x| take(*x));
    }
}

impl Outcome for Pose {
    fn each(&self, take: &mut impl FnMut(f64)) {
        self.position.each(take);
        self.tangent.each(take);
        self.normal.each(take);
    }
}

impl Outcome for ([f64; AXES], [f64; AXES]) {
    fn each(&self, take: &mut impl FnMut(f64)) {
        self.0.each(take);
        self.1.each(take);
    }
}

impl Outcome for AxisMotion {
    fn each(&self, take: &mut impl FnMut(f64)) {
        self.position.each(take);
        self.velocity.each(take);
        self.acceleration.each(take);
    }
}

impl<T: Outcome> Outcome for Result<T, KinematicsError> {
    fn each(&self, take: &mut impl FnMut(f64)) {
        match self {
            Ok(outcome) => outcome.each(take),
            Err(_) => take(f64::NAN),
        }
    }
}

/// Names of the functions, in the order of [`visit`].
pub const FUNCTIONS: [&str; 6] = [
    NOTHING,
    "forward",
    "inverse",
    "rates",
    "derivatives",
    "inverse_motion",
];

/// Who is shown the functions.
pub trait Visitor {
    /// Function number `index` of [`FUNCTIONS`].
    fn visit<R: Outcome>(&mut self, index: usize, call: impl Fn() -> R);
}

/// Shows all functions, as called with a sample.
pub fn visit(kinematics: &Kinematics, sample: &Sample, visitor: &mut impl Visitor) {
    let Sample {
        axes,
        near,
        pose,
        motion,
    } = sample;
    visitor.visit(0, || ());
    visitor.visit(1, || kinematics.forward(axes));
    visitor.visit(2, || kinematics.inverse(pose, near));
    visitor.visit(3, || {
        kinematics.rates(axes, &motion.velocity, &motion.angular_velocity)
    });
    visitor.visit(4, || kinematics.derivatives(axes, motion));
    visitor.visit(5, || kinematics.inverse_motion(pose, motion, near));
}

struct Counting<'a, M> {
    meter: &'a mut M,
    tallies: [Tally; FUNCTIONS.len()],
    checksum: &'a mut Checksum,
}

impl<M: Meter> Visitor for Counting<'_, M> {
    fn visit<R: Outcome>(&mut self, index: usize, call: impl Fn() -> R) {
        call().each(&mut |x| self.checksum.add(x));
        let count = self.meter.count(black_box(&mut || {
            black_box(&call());
        }));
        self.tallies[index].add(count);
    }
}

/// Counts every function of every machine in `file` over its samples.
pub(crate) fn run(file: &[u8], meter: &mut impl Meter, console: &mut impl fmt::Write) -> Result<(), Failure> {
    let mut checksum = Checksum::new();
    for machine in machines(file) {
        let machine = machine?;
        let subject = machine.kinematics.name();
        let (kinematics, limits) = machine.build()?;
        let mut counting = Counting {
            meter,
            tallies: Default::default(),
            checksum: &mut checksum,
        };
        for sample in samples(&kinematics, &limits) {
            let sample = sample.ok_or(Failure::NoPose(subject))?;
            visit(&kinematics, &sample, &mut counting);
        }
        for (function, tally) in FUNCTIONS.into_iter().zip(counting.tallies) {
            writeln!(
                console,
                "{}",
                Record::Count {
                    subject,
                    function,
                    tally
                }
            )?;
        }
    }
    writeln!(console, "{}", Record::Checksum(checksum.sum()))?;
    Ok(())
}
