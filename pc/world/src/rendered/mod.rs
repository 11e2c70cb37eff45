//! Cameras of a simulated world that give pictures: rendered from where the machine and its slides truly were.

mod background;
mod scene_effects;
mod scene_file;
mod sketch;
mod source;
mod stretches;
mod tiles;
mod view;

pub use scene_effects::{
    Direction, DirtSpot, Grooves, JointStretch, Plate, Plates, SensorFile, StrayLight, TackStretch,
};
pub use scene_file::{Dark, SceneError, SceneFile, Scratch, SurfaceFinish};
pub use source::RenderedPictures;
pub use view::{Standpoint, View, ViewForm};

use camera::{Arrival, Camera, CameraError, Picture};
use config::machine::{CameraConfig, JointForm};
use shared::io::SIDES;
use shared::tracking::frames::Heads;
use sketch::Draw;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;
use tiles::{Tiles, textures};
use vision::PhotonTransfer;
use vision::render::{FastRenderer, RenderError, SplitMix64};

/// How far beside and above the seam a camera is blind \[mm\]: its light does not reach the work.
const REACH_MM: [f64; 2] = [8.0, 1.5];

/// What was in the field of view of a camera at a strobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// The seam.
    Seam(View),
    /// No seam anywhere near.
    Nothing,
    /// Unknown, since the position of the machine is unknown: the picture is lost.
    Unknown,
}

/// What the cameras of a world share.
pub struct RenderedWorld {
    file: Arc<SceneFile>,
    cameras: CameraConfig,
    tiles: [Tiles; SIDES],
    seed: u64,
}

/// One camera. What is in its field of view arrives through a channel, from the job, which knows the position
/// of the machine.
pub struct RenderedCamera {
    file: Arc<SceneFile>,
    side: usize,
    seed: u64,
    noise: PhotonTransfer,
    joint: JointForm,
    rows: usize,
    columns: usize,
    tiles: Tiles,
    /// Made when the tiles are.
    renderer: Option<FastRenderer>,
    fields_of_view: Receiver<FieldOfView>,
    strobes: VecDeque<(u32, u64)>,
    /// Since when each light of the file is off \[µs\].
    off_since: Vec<Option<u64>>,
}

/// What something random in a picture is drawn for.
#[derive(Clone, Copy)]
enum Purpose {
    Lost,
    Late,
    Scene,
    Noise,
}

impl RenderedWorld {
    /// Cameras of a machine before the seams of `file`. `seed` starts all noise.
    pub fn new(file: &SceneFile, cameras: &CameraConfig, heads: &Heads, seed: u64) -> Self {
        Self {
            file: Arc::new(file.clone()),
            cameras: cameras.clone(),
            tiles: Tiles::of(cameras, heads, file, seed),
            seed,
        }
    }

    /// The camera of `side` (0 or 1), and the sender of what is in its field of view: one message for each
    /// strobe, in order.
    pub fn camera(&self, side: usize) -> (RenderedCamera, Sender<FieldOfView>) {
        let (tell, fields_of_view) = channel();
        let camera = RenderedCamera {
            file: self.file.clone(),
            side,
            seed: self.seed,
            noise: self.cameras.photon_transfer,
            joint: self.cameras.joint,
            rows: self.cameras.optics.rows,
            columns: self.cameras.optics.columns,
            tiles: self.tiles[side].clone(),
            renderer: None,
            fields_of_view,
            strobes: VecDeque::new(),
            off_since: vec![None; self.file.dark.len()],
        };
        (camera, tell)
    }

    /// How much later than usual the picture of `capture` arrives \[µs\].
    pub fn late_us(&self, capture: u32, side: usize) -> u64 {
        if drawn(self.seed, capture, side, Purpose::Late).chance(self.file.late_share) {
            (self.file.late_ms * 1e3) as u64
        } else {
            0
        }
    }
}

/// Random numbers that belong to a picture, whenever they are drawn.
fn drawn(seed: u64, capture: u32, side: usize, purpose: Purpose) -> SplitMix64 {
    let place = (u64::from(capture) * SIDES as u64 + side as u64) * 4 + purpose as u64;
    // Twice through the generator, so that neighbours have nothing in common.
    SplitMix64::new(SplitMix64::new(seed).bits() ^ SplitMix64::new(place).bits())
}

fn unrendered(error: RenderError) -> CameraError {
    CameraError::Rendered(Box::new(error))
}

impl Camera for RenderedCamera {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        self.strobes.push_back((capture, time_us));
    }

    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        let Some(&(capture, time_us)) = self.strobes.front() else {
            return Ok(Arrival::Nothing);
        };
        let field_of_view = match self.fields_of_view.recv_timeout(timeout) {
            Ok(field_of_view) => field_of_view,
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => return Ok(Arrival::Nothing),
        };
        self.strobes.pop_front();
        let lost = drawn(self.seed, capture, self.side, Purpose::Lost).chance(self.file.lost_share);
        let in_reach = |view: &View| {
            let [beside, above] = REACH_MM;
            view.lateral_mm.abs() < beside && view.height_mm.abs() < above
        };
        let view = match field_of_view {
            FieldOfView::Seam(view) => Some(view).filter(in_reach),
            FieldOfView::Nothing => None,
            FieldOfView::Unknown => return Ok(Arrival::Lost { capture }),
        };
        let dark = view.is_some_and(|view| self.dark(view.along_mm, time_us));
        if lost {
            return Ok(Arrival::Lost { capture });
        }
        picture.capture = capture;
        picture.time_us = time_us;
        (picture.rows, picture.columns) = (self.rows, self.columns);
        picture.pixels.clear();
        match view {
            Some(view) => self.render(&view, dark, picture)?,
            None => picture.pixels.resize(self.rows * self.columns, 0),
        }
        Ok(Arrival::Picture)
    }
}

impl RenderedCamera {
    /// Whether the light is off at a place of the seam.
    fn dark(&mut self, along_mm: f64, time_us: u64) -> bool {
        let lights = self.file.dark.iter().zip(&mut self.off_since);
        let mine = lights.filter(|(dark, _)| usize::from(dark.side) == self.side + 1);
        mine.fold(false, |off, (dark, since)| {
            if along_mm >= dark.from_s_mm {
                since.get_or_insert(time_us);
            }
            let lasts = |since: u64| {
                dark.for_ms
                    .is_none_or(|ms| (time_us.saturating_sub(since) as f64) < ms * 1e3)
            };
            off | since.is_some_and(lasts)
        })
    }

    fn render(&mut self, view: &View, dark: bool, picture: &mut Picture) -> Result<(), CameraError> {
        let mut random = drawn(self.seed, picture.capture, self.side, Purpose::Scene);
        let draw = Draw {
            file: &self.file,
            side: self.side,
            textures: textures(&self.file, self.joint, self.side, self.seed),
            noise: self.noise,
            dark,
        };
        let scene = draw.scene(view, &mut random);
        let renderer = match &mut self.renderer {
            Some(renderer) => renderer,
            None => self
                .renderer
                .insert(FastRenderer::new(self.tiles.wait()?, self.noise).map_err(unrendered)?),
        };
        let noise = drawn(self.seed, picture.capture, self.side, Purpose::Noise).bits();
        picture
            .pixels
            .extend_from_slice(renderer.render(&scene, noise).map_err(unrendered)?);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
