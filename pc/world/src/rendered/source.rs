//! Rendered pictures for a job: of where the machine truly was at each strobe.

use super::background::Background;
use super::{FieldOfView, RenderedWorld, SceneFile, Standpoint, View};
use crate::marks::Marks;
use crate::{Mounted, SharedSeams, Workpiece};
use camera::{Camera, CameraError};
use config::machine::CameraConfig;
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use job::PictureSource;
use plant_file::CameraMount;
use shared::io::SIDES;
use shared::protocol::{Capture, MotionSample};
use shared::tracking::frames::Heads;
use std::sync::mpsc::Sender;

/// The cameras of a rendered world.
pub struct RenderedPictures {
    world: RenderedWorld,
    cameras: CameraConfig,
    mounts: [Mounted; SIDES],
    believed_lead_mm: f64,
    seams: SharedSeams,
    /// Those on a bare plate, which is there in place of the seams.
    marks: Option<Marks>,
    /// Senders of the field of view of each camera.
    tell: [Option<Sender<FieldOfView>>; SIDES],
}

impl RenderedPictures {
    /// Pictures of `seams`, or of a bare plate where they would be, that look as `scene` says, of cameras mounted so. `seed` starts all noise.
    pub fn new(
        scene: &SceneFile,
        cameras: &CameraConfig,
        heads: &Heads,
        mounts: [CameraMount; SIDES],
        seed: u64,
        seams: SharedSeams,
        work: Workpiece,
    ) -> Self {
        Self {
            world: RenderedWorld::new(scene, cameras, heads, seed),
            cameras: cameras.clone(),
            mounts: mounts.map(Mounted::new),
            believed_lead_mm: heads.camera_lead(),
            seams,
            marks: (work == Workpiece::BarePlate).then(Marks::default),
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

    fn delay_us(&self, capture: u32, side: usize) -> u64 {
        self.mounts[side].delay_us(capture)
    }

    fn motion(&mut self, samples: &[MotionSample]) {
        if let Some(marks) = &mut self.marks {
            marks.motion(samples);
        }
    }

    fn tell(
        &mut self,
        side: usize,
        capture: &Capture,
        at: Option<(&MachineGeometry, &MachinePosition)>,
        wanted: bool,
    ) {
        let standpoint = Standpoint {
            side,
            slides_mm: self.mounts[side].slides_mm(side, capture),
            lead_mm: self.mounts[side].lead_mm(self.believed_lead_mm),
            turned: self.mounts[side].turned(),
        };
        let field_of_view = match at {
            Some((machine, position)) => {
                let seams = self.seams.get();
                if let Some(marks) = &mut self.marks {
                    marks.strobed(capture, machine, &seams);
                }
                let marks = self.marks.as_ref();
                let view = || View::of(&self.cameras, machine, &seams, marks, position, &standpoint);
                match wanted {
                    true => view().map_or(FieldOfView::Nothing, FieldOfView::Seam),
                    false => FieldOfView::Unknown,
                }
            }
            None => FieldOfView::Unknown,
        };
        if let Some(tell) = &self.tell[side] {
            // A camera that was lost has reported its error.
            let _ = tell.send(field_of_view);
        }
    }
}
