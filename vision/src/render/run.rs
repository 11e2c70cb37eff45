//! Random seams from picture to picture, as an acceptance test of an observer wants them.

use super::protocol::{EXPOSURE_S, Sight, random_gap, spatter};
use super::random::SplitMix64;
use super::scene::{Joint, Scene};
use super::truth::Shown;
use crate::observer::Moved;
use crate::optics::Optics;

/// Time from picture to picture \[s\].
const CYCLE_S: f64 = 0.005;

/// How far the slides move between pictures, and how far from where they began \[mm\].
const STEP_MM: f64 = 0.02;
const WAY_MM: f64 = 0.06;

/// How much the roll changes between pictures.
const ROLL: f64 = 0.005;

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
    /// Height and lateral position of the seam from the camera, and roll.
    at: [f64; 3],
    /// Where those began.
    from: [f64; 3],
    travel_mm: f64,
    begun: bool,
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
        let at = match &base.joint {
            Joint::Gap(gap) => {
                let plate = &gap.plate;
                let height = plate.height_mm + plate.roll * plate.lateral_mm;
                [height, plate.lateral_mm, plate.roll]
            }
            Joint::Corner(_) => [0.0; 3],
        };
        Self {
            base,
            sight: Sight::new(optics),
            random,
            at,
            from: at,
            travel_mm: 0.0,
            begun: false,
        }
    }

    /// Where the camera goes before the next picture.
    fn go(&mut self) -> Moved {
        if !self.begun {
            self.begun = true;
            return Moved::default();
        }
        let before = self.at;
        for (k, step) in [STEP_MM, STEP_MM, ROLL].into_iter().enumerate() {
            let way = WAY_MM * step / STEP_MM;
            let next = self.at[k] + self.random.between(-step, step);
            self.at[k] = next.clamp(self.from[k] - way, self.from[k] + way);
        }
        let travel_mm = self.base.smear_mm * CYCLE_S / EXPOSURE_S;
        self.travel_mm += travel_mm;
        let slant = match &self.base.joint {
            Joint::Gap(gap) => gap.plate.yaw_rad.tan(),
            Joint::Corner(_) => 0.0,
        };
        Moved {
            travel_mm,
            lateral_mm: slant * travel_mm - (self.at[1] - before[1]),
            height_mm: before[0] - self.at[0],
        }
    }
}

impl Iterator for RandomRun {
    type Item = (Scene, Moved);

    fn next(&mut self) -> Option<(Scene, Moved)> {
        let moved = self.go();
        let mut scene = self.base.clone();
        scene.position_mm[0] += self.travel_mm;
        let Joint::Gap(gap) = &mut scene.joint else {
            return None;
        };
        let [height, lateral, roll] = self.at;
        let plate = &mut gap.plate;
        (plate.lateral_mm, plate.roll) = (lateral, roll);
        // The seam is level.
        plate.pitch = -roll * plate.yaw_rad.tan();
        plate.height_mm = height - roll * lateral;
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
