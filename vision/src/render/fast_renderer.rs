//! The renderer that keeps up with a camera.

use super::random::SplitMix64;
use super::row::Row;
use super::scene::{Joint, Scene};
use super::sketch::Sketch;
use super::tile::Tile;
use crate::noise::PhotonTransfer;
use std::sync::Arc;
use thiserror::Error;

/// Renders in real time what the [`TruthRenderer`](super::TruthRenderer) renders slowly, and allocates nothing for it.
///
/// The physics is kept where a detector looks: each pixel's own depth and blur, edges where they are and as soft as
/// they have to be, light and noise. The texture comes from a tile that was blurred beforehand, so that it moves in whole
/// pixels, all with the tile's travel smear, and is not turned by roll or sheared by walls. Gaps, stripes and blobs are
/// laid over with soft edges instead of being blurred together with the texture; a blob smaller than its blur is too
/// dark. Everything else of a scene is as there.
#[derive(Clone, Debug)]
pub struct FastRenderer {
    noise: PhotonTransfer,
    tile: Arc<Tile>,
    /// Normally distributed numbers, picked up at a random place for each row.
    gauss: Vec<f32>,
    sketch: Sketch,
    row: Row,
    pixels: Vec<u8>,
}

/// Why a picture cannot be rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum RenderError {
    /// The scene has another texture than the tile.
    #[error("the scene's texture is not that of the tile; make a tile of it")]
    Texture,
}

/// How many normally distributed numbers there are to pick from.
const GAUSS: usize = 1 << 16;

impl FastRenderer {
    /// A renderer for the camera and texture of a tile.
    pub fn new(tile: Arc<Tile>, noise: PhotonTransfer) -> Self {
        let optics = *tile.optics();
        let mut random = SplitMix64::new(0);
        let gauss = (0..(GAUSS + optics.columns).div_ceil(2)).flat_map(|_| random.gauss());
        Self {
            noise,
            gauss: gauss.map(|x| x as f32).collect(),
            sketch: Sketch::new(&tile),
            row: Row::new(optics.columns),
            pixels: vec![0; optics.rows * optics.columns],
            tile,
        }
    }

    /// The tile.
    pub fn tile(&self) -> &Tile {
        &self.tile
    }

    /// The picture of `scene`, rows from the top; the same seed gives the same noise. The scene's smear is taken to be
    /// the tile's.
    pub fn render(&mut self, scene: &Scene, seed: u64) -> Result<&[u8], RenderError> {
        if scene.texture != self.tile.texture() {
            return Err(RenderError::Texture);
        }
        let optics = *self.tile.optics();
        self.sketch.prepare(scene);
        let mut random = SplitMix64::new(seed);
        let [r0, _] = optics.centre();
        let step = (255.0 / self.noise.full_well) as f32;
        let read = (self.noise.read_noise * 255.0 / self.noise.full_well).powi(2) as f32;
        for (row, pixels) in self.pixels.chunks_exact_mut(optics.columns).enumerate() {
            let r = (row as f64 - r0) * self.sketch.lens.pixel_mm;
            self.row.see(&self.tile, &self.sketch, row, r);
            for stripe in &scene.stripes {
                self.row.lay_stripe(&self.sketch, r, stripe);
            }
            if let Joint::Gap(gap) = &scene.joint {
                self.row.open_gap(&self.sketch, scene, gap, r);
            }
            for blob in &scene.blobs {
                self.row.lay_blob(&self.sketch, scene, r, blob);
            }
            self.row
                .light(&self.sketch, &scene.light, (row as f64 - r0) / r0.max(1.0));
            let from = random.bits() as usize % GAUSS;
            self.row
                .count(&self.gauss[from..][..optics.columns], step, read, pixels);
        }
        Ok(&self.pixels)
    }
}
