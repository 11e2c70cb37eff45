//! Where the tool of a machine truly is: joints that turn what they carry, and a geometry that the controller need not know.
//!
//! ISO 230-1 has six errors of a joint, functions of its place. Three move what it carries and are added where its motors are
//! ([`GeometryConfig`](crate::GeometryConfig)); here are the three that turn it, roll, pitch and yaw of a linear joint and tilts
//! of a rotary one. With a constant part they are squareness: of what the joint carries, to the joint.

use crate::config::{AngularError, AngularErrors};
use heapless::Vec;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use shared::geometry::Pose;
use shared::io::AXES;
use shared::kinematics::{AXIS_UNIT, Kinematics};

/// A machine with errors of its joints.
#[derive(Clone, Debug)]
pub struct TrueChain {
    kinematics: Kinematics,
    /// Axes of the joints, from the work to the tool; none if no joint turns what it carries.
    joints: Vec<usize, AXES>,
    /// By axes.
    errors: [AngularErrors; AXES],
    /// The tool with all axes at 0.
    home: Isometry3<f64>,
}

impl TrueChain {
    /// Of `kinematics` as they truly are, whose `joints` come from the work to the tool, with the `errors` of each axis.
    pub fn new(
        kinematics: Kinematics,
        joints: impl Iterator<Item = usize>,
        errors: [AngularErrors; AXES],
    ) -> Self {
        let none = errors
            .as_flattened()
            .iter()
            .all(|error| *error == AngularError::default());
        let home = frame(&kinematics.forward(&[0.0; AXES]));
        Self {
            kinematics,
            joints: joints.take(if none { 0 } else { AXES }).collect(),
            errors,
            home,
        }
    }

    /// Where the tool is for `axes`, in the frame of the work.
    ///
    /// With E the errors and J the motions of the joints, as the work sees them with the axes before at 0, it is
    /// J₁(q₁) E₁(q₁) J₂(q₂) E₂(q₂) … at the tool's home. A J is the motion of the whole machine with all other axes at 0, so
    /// that of an error is about the origin of the work's frame, carried along by the joint.
    pub fn forward(&self, axes: &[f64; AXES]) -> Pose {
        if self.joints.is_empty() {
            return self.kinematics.forward(axes);
        }
        let to_home = self.home.inverse();
        let tool = self.joints.iter().fold(Isometry3::identity(), |before, &axis| {
            let mut alone = [0.0; AXES];
            alone[axis] = axes[axis];
            let motion = frame(&self.kinematics.forward(&alone)) * to_home;
            before * motion * self.turned(axis, axes[axis])
        });
        let Isometry3 {
            rotation,
            translation,
        } = tool * self.home;
        Pose {
            position: translation.vector,
            tangent: rotation * Vector3::x(),
            normal: rotation * Vector3::z(),
        }
    }

    /// By how much the joint of `axis`, which is at `position` (mm, rad), turns what it carries.
    fn turned(&self, axis: usize, position: f64) -> UnitQuaternion<f64> {
        let along = position / AXIS_UNIT[axis];
        let angles = self.errors[axis].each_ref().map(|error| error.at(along));
        UnitQuaternion::from_scaled_axis(Vector3::from(angles))
    }
}

/// The tool as a frame with the axes T, N × T and N.
fn frame(pose: &Pose) -> Isometry3<f64> {
    let axes = [pose.tangent, pose.normal.cross(&pose.tangent), pose.normal];
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&axes));
    Isometry3::from_parts(
        Translation3::from(pose.position),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}
