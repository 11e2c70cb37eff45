//! Where the tool truly is, from the positions of the axes.

use crate::record::MachinePosition;
use shared::config::MotionConfig;
use shared::geometry::Pose;
use shared::io::AXES;
use shared::kinematics::Kinematics;
use shared::parameter::ParameterError;
use std::fmt;
use std::sync::Arc;

/// A machine whose geometry is another one than its controller believes.
pub trait TrueTool: fmt::Debug + Send + Sync {
    /// Pose of the tool for `axes` (mm, rad), in the frame of the work.
    fn forward(&self, axes: &[f64; AXES]) -> Pose;
}

/// Geometry of the machine as it is believed, and as it truly is where that is known.
#[derive(Clone, Debug)]
pub struct MachineGeometry {
    kinematics: Kinematics,
    /// Cross positions of X1 and X2 \[mm\], where X is a gantry.
    beam_mm: Option<[f64; 2]>,
    tool: Option<Arc<dyn TrueTool>>,
}

impl MachineGeometry {
    /// Of `kinematics` and, where X is a gantry, the cross positions of X1 and X2 \[mm\].
    pub const fn new(kinematics: Kinematics, beam_mm: Option<[f64; 2]>) -> Self {
        Self {
            kinematics,
            beam_mm,
            tool: None,
        }
    }

    /// Of a machine that is as it is believed; errors name the parameter.
    pub fn build(motion: &MotionConfig) -> Result<Self, ParameterError> {
        Ok(Self {
            kinematics: motion.kinematics()?,
            beam_mm: motion.gantry.as_ref().map(|gantry| [gantry.y1_mm, gantry.y2_mm]),
            tool: None,
        })
    }

    /// The same of a machine that is not.
    pub fn truly(self, tool: Arc<dyn TrueTool>) -> Self {
        Self {
            tool: Some(tool),
            ..self
        }
    }

    /// Kinematics that the controller believes.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Axis positions (mm, rad). The ram of a gantry hangs on the beam from X1 to X2 (mathematics 0.10).
    pub fn axes(&self, position: &MachinePosition) -> [f64; AXES] {
        match *position {
            MachinePosition::Axes(axes) => axes,
            MachinePosition::Motors([x1, x2, y, z, a, b, c]) => {
                let across = self.beam_mm.map_or(0.0, |[y1, y2]| (y - y1) / (y2 - y1));
                [x1 + (x2 - x1) * across, y, z, a, b, c]
            }
        }
    }

    /// Where the tool truly is with the machine at `position`, in the frame of the work.
    pub fn pose(&self, position: &MachinePosition) -> Pose {
        self.tool(&self.axes(position))
    }

    /// The same, of axes that are truly there (mm, rad).
    pub fn tool(&self, axes: &[f64; AXES]) -> Pose {
        match &self.tool {
            Some(tool) => tool.forward(axes),
            None => self.kinematics.forward(axes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use shared::kinematics::{AxisLimits, DualBeamConfig, KinematicsConfig};

    fn machine() -> MachineGeometry {
        MachineGeometry {
            kinematics: KinematicsConfig::DualBeamGantry(DualBeamConfig {
                o1_mm: [0.0, 0.0, -120.0],
                o2_mm: [0.0, 0.0, -80.0],
                o3_mm: [0.0, 0.0, -450.0],
            })
            .build(&[AxisLimits::NOT_FITTED; shared::io::AXES])
            .unwrap(),
            beam_mm: Some([-250.0, 3250.0]),
            tool: None,
        }
    }

    #[test]
    fn a_crooked_gantry_moves_the_ram_by_its_share() {
        let machine = machine();
        let square = MachinePosition::Motors([500.0, 500.0, 1500.0, 800.0, 0.1, 0.05, -0.2]);
        let crooked = MachinePosition::Motors([500.0, 500.7, 1500.0, 800.0, 0.1, 0.05, -0.2]);
        let moved = machine.pose(&crooked).position - machine.pose(&square).position;
        assert!((moved - Vector3::new(0.35, 0.0, 0.0)).norm() < 1e-12);
        let axes = MachinePosition::Axes([500.0, 1500.0, 800.0, 0.1, 0.05, -0.2]);
        assert_eq!(machine.pose(&axes), machine.pose(&square));
    }
}
