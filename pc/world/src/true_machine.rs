//! What is true of a simulated machine beside its boards.

use config::machine::MachineFile;
use host_link::geometry::{MachineGeometry, TrueTool};
use plant::TrueChain;
use plant_file::{CameraMount, PlantFile};
use shared::config::MotionConfig;
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::parameter::ParameterError;
use std::sync::Arc;

/// How the cameras of a machine are mounted, and where its tool is. By default as the controller believes.
#[derive(Clone, Debug, Default)]
pub struct TrueMachine {
    /// Its cameras.
    pub mounts: [CameraMount; SIDES],
    tool: Option<Arc<Tool>>,
}

#[derive(Debug)]
struct Tool(TrueChain);

impl TrueTool for Tool {
    fn forward(&self, axes: &[f64; AXES]) -> Pose {
        self.0.forward(axes)
    }
}

impl TrueMachine {
    /// Of a machine that is as in `plant`, whatever its file says.
    ///
    /// # Errors
    /// The geometry of the plant makes no sense.
    pub fn new(plant: &PlantFile, machine: &MachineFile) -> Result<Self, ParameterError> {
        Ok(Self {
            mounts: plant.cameras,
            tool: Some(Arc::new(Tool(plant.chain(&machine.motion)?))),
        })
    }

    /// The geometry of the machine, believed and true.
    ///
    /// # Errors
    /// What is believed makes no sense.
    pub fn geometry(&self, motion: &MotionConfig) -> Result<MachineGeometry, ParameterError> {
        let believed = MachineGeometry::build(motion)?;
        Ok(match &self.tool {
            Some(tool) => believed.truly(tool.clone()),
            None => believed,
        })
    }
}
