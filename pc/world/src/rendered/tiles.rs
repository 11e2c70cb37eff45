//! Textured work for the renderers of both sides, made in the background.

use super::scene_file::SceneFile;
use camera::nominal_slopes;
use config::machine::CameraConfig;
use shared::io::SIDES;
use shared::tracking::frames::Heads;
use std::sync::{Arc, LazyLock};
use vision::render::{Texture, Tile};
use vision::{Optics, OpticsError};

/// A tile that is made when it is first asked for.
type Making =
    LazyLock<Result<Arc<Tile>, OpticsError>, Box<dyn FnOnce() -> Result<Arc<Tile>, OpticsError> + Send>>;

/// The tiles of one side, left and right of the seam; both sides share those that are alike.
#[derive(Clone)]
pub(super) struct Tiles([Arc<Making>; 2]);

/// What a tile is made of.
#[derive(Clone, Copy, PartialEq)]
struct Recipe {
    texture: Texture,
    optics: Optics,
    slope: f64,
    smear_mm: f64,
}

impl Tiles {
    /// The tiles of both sides. They are made by a thread of their own from now on.
    pub fn of(cameras: &CameraConfig, heads: &Heads, scene: &SceneFile, seed: u64) -> [Self; SIDES] {
        let mut made: Vec<(Recipe, Arc<Making>)> = Vec::new();
        let tiles = std::array::from_fn(|side| {
            let texture = texture(scene, side, seed);
            let mount_rad = cameras.mount_deg[side].to_radians();
            Self(
                nominal_slopes(cameras.joint, mount_rad, heads, side).map(|slope| {
                    let recipe = Recipe {
                        texture,
                        optics: cameras.optics,
                        slope,
                        smear_mm: 1e-3 * scene.smear_um,
                    };
                    match made.iter().find(|(other, _)| *other == recipe) {
                        Some((_, tile)) => tile.clone(),
                        None => {
                            let tile: Arc<Making> = Arc::new(LazyLock::new(Box::new(move || recipe.make())));
                            made.push((recipe, tile.clone()));
                            tile
                        }
                    }
                }),
            )
        });
        std::thread::spawn(move || {
            for (_, tile) in made {
                LazyLock::force(&tile);
            }
        });
        tiles
    }

    /// Waits for both.
    pub fn wait(&self) -> Result<[Arc<Tile>; 2], OpticsError> {
        let [left, right] = &self.0;
        Ok([(**left).clone()?, (**right).clone()?])
    }
}

impl Recipe {
    fn make(self) -> Result<Arc<Tile>, OpticsError> {
        Tile::new(self.texture, self.optics, self.slope, self.smear_mm).map(Arc::new)
    }
}

/// How the work of a side looks close up.
pub(super) fn texture(scene: &SceneFile, side: usize, seed: u64) -> Texture {
    Texture::new(scene.texture[side].finish(), seed)
}
