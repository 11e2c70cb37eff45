//! The walls of a closed corner, as a camera sees them.

use crate::CameraFrame;
use config::machine::JointForm;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::tracking::frames::Heads;

/// Slopes dn/du of skin and rib in the frame of a camera, that on the left of the seam first. The skin lies square to
/// the plate's normal N and reaches out to where the head of `side` stands, the rib stands up along N.
pub fn walls(frame: &CameraFrame, heads: &Heads, pose: &Pose, side: usize) -> [f64; 2] {
    let head = -heads.spot(pose, side).v;
    let out = head - pose.normal * head.dot(&pose.normal);
    let slope = |wall: &Vector3<f64>| {
        let [_, across, up] = frame.turned(wall);
        (across, up / across)
    };
    let (skin, rib) = (slope(&out), slope(&pose.normal));
    if skin.0 < rib.0 {
        [skin.1, rib.1]
    } else {
        [rib.1, skin.1]
    }
}

/// dn/du left and right of the seam for a camera that is turned by `mount_rad` about T against the head of `side`, where
/// the machine is as planned.
pub fn nominal_slopes(joint: JointForm, mount_rad: f64, heads: &Heads, side: usize) -> [f64; 2] {
    match joint {
        JointForm::Gap => [0.0; 2],
        JointForm::Corner => {
            let pose = Pose {
                position: Vector3::zeros(),
                tangent: Vector3::x(),
                normal: Vector3::z(),
            };
            let spot = heads.spot(&pose, side);
            let frame = CameraFrame::new(&spot, mount_rad, [0.0; 2], 0.0, 0.0);
            walls(&frame, heads, &pose, side)
        }
    }
}
