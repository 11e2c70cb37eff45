//! Rendered pictures for a job: of where the machine truly was at each strobe.

use super::background::Background;
use super::{FieldOfView, RenderedWorld, SceneFile, View};
use crate::SharedSeams;
use crate::mounted;
use camera::{Camera, CameraError};
use config::machine::CameraConfig;
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use job::PictureSource;
use plant_file::CameraMount;
use shared::io::SIDES;
use shared::protocol::Capture;
use shared::tracking::frames::Heads;
use std::sync::mpsc::Sender;

/// The cameras of a rendered world.
pub struct RenderedPictures {
    world: RenderedWorld,
    cameras: CameraConfig,
    mounts: [CameraMount; SIDES],
    seams: SharedSeams,
    /// Senders of the field of view of each camera.
    tell: [Option<Sender<FieldOfView>>; SIDES],
}

impl RenderedPictures {
    /// Pictures of `seams` that look as `scene` says, of cameras mounted so. `seed` starts all noise.
    pub fn new(
        scene: &SceneFile,
        cameras: &CameraConfig,
        heads: &Heads,
        mounts: [CameraMount; SIDES],
        seed: u64,
        seams: SharedSeams,
    ) -> Self {
        Self {
            world: RenderedWorld::new(scene, cameras, heads, seed),
            cameras: cameras.clone(),
            mounts,
            seams,
            tell: [const { None }; SIDES],
        }
    }
}

impl PictureSource for RenderedPictures {
    fn open(&mut self, side: usize) -> Result<Box<dyn Camera>, CameraError> {
        let (camera, tell) = self.world.camera(side);
        self.tell[side] = Some(tell);
        Ok(Box::new(Background::start(Box::new(camera))))
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn late_us(&self, capture: u32, side: usize) -> u64 {
        self.world.late_us(capture, side)
    }

    fn tell(&mut self, side: usize, capture: &Capture, at: Option<(&MachineGeometry, &MachinePosition)>) {
        let field_of_view = match at {
            Some((machine, position)) => {
                let slides = mounted(capture, &self.mounts);
                View::of(&self.cameras, machine, &self.seams.get(), position, &slides, side)
                    .map_or(FieldOfView::Nothing, FieldOfView::Seam)
            }
            None => FieldOfView::Unknown,
        };
        if let Some(tell) = &self.tell[side] {
            // A camera that was lost has reported its error.
            let _ = tell.send(field_of_view);
        }
    }
}
