//! Random pictures, as an acceptance test of a detector wants them.

use super::random::SplitMix64;
use super::scene::{Blob, Gap, Joint, Light, Root, Scene, Stripe};
use super::texture::{Finish, Texture};
use crate::geometry::{Corner, PlateSeam};
use crate::optics::Optics;

/// Exposure of the cameras \[s\].
pub(super) const EXPOSURE_S: f64 = 50e-6;

/// Speeds of 5 and 9 m/min \[mm/s\].
pub(super) const SPEEDS_MM_S: [f64; 2] = [5000.0 / 60.0, 9000.0 / 60.0];

/// What lies in sight of a camera to each side of its axis \[mm\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    /// Along u.
    pub lateral: f64,
    /// Heights whose band is in the picture, on the axis.
    pub height: f64,
}

impl Sight {
    pub fn new(optics: &Optics) -> Self {
        let half = optics.object_pixel_mm() / 2.0;
        Self {
            lateral: optics.columns as f64 * half,
            height: optics.rows as f64 * half * optics.tilt_rad.sin(),
        }
    }
}

/// A random plate with a gap: any finish, width 0.02–0.3 mm evenly in its logarithm, roll ±10°, height ±0.2 mm, seam
/// ±0.3 mm, yaw ±3.4°, half of them with a step up to 0.05 mm; falling light, haze, rough edges with rims; 30 % with
/// scratches along the seam, 20 % with a strip beside the gap, 5 % with spatter (every second of them with a blob on the
/// seam); 4 % out of the band, 1 % without light, 2 % in dim light, 3 % with the gap closed; smeared by 5–9 m/min.
/// A small picture has smaller heights and offsets.
pub fn random_gap(seed: u64, optics: &Optics) -> Scene {
    let mut random = SplitMix64::new(seed);
    let sight = Sight::new(optics);
    let mut symmetric = |limit: f64| random.between(-limit, limit);
    let roll = symmetric(10f64.to_radians()).tan();
    let mut plate = PlateSeam {
        height_mm: symmetric((0.55 * sight.height).min(0.2)),
        pitch: 0.0,
        roll,
        lateral_mm: symmetric((0.45 * sight.lateral).min(0.3)),
        yaw_rad: symmetric(3.4f64.to_radians()),
        width_mm: random.log_between(0.02, 0.3),
    };
    let mut light = falling_light(&mut random);
    match random.uniform() {
        x if x < 0.04 => {
            let beyond = sight.height + roll.abs() * sight.lateral + random.between(0.03, 0.3);
            plate.height_mm = beyond.copysign(plate.height_mm);
        }
        x if x < 0.05 => light.level = random.between(0.0, 0.01),
        x if x < 0.07 => light.level = random.between(0.06, 0.15),
        x if x < 0.10 => plate.width_mm = 0.0,
        _ => {}
    }
    let gap = Gap {
        plate,
        step_mm: if random.chance(0.5) {
            random.between(-0.05, 0.05)
        } else {
            0.0
        },
        roughness_mm: 0.004,
        brightness: random.between(0.02, 0.1),
    };
    let texture = random_texture(&mut random);
    let mut scene = Scene {
        position_mm: [random.between(0.0, 100.0), random.between(-1.0, 1.0)],
        light,
        smear_mm: random.between(SPEEDS_MM_S[0], SPEEDS_MM_S[1]) * EXPOSURE_S,
        ..Scene::new(Joint::Gap(gap), texture)
    };
    if plate.width_mm > 0.0 {
        rims(&mut scene, plate.width_mm, &mut random);
    }
    if random.chance(0.2) {
        let (side, width_mm) = (
            if random.chance(0.5) { 1.0 } else { -1.0 },
            random.between(0.05, 0.25),
        );
        scene.stripes.push(Stripe {
            offset_mm: side * (plate.width_mm + width_mm) / 2.0,
            width_mm,
            factor: if random.chance(0.5) {
                random.between(0.6, 0.85)
            } else {
                random.between(1.15, 1.4)
            },
        });
    }
    if random.chance(0.3) {
        scratches(&mut scene, plate.width_mm, &mut random);
    }
    if random.chance(0.05) {
        spatter(&mut scene, &plate, &sight, &mut random);
    }
    scene
}

/// A random closed corner: walls of slope 0.6–0.9, one of them up to 30 % darker, light from wall to wall +20 % at the
/// root, a dark line of 20 µm where they touch, falling light, smeared by 9 m/min.
pub fn random_corner(seed: u64, optics: &Optics) -> Scene {
    let mut random = SplitMix64::new(seed);
    let sight = Sight::new(optics);
    let corner = Corner {
        height_mm: sight.height * random.between(-0.6, 0.2),
        lateral_mm: random.between(-1.0, 1.0) * (0.3 * sight.lateral).min(0.2),
        walls: [-random.between(0.6, 0.9), random.between(0.6, 0.9)],
    };
    let mut brightness = [1.0; 2];
    brightness[usize::from(random.chance(0.5))] = random.between(0.7, 1.0);
    let root = Root {
        brightness,
        interreflection: 0.2,
        ..Root::new(corner)
    };
    let light = falling_light(&mut random);
    let texture = random_texture(&mut random);
    Scene {
        position_mm: [random.between(0.0, 100.0), random.between(-1.0, 1.0)],
        stripes: vec![Stripe {
            offset_mm: 0.0,
            width_mm: 0.02,
            factor: 0.3,
        }],
        light: Light { haze: 0.0, ..light },
        smear_mm: SPEEDS_MM_S[1] * EXPOSURE_S,
        ..Scene::new(Joint::Corner(root), texture)
    }
}

fn random_texture(random: &mut SplitMix64) -> Texture {
    let finish = Finish::ALL[(random.uniform() * Finish::ALL.len() as f64) as usize];
    Texture::new(finish, random.bits())
}

fn falling_light(random: &mut SplitMix64) -> Light {
    Light {
        level: random.between(0.35, 0.6),
        shading: [
            random.between(-0.15, 0.15),
            random.between(-0.15, 0.15),
            random.between(0.0, 0.3),
        ],
        haze: random.between(0.0, 0.1),
    }
}

/// Bright or dark rims of half of the edges.
fn rims(scene: &mut Scene, gap_mm: f64, random: &mut SplitMix64) {
    for side in [-1.0, 1.0] {
        if random.chance(0.5) {
            let width_mm = random.between(0.006, 0.02);
            scene.stripes.push(Stripe {
                offset_mm: side * (gap_mm + width_mm) / 2.0,
                width_mm,
                factor: random.between(0.6, 1.5),
            });
        }
    }
}

/// One to three scratches beside the gap, three of ten bright.
fn scratches(scene: &mut Scene, gap_mm: f64, random: &mut SplitMix64) {
    let count = 1 + (3.0 * random.uniform()) as usize;
    for _ in 0..count {
        let width_mm = random.between(0.005, 0.03);
        let clear = (gap_mm + width_mm) / 2.0 + 0.02;
        let side = if random.chance(0.5) { 1.0 } else { -1.0 };
        scene.stripes.push(Stripe {
            offset_mm: side * random.between(clear, clear + 0.4),
            width_mm,
            factor: if random.chance(0.3) {
                random.between(1.25, 1.7)
            } else {
                random.between(0.35, 0.75)
            },
        });
    }
}

/// One to six blobs in the picture; in every second picture the first lies on the seam, close to the band.
pub(super) fn spatter(scene: &mut Scene, plate: &PlateSeam, sight: &Sight, random: &mut SplitMix64) {
    let on_seam = random.chance(0.5);
    let count = 1 + (6.0 * random.uniform()) as usize;
    for k in 0..count {
        let (a, u) = if k == 0 && on_seam {
            // The band crosses the seam where the plate is as far along as it is high (45°).
            let a = plate.height_mm + random.between(-0.15, 0.15);
            let beside = random.between(-1.0, 1.0) * (plate.width_mm / 2.0 + 0.05);
            (a, plate.lateral_mm + a * plate.yaw_rad.tan() + beside)
        } else {
            (
                random.between(-0.7, 0.7),
                random.between(-1.0, 1.0) * sight.lateral,
            )
        };
        scene.blobs.push(Blob {
            middle_mm: [scene.position_mm[0] + a, scene.position_mm[1] + u],
            radius_mm: random.between(0.02, 0.15),
            brightness: if random.chance(0.6) {
                random.between(0.03, 0.4)
            } else {
                random.between(1.3, 2.0)
            },
        });
    }
}
