//! The renderer that keeps up with a camera.

use super::random::{SplitMix64, of_place};
use super::row::Row;
use super::scene::{Joint, Scene};
use super::sketch::Sketch;
use super::tile::Tile;
use crate::noise::PhotonTransfer;
use crate::optics::Optics;
use std::sync::Arc;
use thiserror::Error;

/// Renders in real time what the [`TruthRenderer`](super::TruthRenderer) renders slowly, and allocates nothing for it.
///
/// The physics is kept where a detector looks: each pixel's own depth and blur, edges where they are and as soft as
/// they have to be, light and noise. The texture comes from a tile that was blurred beforehand, so that it moves in whole
/// pixels, with the smear and on the slope the tile was made for. That moves neither edges nor band: a detector finds centre
/// and height where it finds them in truth, within 0.2 µm on the mean. Gaps, their sides, marks, stripes and blobs are laid over with soft edges
/// instead of being blurred together with the texture; a blob smaller than its blur has the right light, but is too peaked.
/// Everything else of a scene is as there.
#[derive(Clone, Debug)]
pub struct FastRenderer {
    noise: PhotonTransfer,
    tiles: [Arc<Tile>; 2],
    /// Normally distributed numbers, picked up at a random place for each row.
    gauss: Vec<f32>,
    sketch: Sketch,
    row: Row,
    pixels: Vec<u8>,
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum RenderError {
    /// The scene has other textures than the tiles.
    #[error(
        "the scene's textures left and right of the seam are not those of the tiles; make its tiles first"
    )]
    Texture,
    /// The tiles left and right are of different cameras.
    #[error("the tiles left and right of the seam belong to different cameras; make both for the same")]
    Tiles,
}

/// How many normally distributed numbers there are to pick from.
const GAUSS: usize = 1 << 16;

impl FastRenderer {
    /// A renderer for the camera and texture of two tiles, of what is left and right of the seam: the same twice for a
    /// plate unless its sides have textures of their own, one of each wall for a corner.
    pub fn new(tiles: [Arc<Tile>; 2], noise: PhotonTransfer) -> Result<Self, RenderError> {
        let optics = *tiles[0].optics();
        if optics != *tiles[1].optics() {
            return Err(RenderError::Tiles);
        }
        let mut random = SplitMix64::new(0);
        let gauss = (0..(GAUSS + optics.columns).div_ceil(2)).flat_map(|_| random.gauss());
        Ok(Self {
            noise,
            gauss: gauss.map(|x| x as f32).collect(),
            sketch: Sketch::new(&tiles),
            row: Row::new(optics.columns),
            pixels: vec![0; optics.rows * optics.columns],
            tiles,
        })
    }

    /// The camera.
    pub fn optics(&self) -> &Optics {
        self.tiles[0].optics()
    }

    /// The picture of `scene`, rows from the top; the same seed gives the same noise. The scene's smear is taken to be
    /// the tiles'.
    pub fn render(&mut self, scene: &Scene, seed: u64) -> Result<&[u8], RenderError> {
        if scene.textures() != self.tiles.each_ref().map(|tile| tile.texture()) {
            return Err(RenderError::Texture);
        }
        let optics = *self.optics();
        self.sketch.prepare(scene);
        let mut random = SplitMix64::new(seed);
        let [r0, _] = optics.centre();
        let noise = scene.sensor.noise.unwrap_or(self.noise);
        let step = (255.0 / noise.full_well) as f32;
        let read = (noise.read_noise * 255.0 / noise.full_well).powi(2) as f32;
        let has_effects = scene.has_effects();
        for (row, pixels) in self.pixels.chunks_exact_mut(optics.columns).enumerate() {
            let r = (row as f64 - r0) * self.sketch.lens.pixel_mm;
            self.row.see(&self.tiles, &self.sketch, row, r);
            for stripe in &scene.stripes {
                self.row.lay_stripe(&self.sketch, r, stripe);
            }
            match &scene.joint {
                Joint::Gap(gap) if has_effects => {
                    self.row.fill_with_effects(&self.sketch, scene, Some(gap), r)
                }
                Joint::Gap(gap) => self.row.open_gap(&self.sketch, scene, gap, r),
                Joint::Corner(_) if has_effects => self.row.fill_with_effects(&self.sketch, scene, None, r),
                Joint::Corner(_) => {}
            }
            for blob in &scene.blobs {
                self.row.lay_blob(&self.sketch, scene, r, blob);
            }
            let y = (row as f64 - r0) / r0.max(1.0);
            self.row.light(&self.sketch, &scene.light, y);
            if !scene.film.is_clear() {
                self.row.cover(&self.sketch, &scene.film, y);
            }
            if scene.sensor.pattern > 0.0 {
                let from = of_place(scene.sensor.seed, row, 0) as usize % GAUSS;
                let gauss = &self.gauss[from..][..optics.columns];
                self.row.pattern(gauss, scene.sensor.pattern as f32);
            }
            let from = random.bits() as usize % GAUSS;
            self.row
                .count(&self.gauss[from..][..optics.columns], step, read, pixels);
        }
        Ok(&self.pixels)
    }
}
