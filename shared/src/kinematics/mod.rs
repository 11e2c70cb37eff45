//! Machines: from the pose of the tool to the axes and back.
//!
//! One file a machine: its geometry as it stands in the machine file, and the [`Chain`] that is built of it.
//! A machine becomes one of Seamwright's by its line in the list below; firmware, dry run and planners then
//! know it as [`Kinematics`]. One that is a list of joints needs no line: [`SerialChain`] is made of its file alone.
//!
//! Every machine uses some of the axes X Y Z \[mm\] A B C \[rad\]. An axis that it does not have stands at 0.

#[macro_use]
mod registry;

mod ac_head;
mod dual_beam;
mod limits;
mod pipe_welder;
mod rpy;
mod serial_chain;
mod stir_gantry;
mod tool_axis;
mod wire_arc;

pub use ac_head::{AcHead, AcHeadConfig};
pub use dual_beam::{DualBeam, DualBeamConfig};
pub(crate) use limits::AXIS_OWNERS;
pub use limits::{AXIS_UNIT, AxisConfig, AxisLimits, feed_limit, violations};
pub use pipe_welder::{PipeWelder, PipeWelderConfig};
pub use serial_chain::{Carried, JointAxis, JointConfig, SerialChain, SerialChainConfig};
pub use stir_gantry::{StirGantry, StirGantryConfig, StirTilt};
pub use wire_arc::{WireArc, WireArcConfig};

use crate::geometry::{Pose, PoseMotion};
use crate::io::{AXES, AXIS_NAMES};
use crate::parameter::ParameterError;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Deserializer, Serialize};
use thiserror::Error;

machines! {
    /// The ten-axis dual-beam laser welder: X Y Z, then C, B, A.
    "dual-beam-gantry" DualBeamGantry: DualBeamConfig => DualBeam,
    /// The four-axis pipe-intersection welder: waist, radial, axial, torch tilt.
    "pipe-welder" PipeWelder: PipeWelderConfig => PipeWelder,
    /// The five-axis laser cutter: X Y Z, then C, A.
    "ac-head" AcHead: AcHeadConfig => AcHead,
    /// The wire-arc robot: X Y Z and A at the torch, B and C at the positioner.
    "wire-arc" WireArc: WireArcConfig => WireArc,
    /// The friction-stir gantry: table X, then Y, Z, C, B.
    "stir-gantry" StirGantry: StirGantryConfig => StirGantry,
    /// Any machine that is a list of joints.
    "serial-chain" SerialChain: SerialChainConfig => SerialChain,
}

/// Three numbers. Once in the firmware, not once for each of the many fields.
#[inline(never)]
fn xyz<'de, D: Deserializer<'de>>(list: D) -> Result<[f64; 3], D::Error> {
    Deserialize::deserialize(list)
}

/// Axes that realise a pose in motion (mm, rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisMotion {
    /// Positions.
    pub position: [f64; AXES],
    /// First derivatives.
    pub velocity: [f64; AXES],
    /// Second derivatives.
    pub acceleration: [f64; AXES],
}

impl AxisMotion {
    /// Standing at `position`.
    pub const fn at_rest(position: &[f64; AXES]) -> Self {
        Self {
            position: *position,
            velocity: [0.0; AXES],
            acceleration: [0.0; AXES],
        }
    }

    /// No number of it is infinite, or none at all.
    pub fn is_finite(&self) -> bool {
        let all = [&self.position, &self.velocity, &self.acceleration];
        all.into_iter().flatten().all(|x| x.is_finite())
    }

    /// From derivatives over path length to derivatives over time, at path speed `v` \[mm/s\] and path
    /// acceleration `a` \[mm/s²\].
    pub fn at_speed(&self, v: f64, a: f64) -> Self {
        let (first, second) = (&self.velocity, &self.acceleration);
        Self {
            position: self.position,
            velocity: first.map(|rate| rate * v),
            acceleration: core::array::from_fn(|axis| second[axis] * (v * v) + first[axis] * a),
        }
    }
}

/// What a machine is: the way from its axes to the tool and back.
///
/// A [`Pose`] stands in the frame of the work. Machines whose tool is a body of revolution realise its
/// position and its N; T is then free, and what they say of it is written at their `forward`.
pub trait Chain {
    /// Pose of the tool for `axes`.
    fn forward(&self, axes: &[f64; AXES]) -> Pose;

    /// Axes that realise `pose`. Where several do, and where a rotary axis may stand a turn further, those
    /// nearest to `near`, the axes just before. They may lie outside the travel: see [`violations`]. Only where the
    /// travel chooses among the solutions, and leaves none, is that an error here.
    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError>;

    /// Velocities and accelerations of the axes standing at `axes`, for a tool that moves by `motion`.
    fn derivatives(
        &self,
        axes: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError>;

    /// [`Chain::inverse`] and [`Chain::derivatives`] at once, for the tick.
    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let position = self.inverse(pose, near)?;
        let (velocity, acceleration) = self.derivatives(&position, motion)?;
        Ok(AxisMotion {
            position,
            velocity,
            acceleration,
        })
    }

    /// Axis rates for tip velocity `v` \[mm/s\] and angular velocity `omega` \[rad/s\] at `axes`. With
    /// derivatives over path length in place of those over time it gives q′(s).
    fn rates(
        &self,
        axes: &[f64; AXES],
        v: &Vector3<f64>,
        omega: &Vector3<f64>,
    ) -> Result<[f64; AXES], KinematicsError> {
        let motion = PoseMotion {
            velocity: *v,
            angular_velocity: *omega,
            acceleration: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
        };
        Ok(self.derivatives(axes, &motion)?.0)
    }
}

/// Why no axes realise a pose, or its motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum KinematicsError {
    /// The x axis of the tool is parallel to an axis that turns it.
    #[error("gimbal lock")]
    GimbalLock,
    /// In every solution the axis, number `axis` of X Y Z A B C, is outside its travel.
    #[error("{} out of range: no attitude of the tool within its travel takes the pose", AXIS_NAMES[*.axis])]
    OutOfRange {
        /// The axis.
        axis: usize,
    },
    /// The tool would point up into the work from below.
    #[error("axis below horizon: the tool axis N must point upwards")]
    BelowHorizon,
    /// The tool stands where the axis, number `axis` of X Y Z A B C, has no effect, and what is asked for needs
    /// that axis to jump.
    #[error("pole of {}: the axis would have to jump; turn it earlier, or avoid the pole", AXIS_NAMES[*.axis])]
    Pole {
        /// The axis.
        axis: usize,
    },
    /// The machine has too few rotary axes for it.
    #[error("no such attitude: the rotary axes of this machine do not bring the tool there")]
    NoSuchAttitude,
    /// The machine has too few axes for it, or its arms are too short.
    #[error("out of reach: the axes of this machine do not bring the tip there")]
    Unreachable,
}
