//! The kinematics of a machine as programs see them, in mm and degrees.

use super::TOLERANCE;
use super::inner;
use super::limits::{BEYOND, DRIVES, DriveLimits};
use super::targets::ROTARY;
use nalgebra::Vector3;
use nc::TipAndAxes;
use shared::geometry::Pose;
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AXIS_UNIT, Kinematics};

/// Tip, axes and directions of the tool.
#[derive(Debug)]
pub(super) struct TipOfMachine {
    kinematics: Kinematics,
    drives: [DriveLimits; DRIVES],
}

impl TipOfMachine {
    pub(super) fn new(kinematics: &Kinematics, drives: &[DriveLimits; DRIVES]) -> Self {
        Self {
            kinematics: kinematics.clone(),
            drives: *drives,
        }
    }

    /// The first rotary axis of `axes` (mm, degrees) that is outside its travel, in words.
    fn outside(&self, axes: &[f64; AXES]) -> Option<String> {
        ROTARY.into_iter().find_map(|axis| {
            let ([min, max], at, name) = (self.drives[axis].travel(), axes[axis], AXIS_NAMES[axis]);
            let beyond = (min - at).max(at - max) > BEYOND;
            beyond.then(|| format!("{name} would come to {at:.3}°, and its travel is {min:.3}° to {max:.3}°"))
        })
    }
}

impl TipAndAxes for TipOfMachine {
    fn tip(&self, axes: &[f64; AXES]) -> [f64; AXES] {
        let [x, y, z]: [f64; 3] = self.kinematics.forward(&inner(axes)).position.into();
        [x, y, z, axes[3], axes[4], axes[5]]
    }

    fn axes(&self, tip: &[f64; AXES]) -> Option<[f64; AXES]> {
        let [_, _, _, a, b, c] = inner(tip);
        let near = [0.0, 0.0, 0.0, a, b, c];
        let pose = Pose {
            position: [tip[0], tip[1], tip[2]].into(),
            ..self.kinematics.forward(&near)
        };
        let axes = self.kinematics.inverse(&pose, &near).ok()?;
        Some(std::array::from_fn(|axis| axes[axis] / AXIS_UNIT[axis]))
    }

    fn direction(&self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        let axes = inner(&[0.0, 0.0, 0.0, a, b, c]);
        self.kinematics.forward(&axes).normal.into()
    }

    /// Where A, B and C are more than a direction needs, C stays: T of the tool at A0 B0 keeps its heading, and only leans.
    fn pointing(&self, tip: &[f64; AXES], direction: [f64; 3]) -> Result<[f64; 3], String> {
        let [_, _, _, a, b, c] = inner(tip);
        let upright = self.kinematics.forward(&[0.0, 0.0, 0.0, 0.0, 0.0, c]);
        let normal = Vector3::from(direction);
        let tangent =
            upright.tangent * normal.dot(&upright.normal) - upright.normal * normal.dot(&upright.tangent);
        // Square to that plane the tool may have any T in it.
        let tangent = tangent.try_normalize(f64::EPSILON).unwrap_or(upright.tangent);
        let pose = Pose {
            position: [tip[0], tip[1], tip[2]].into(),
            tangent,
            normal,
        };
        let near = [0.0, 0.0, 0.0, a, b, c];
        let axes = self
            .kinematics
            .inverse(&pose, &near)
            .map_err(|error| error.to_string())?;
        let off = self.kinematics.forward(&axes).normal.angle(&normal);
        if off > TOLERANCE.attitude {
            return Err(format!(
                "at this place the machine comes no nearer to it than {:.3}°",
                off.to_degrees()
            ));
        }
        let axes = std::array::from_fn(|axis| axes[axis] / AXIS_UNIT[axis]);
        match self.outside(&axes) {
            Some(outside) => Err(outside),
            None => Ok([axes[3], axes[4], axes[5]]),
        }
    }
}
