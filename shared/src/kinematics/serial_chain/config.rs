//! A serial chain as the machine file has it.

use super::{Joint, SerialChain};
use crate::geometry::Pose;
use crate::io::AXES;
use crate::kinematics::limits::AXIS_OWNERS;
use crate::kinematics::{AxisLimits, xyz};
use crate::parameter::{ParameterError, length_of_machine};
use heapless::Vec;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// By how much the length of a direction may be off 1, and its angle off another one's: it is written with some digits.
const UNIT: f64 = 1e-3;

/// Geometry of a machine that is a chain of joints, in the machine frame, all axes at 0 \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct SerialChainConfig {
    /// The joints: those that carry the work from the base to the work, and those that carry the tool from the base to
    /// the tool.
    pub joints: Vec<JointConfig, AXES>,
    /// Tip of the tool.
    #[serde(deserialize_with = "xyz")]
    pub tip_mm: [f64; 3],
    /// N, from the tip to the machine.
    #[serde(deserialize_with = "xyz")]
    pub tool_axis: [f64; 3],
    /// T, perpendicular to N; left out of a tool that is a body of revolution.
    #[serde(default)]
    pub tangent: Option<[f64; 3]>,
    /// Origin of the work's frame, which is parallel to that of the machine.
    #[serde(default, deserialize_with = "xyz")]
    pub work_mm: [f64; 3],
}

/// A joint with its motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[serde(deny_unknown_fields)]
pub struct JointConfig {
    /// Its axis: X Y Z are linear, A B C rotary.
    pub axis: JointAxis,
    /// What moves.
    pub carries: Carried,
    /// Where that moves while the axis counts up, or about what it turns, right-handed; of unit length.
    #[serde(deserialize_with = "xyz")]
    pub direction: [f64; 3],
    /// A point that stands while a rotary one turns.
    #[serde(default, deserialize_with = "xyz")]
    pub point_mm: [f64; 3],
}

/// The axis of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[expect(missing_docs, reason = "letters")]
pub enum JointAxis {
    X,
    Y,
    Z,
    A,
    B,
    C,
}

/// The end of the machine that a joint carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "ends")]
pub enum Carried {
    Work,
    Tool,
}

impl SerialChainConfig {
    /// Axis of its joint of this number, from the work to the tool.
    pub fn joint(&self, number: usize) -> Option<usize> {
        let joints = self.in_order();
        joints.get(number).map(|joint| joint.axis as usize)
    }

    /// The joints from the work to the tool: what carries the work comes first, the other way round.
    #[cold]
    #[inline(never)]
    fn in_order(&self) -> Vec<&JointConfig, AXES> {
        let mut ordered = Vec::new();
        let count = self.joints.len();
        for place in 0..2 * count {
            let (carried, joint) = match place.checked_sub(count) {
                None => (Carried::Work, &self.joints[count - 1 - place]),
                Some(place) => (Carried::Tool, &self.joints[place]),
            };
            if joint.carries == carried {
                // Each is there once.
                let _ = ordered.push(joint);
            }
        }
        ordered
    }

    /// Checks the geometry: at least one joint, none twice, directions of unit length, every number one of a machine. Of two
    /// attitudes of the rotary axes one within the `limits` is preferred.
    #[cold]
    pub fn build(&self, limits: &[AxisLimits; AXES]) -> Result<SerialChain, ParameterError> {
        const OWNER: &str = "kinematics";
        let work = length_of_machine(OWNER, "work_mm", &self.work_mm)?;
        let tip = length_of_machine(OWNER, "tip_mm", &self.tip_mm)? - work;
        let normal = direction(OWNER, "tool_axis", &self.tool_axis)?;
        let tangent = match &self.tangent {
            Some(tangent) => direction(OWNER, "tangent", tangent)?,
            // One that is not along N.
            None => Vector3::ith(normal.iamin(), 1.0),
        };
        let along = normal.dot(&tangent);
        let across = self.tangent.is_none() || libm::fabs(along) <= UNIT;
        sensible(across, OWNER, "tangent", along)?;
        let tangent = tangent - normal * along;
        let tool = Pose {
            position: tip,
            tangent: tangent / tangent.norm(),
            normal,
        };

        let mut joints: Vec<Joint, AXES> = Vec::new();
        let mut rotary: Vec<u8, 3> = Vec::new();
        for config in self.in_order() {
            let joint = config.build(&work, limits)?;
            let twice = joints.iter().any(|other| other.axis == joint.axis);
            sensible(!twice, AXIS_OWNERS[joint.axis], "joints", 2.0)?;
            // No more than three letters are rotary, and six all in all.
            if joint.is_rotary() {
                let _ = rotary.push(joints.len() as u8);
            }
            let _ = joints.push(joint);
        }
        sensible(!joints.is_empty(), OWNER, "joints", 0.0)?;
        Ok(SerialChain {
            joints,
            tool,
            // Three rotary axes are one more than N needs: T decides.
            follows_tangent: self.tangent.is_some() || rotary.is_full(),
            rotary,
        })
    }
}

impl JointConfig {
    #[cold]
    fn build(&self, work: &Vector3<f64>, limits: &[AxisLimits; AXES]) -> Result<Joint, ParameterError> {
        let axis = self.axis as usize;
        let owner = AXIS_OWNERS[axis];
        let point = length_of_machine(owner, "point_mm", &self.point_mm)?;
        let direction = direction(owner, "direction", &self.direction)?;
        let joint = Joint {
            axis,
            direction: match self.carries {
                Carried::Tool => direction,
                Carried::Work => -direction,
            },
            point: point - work,
            travel: [limits[axis].min, limits[axis].max],
        };
        // A linear joint has no such point.
        let has_point = joint.is_rotary() || point == Vector3::zeros();
        sensible(has_point, owner, "point_mm", point.norm())?;
        Ok(joint)
    }
}

/// `given` with length 1, if it is close to that.
#[cold]
fn direction(owner: &str, field: &str, given: &[f64; 3]) -> Result<Vector3<f64>, ParameterError> {
    let given = Vector3::from(*given);
    let length = given.norm();
    sensible(libm::fabs(length - 1.0) <= UNIT, owner, field, length)?;
    Ok(given / length)
}

/// A value that must be `good`.
#[cold]
fn sensible(good: bool, owner: &str, field: &str, value: f64) -> Result<(), ParameterError> {
    match good {
        true => Ok(()),
        false => Err(ParameterError::new(owner, field, value)),
    }
}
