//! Textured work for the renderers of both sides, made in the background.

use super::scene_file::SceneFile;
use camera::nominal_slopes;
use config::machine::{CameraConfig, JointForm};
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
            let textures = textures(scene, cameras.joint, side, seed);
            let mount_rad = cameras.mount_deg[side].to_radians();
            let slopes = nominal_slopes(cameras.joint, mount_rad, heads, side);
            Self([0, 1].map(|k| {
                let recipe = Recipe {
                    texture: textures[k],
                    optics: cameras.optics,
                    slope: slopes[k],
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
            }))
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

/// How the work of a side looks close up, left and right of the seam.
pub(super) fn textures(scene: &SceneFile, joint: JointForm, side: usize, seed: u64) -> [Texture; 2] {
    let left = Texture::new(scene.texture[side].finish(), seed);
    match (scene.right_texture, joint) {
        // Another piece, of whatever finish.
        (Some(right), JointForm::Gap) => [left, Texture::new(right[side].finish(), !seed)],
        _ => [left; 2],
    }
}
