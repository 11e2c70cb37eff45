//! A machine that is a list of joints: up to three linear and three rotary ones, that carry tool or work (mathematics 8).
//!
//! Nothing of it is known but where its joints are while all axes are at 0. Seen from the work, the tool stands at the
//! end of one chain: the joints that carry the work, from the work to the base, each the other way round, then those that
//! carry the tool. Each joint is a screw, and the pose their product of exponentials, applied to the tool at zero:
//!
//! pose = exp(ξ1 q1) · exp(ξ2 q2) · … · tool.
//!
//! The attitude depends on the rotary axes alone, and given these the position is linear in the linear ones. So the inverse
//! looks for three angles at most: in closed form as far as attitude determines them, then by steps of least squares,
//! which find at once that there is nothing to do where three linear axes lead anywhere.
//!
//! A tool that is a body of revolution (no `tangent`) realises P and N; T is then one that turns with the tool. With three
//! rotary axes, which are one more than N needs, T decides.

mod attitude;
mod config;
mod least_squares;
mod stand;

pub use config::{Carried, JointAxis, JointConfig, SerialChainConfig};

use super::{AxisMotion, Chain, KinematicsError};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use heapless::Vec;
use nalgebra::Vector3;
use stand::Stand;

/// Most steps of an inverse.
const STEPS: usize = 8;
/// Longest turn of an axis in one of them \[rad\]: further away the way ahead is another one.
const LONGEST_TURN: f64 = 1.0;
/// A pose is met where it takes no further turn than this \[rad\], or where it is off by no more, tip \[mm\] and frame \[rad\].
const MET: f64 = 1e-12;
/// How far the tip may be off a pose \[mm\], and the directions of the tool \[rad\]: interpolated attitudes are off the attitudes
/// that a machine with few axes has by as much as paths are (0.006°).
const TOLERANCE: [f64; 2] = [1e-3, 1e-4];

/// Kinematics of a serial chain, ready for the tick.
#[derive(Clone, Debug, PartialEq)]
pub struct SerialChain {
    /// From the work to the tool.
    joints: Vec<Joint, AXES>,
    /// Which of them turn.
    rotary: Vec<u8, 3>,
    /// The pose with all axes at 0.
    tool: Pose,
    /// T belongs to the pose.
    follows_tangent: bool,
}

/// A joint as the work sees it, with all axes at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Joint {
    axis: usize,
    direction: Vector3<f64>,
    point: Vector3<f64>,
    travel: [f64; 2],
}

impl Joint {
    fn is_rotary(&self) -> bool {
        self.axis >= 3
    }
}

impl SerialChain {
    fn joint(&self, i: &u8) -> &Joint {
        &self.joints[usize::from(*i)]
    }

    #[inline(never)]
    fn solve(&self, pose: &Pose, near: &[f64; AXES]) -> Result<([f64; AXES], Stand<'_>), KinematicsError> {
        let mut axes = self.turned(pose, near);
        let mut steps = 0..STEPS;
        let stand = loop {
            let mut stand = Stand::at(self, &axes);
            stand.find_ways();
            stand.bring_tip(&pose.position, &mut axes);
            stand.find_turns();
            let missing = stand.missing(pose);
            let turns = stand.turns(&missing);
            let longest = largest(&turns);
            if longest <= MET || largest(&missing) <= MET || steps.next().is_none() {
                break stand;
            }
            let part = (LONGEST_TURN / longest).min(1.0);
            for (i, turn) in self.rotary.iter().zip(turns) {
                axes[self.joint(i).axis] += turn * part;
            }
        };
        let [tip, directions] = stand.off(pose);
        // Comparisons with what is not a number are false.
        match (directions <= TOLERANCE[1], tip <= TOLERANCE[0]) {
            (true, true) => Ok((axes, stand)),
            (false, _) => Err(KinematicsError::NoSuchAttitude),
            (true, false) => Err(KinematicsError::Unreachable),
        }
    }
}

/// The largest size of a number.
#[inline(never)]
fn largest(numbers: &[f64]) -> f64 {
    numbers
        .iter()
        .fold(0.0, |largest, x| libm::fmax(largest, libm::fabs(*x)))
}

impl Chain for SerialChain {
    fn forward(&self, axes: &[f64; AXES]) -> Pose {
        Stand::at(self, axes).pose
    }

    fn inverse(&self, pose: &Pose, near: &[f64; AXES]) -> Result<[f64; AXES], KinematicsError> {
        Ok(self.solve(pose, near)?.0)
    }

    fn derivatives(
        &self,
        axes: &[f64; AXES],
        motion: &PoseMotion,
    ) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let mut stand = Stand::at(self, axes);
        stand.find_ways();
        stand.find_turns();
        stand.motion(motion)
    }

    fn inverse_motion(
        &self,
        pose: &Pose,
        motion: &PoseMotion,
        near: &[f64; AXES],
    ) -> Result<AxisMotion, KinematicsError> {
        let (position, stand) = self.solve(pose, near)?;
        let (velocity, acceleration) = stand.motion(motion)?;
        Ok(AxisMotion {
            position,
            velocity,
            acceleration,
        })
    }
}
