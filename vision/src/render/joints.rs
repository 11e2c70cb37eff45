//! Random joints with what real ones have, one effect at a time or mixed.

use super::effect::Effect;
use super::film::{Dirt, Glare};
use super::marks::{Mark, Tack};
use super::protocol::{EXPOSURE_S, SPEEDS_MM_S, Sight};
use super::random::SplitMix64;
use super::scene::{Blob, Gap, Joint, Light, Scene};
use super::side::Side;
use super::texture::{Finish, Texture};
use crate::geometry::PlateSeam;
use crate::noise::PhotonTransfer;
use crate::optics::Optics;

/// Finishes that metal usually has.
const FINISHES: [Finish; 4] = [Finish::Plain, Finish::Rolled, Finish::Blasted, Finish::Specular];

/// A random plate with a gap and all of `effects`, before a camera that is calibrated with `noise`: width 0.03–0.3 mm evenly in
/// its logarithm, roll ±8°, height ±0.2 mm, seam ±0.3 mm, yaw ±3.4°, two plates of the same finish; smeared by 5–9 m/min. A
/// small picture has smaller heights and offsets. The fast renderer smears as its tiles do.
pub fn random_joint(effects: &[Effect], optics: &Optics, noise: PhotonTransfer, seed: u64) -> Scene {
    let mut random = SplitMix64::new(seed);
    let sight = Sight::new(optics);
    let mut symmetric = |limit: f64| random.between(-limit, limit);
    let plate = PlateSeam {
        height_mm: symmetric((0.5 * sight.height).min(0.2)),
        pitch: 0.0,
        roll: symmetric(8f64.to_radians()).tan(),
        lateral_mm: symmetric((0.45 * sight.lateral).min(0.3)),
        yaw_rad: symmetric(3.4f64.to_radians()),
        width_mm: random.log_between(0.03, 0.3),
    };
    let gap = Gap {
        roughness_mm: 0.003,
        brightness: random.between(0.01, 0.06),
        ..Gap::new(plate)
    };
    let finish = FINISHES[(random.uniform() * FINISHES.len() as f64) as usize];
    let textures = [0; 2].map(|_| Texture::new(finish, random.bits()));
    let mut scene = Scene {
        position_mm: [random.between(0.0, 100.0), random.between(-1.0, 1.0)],
        right_texture: Some(textures[1]),
        light: Light {
            shading: [random.between(-0.15, 0.15), random.between(-0.15, 0.15), 0.0],
            ..Light::even(random.between(0.35, 0.6))
        },
        smear_mm: random.between(SPEEDS_MM_S[0], SPEEDS_MM_S[1]) * EXPOSURE_S,
        ..Scene::new(Joint::Gap(gap), textures[0])
    };
    let mut draw = Draw {
        random: SplitMix64::new(random.bits()),
        noise,
        sight,
    };
    for effect in effects {
        draw.apply(*effect, &mut scene, gap);
        if let Joint::Gap(changed) = &mut scene.joint {
            draw.alter(*effect, changed);
        }
    }
    scene
}

/// Gives effects to scenes.
#[derive(Clone, Debug)]
pub(super) struct Draw {
    pub random: SplitMix64,
    pub noise: PhotonTransfer,
    pub sight: Sight,
}

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.random.between(low, high)
    }

    fn sign(&mut self) -> f64 {
        if self.random.chance(0.5) { 1.0 } else { -1.0 }
    }

    fn side<'a>(&mut self, scene: &'a mut Scene) -> &'a mut Side {
        &mut scene.sides[usize::from(self.random.chance(0.5))]
    }

    /// What an effect makes of the gap itself.
    fn alter(&mut self, effect: Effect, gap: &mut Gap) {
        match effect {
            Effect::Closed | Effect::ClosedScratched | Effect::ClosedGrooved => gap.plate.width_mm = 0.0,
            Effect::LitWalls => gap.plate.roll = self.sign() * self.between(6.0, 10.0).to_radians().tan(),
            _ => {}
        }
    }

    /// What it gives to the rest of a scene with that gap.
    pub fn apply(&mut self, effect: Effect, scene: &mut Scene, gap: Gap) {
        let half = gap.plate.width_mm / 2.0;
        // Where the band crosses the seam (45°).
        let band = scene.position_mm[0] + gap.plate.height_mm + gap.plate.roll * gap.plate.lateral_mm;
        match effect {
            Effect::Plain | Effect::Closed => {}
            Effect::Ratio => self.side(scene).brightness = self.between(0.3, 0.9),
            Effect::DimPlate => self.side(scene).brightness = self.random.log_between(0.03, 0.2),
            Effect::Step => self.step(scene, [0.02, 0.1]),
            Effect::HighStep => self.step(scene, [0.1, 0.2]),
            Effect::OnePlate => *self.side(scene) = Side::missing(),
            Effect::OnePlateEnds => {
                let reaches_mm = self.end(band);
                self.side(scene).reaches_mm = reaches_mm;
            }
            Effect::PlateEnds => {
                let reaches_mm = self.end(band);
                scene
                    .sides
                    .iter_mut()
                    .for_each(|side| side.reaches_mm = reaches_mm);
            }
            Effect::Tack => {
                let from = band + self.between(-0.6, 0.4);
                let tack = Tack {
                    reaches_mm: [from, from + self.between(0.15, 0.8)],
                    width_mm: 2.0 * half + self.between(0.05, 0.3),
                    brightness: self.random.log_between(0.4, 1.6),
                };
                scene.tacks.push(tack);
            }
            Effect::SpatterOnEdge => self.spatter(scene, &gap.plate, band),
            Effect::ClosedScratched => {
                let mark = self.scratch(scene, -0.02, 0.02);
                scene.marks.push(mark);
            }
            Effect::ClosedGrooved => self.grooves(scene, 0.0),
            Effect::Grooves => self.grooves(scene, half + 0.02),
            Effect::GroovesAcross => {
                let (pitch, share) = (self.between(0.06, 0.25), self.between(0.2, 0.5));
                let (factor, shift) = (self.random.log_between(0.05, 0.6), self.between(0.0, pitch));
                let places = (-20..=20).map(|k| shift + f64::from(k) * pitch);
                let near = places.filter(|at| at.abs() < 1.5);
                scene
                    .marks
                    .extend(near.map(|at| Mark::across(band + at, share * pitch, factor)));
            }
            Effect::ScratchAcross => {
                for _ in 0..1 + (3.0 * self.random.uniform()) as usize {
                    let place = band + self.between(-0.4, 0.4);
                    let mark = Mark {
                        slope: self.between(-0.5, 0.5),
                        ..Mark::across(
                            place,
                            self.between(0.01, 0.06),
                            self.random.log_between(0.05, 0.35),
                        )
                    };
                    scene.marks.push(mark);
                }
            }
            Effect::Scratch => {
                let side = self.sign();
                let mut mark = self.scratch(scene, 0.03, 0.25);
                mark.offset_mm = side * (half + mark.width_mm / 2.0 + mark.offset_mm);
                scene.marks.push(mark);
            }
            Effect::BrightEdgesScratch => {
                self.apply(Effect::BrightEdges, scene, gap);
                self.apply(Effect::Scratch, scene, gap);
            }
            Effect::BrightEdges => {
                for side in &mut scene.sides {
                    side.rim = [self.between(0.005, 0.02), self.between(2.0, 5.0)];
                }
            }
            Effect::Chamfer => {
                let leg = self.between(0.015, 0.04);
                let factor = self.random.log_between(0.25, 1.5);
                let side = self.side(scene);
                (side.chamfer_mm, side.edge_factor) = (leg, factor);
            }
            Effect::Chamfers => {
                for side in &mut scene.sides {
                    side.chamfer_mm = self.between(0.015, 0.04);
                    side.edge_factor = self.random.log_between(0.25, 1.5);
                }
            }
            Effect::RolledEdge => self.side(scene).rounding_mm = self.between(0.02, 0.06),
            Effect::Burr => {
                let (height, factor) = (self.between(0.01, 0.04), self.between(1.0, 2.5));
                let side = self.side(scene);
                (side.burr_mm, side.edge_factor) = (height, factor);
            }
            Effect::LitWalls => {
                for side in &mut scene.sides {
                    side.wall_brightness = self.between(0.2, 0.7);
                }
            }
            Effect::Veil => scene.film.veil = self.between(0.1, 0.5) * scene.light.level,
            Effect::Glare => scene.film.glares.push(Glare {
                middle: [self.between(-1.0, 1.0), self.between(-1.0, 1.0)],
                radius: self.between(0.15, 0.6),
                level: self.between(0.2, 0.8),
            }),
            Effect::Plume => scene.film.glares.push(Glare {
                middle: [self.between(-0.5, 0.5), self.between(-1.5, -0.5)],
                radius: self.between(0.6, 1.5),
                level: self.between(0.1, 0.5),
            }),
            Effect::Flicker => scene.light.level *= self.between(0.4, 1.6),
            Effect::Dirt => {
                for _ in 0..1 + (4.0 * self.random.uniform()) as usize {
                    let spot = Dirt {
                        middle: [self.between(-1.0, 1.0), self.between(-1.0, 1.0)],
                        radius: self.between(0.05, 0.3),
                        factor: self.between(0.2, 0.8),
                    };
                    scene.film.dirt.push(spot);
                }
            }
            Effect::Noise => {
                scene.sensor.noise = Some(PhotonTransfer {
                    full_well: self.noise.full_well * self.between(0.5, 0.8),
                    read_noise: self.noise.read_noise * self.between(1.0, 1.6),
                });
            }
            Effect::Pattern => {
                scene.sensor.pattern = self.between(0.005, 0.02);
                scene.sensor.seed = self.random.bits();
            }
            Effect::Curvature => scene.curvature_mm = self.sign() * self.between(0.01, 0.05),
            Effect::Smear => scene.smear_mm = self.between(0.015, 0.04),
        }
    }

    fn step(&mut self, scene: &mut Scene, [least, most]: [f64; 2]) {
        let step_mm = self.sign() * self.between(least, most);
        let lower = usize::from(step_mm < 0.0);
        scene.sides[lower].shadow = [
            step_mm.abs() * self.between(0.4, 1.4),
            self.random.log_between(0.08, 0.5),
        ];
        if let Joint::Gap(gap) = &mut scene.joint {
            gap.step_mm = step_mm;
        }
    }

    /// From where to where a plate is there that begins or ends within 0.3 mm of a place.
    fn end(&mut self, place: f64) -> [f64; 2] {
        let end = place + self.between(-0.3, 0.3);
        if self.random.chance(0.5) {
            [f64::NEG_INFINITY, end]
        } else {
            [end, f64::INFINITY]
        }
    }

    /// A blob over one edge, near the band.
    pub fn spatter(&mut self, scene: &mut Scene, plate: &PlateSeam, band: f64) {
        let across = self.sign() * (plate.width_mm / 2.0 + self.between(-0.02, 0.05));
        let along = band + self.between(-0.05, 0.05);
        let seam = plate.lateral_mm + (along - scene.position_mm[0]) * plate.yaw_rad.tan();
        scene.blobs.push(Blob {
            middle_mm: [along, scene.position_mm[1] + seam + across],
            radius_mm: self.between(0.06, 0.2),
            brightness: self.random.log_between(0.05, 1.8),
        });
    }

    /// A dark scratch nearly along the seam.
    fn scratch(&mut self, scene: &Scene, nearest: f64, farthest: f64) -> Mark {
        Mark {
            at_mm: scene.position_mm[0],
            slope: self.between(-0.03, 0.03),
            ..Mark::along(
                self.between(nearest, farthest),
                self.between(0.01, 0.06),
                self.random.log_between(0.05, 0.35),
            )
        }
    }

    /// Regular grooves along the seam, none nearer to it than `beside`.
    fn grooves(&mut self, scene: &mut Scene, beside: f64) {
        let (pitch, share) = (self.between(0.06, 0.25), self.between(0.2, 0.5));
        let (factor, shift) = (self.random.log_between(0.05, 0.6), self.between(0.0, pitch));
        let far = 2.0 * self.sight.lateral;
        let places = (-30..=30).map(|k| shift + f64::from(k) * pitch);
        let seen = places.filter(|at| at.abs() >= beside && at.abs() < far);
        scene
            .marks
            .extend(seen.map(|at| Mark::along(at, share * pitch, factor)));
    }
}
