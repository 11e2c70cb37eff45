//! Random seams from picture to picture, as an acceptance test of an observer wants them.

use super::motion::Motion;
use super::protocol::{Sight, random_gap, spatter};
use super::random::SplitMix64;
use super::scene::{Joint, Scene};
use super::truth::Shown;
use crate::observer::Moved;
use crate::optics::Optics;

/// Light that is not dim, as a share of full scale.
const BRIGHT: f64 = 0.2;

/// Pictures of one seam, 200 a second, by a camera that travels along it at 5–9 m/min while its slides move.
///
/// Width, texture, roughness, scratches and light are those of a [`random_gap`]; the seam runs straight and level, slanted
/// by its yaw. Of the pictures 4 % are out of the band, 1 % without light, 2 % in dim light, 3 % show the gap closed, 5 %
/// spatter. Each comes with what the camera has moved since the one before.
#[derive(Clone, Debug)]
pub struct RandomRun {
    base: Scene,
    sight: Sight,
    random: SplitMix64,
    motion: Motion,
}

impl RandomRun {
    /// The seam of a seed.
    pub fn new(seed: u64, optics: &Optics) -> Self {
        let mut random = SplitMix64::new(seed);
        let usable = |scene: &Scene| {
            let shown = scene.truth(optics).map(|truth| truth.shown);
            shown == Some(Shown::Seam) && scene.light.level > BRIGHT && scene.blobs.is_empty()
        };
        let mut base = random_gap(random.bits(), optics);
        while !usable(&base) {
            base = random_gap(random.bits(), optics);
        }
        Self {
            motion: Motion::new(&base),
            base,
            sight: Sight::new(optics),
            random,
        }
    }
}

impl Iterator for RandomRun {
    type Item = (Scene, Moved);

    fn next(&mut self) -> Option<(Scene, Moved)> {
        let moved = self.motion.go(&mut self.random);
        let mut scene = self.base.clone();
        self.motion.place(&mut scene);
        let Joint::Gap(gap) = &mut scene.joint else {
            return None;
        };
        let (plate, roll) = (&mut gap.plate, self.motion.at[2]);
        match self.random.uniform() {
            x if x < 0.04 => {
                let reach = self.sight.height + roll.abs() * self.sight.lateral;
                let beyond = reach + self.random.between(0.03, 0.3);
                plate.height_mm = beyond.copysign(self.random.between(-1.0, 1.0));
            }
            x if x < 0.05 => scene.light.level = self.random.between(0.0, 0.01),
            x if x < 0.07 => scene.light.level = self.random.between(0.06, 0.15),
            x if x < 0.10 => plate.width_mm = 0.0,
            _ => {}
        }
        let plate = *plate;
        if self.random.chance(0.05) {
            spatter(&mut scene, &plate, &self.sight, &mut self.random);
        }
        Some((scene, moved))
    }
}
