//! How a camera moves from picture to picture along a random seam.

use super::protocol::EXPOSURE_S;
use super::random::SplitMix64;
use super::scene::{Joint, Scene};
use crate::observer::Moved;

/// Time from picture to picture \[s\].
pub(super) const CYCLE_S: f64 = 0.005;

/// How far the slides move between pictures, and how far from where they began \[mm\].
const STEP_MM: f64 = 0.02;
const WAY_MM: f64 = 0.06;

/// How much the roll changes between pictures.
const ROLL: f64 = 0.005;

/// A camera that travels along a straight, level seam at the speed that smears its pictures, while its slides move.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Height and lateral position of the seam from the camera, and roll.
    pub at: [f64; 3],
    /// Where those began.
    from: [f64; 3],
    /// Since the first picture.
    pub travel_mm: f64,
    begun: bool,
    /// From one picture to the next.
    pub pitch_mm: f64,
    /// What the seam gains across travel.
    slant: f64,
}

impl Motion {
    /// The seam of a scene.
    pub fn new(scene: &Scene) -> Self {
        let (at, slant) = match &scene.joint {
            Joint::Gap(gap) => {
                let plate = &gap.plate;
                let height = plate.height_mm + plate.roll * plate.lateral_mm;
                ([height, plate.lateral_mm, plate.roll], plate.yaw_rad.tan())
            }
            Joint::Corner(_) => ([0.0; 3], 0.0),
        };
        Self {
            at,
            from: at,
            travel_mm: 0.0,
            begun: false,
            pitch_mm: scene.smear_mm * CYCLE_S / EXPOSURE_S,
            slant,
        }
    }

    /// Where the camera goes before the next picture.
    pub fn go(&mut self, random: &mut SplitMix64) -> Moved {
        if !self.begun {
            self.begun = true;
            return Moved::default();
        }
        let before = self.at;
        for (k, step) in [STEP_MM, STEP_MM, ROLL].into_iter().enumerate() {
            let way = WAY_MM * step / STEP_MM;
            let next = self.at[k] + random.between(-step, step);
            self.at[k] = next.clamp(self.from[k] - way, self.from[k] + way);
        }
        let travel_mm = self.pitch_mm;
        self.travel_mm += travel_mm;
        Moved {
            travel_mm,
            lateral_mm: self.slant * travel_mm - (self.at[1] - before[1]),
            height_mm: before[0] - self.at[0],
        }
    }

    /// Puts a scene of that seam where the camera is.
    pub fn place(&self, scene: &mut Scene) {
        scene.position_mm[0] += self.travel_mm;
        if let Joint::Gap(gap) = &mut scene.joint {
            let [height, lateral, roll] = self.at;
            let plate = &mut gap.plate;
            (plate.lateral_mm, plate.roll) = (lateral, roll);
            // The seam is level.
            plate.pitch = -roll * plate.yaw_rad.tan();
            plate.height_mm = height - roll * lateral;
        }
    }
}
