//! Makes the scene to render from what is in the field of view of a camera.

use super::scene_file::SceneFile;
use super::stretches::Stretches;
use super::view::{View, ViewForm};
use crate::marks::WIDTH_MM;
use std::f64::consts::TAU;
use vision::render::{Blob, Gap, Joint, Light, Root, Scene, SplitMix64, Stripe, Tack, Texture};
use vision::{Corner, PhotonTransfer, PlateSeam};

/// How far apart on the texture the two sides are, so that they show different places of it \[mm\].
const APART_MM: f64 = 3.1;
/// Half the field in which spatter lands: along travel and across \[mm\].
const SPATTER_MM: [f64; 2] = [0.5, 0.6];
/// The dark line where two walls touch \[mm\], and how bright it is.
const CONTACT: (f64, f64) = (0.02, 0.35);
/// How much wider than a mark the plate beyond its ends is rendered over it, so that no edge of it stays \[mm\].
const COVERS_MM: f64 = 0.02;
/// Light from wall to wall at the root of a corner.
const INTERREFLECTION: f64 = 0.2;

/// What is drawn of one picture besides what stands before the camera.
pub(super) struct Draw<'a> {
    pub file: &'a SceneFile,
    /// 0 or 1.
    pub side: usize,
    /// Textures left and right of the seam.
    pub textures: [Texture; 2],
    /// Electrons that are calibrated.
    pub noise: PhotonTransfer,
    /// Whether the light is off.
    pub dark: bool,
}

impl Draw<'_> {
    /// The scene; everything random in it comes from `random`.
    pub fn scene(&self, view: &View, random: &mut SplitMix64) -> Scene {
        let file = self.file;
        let [noise, _] = random.gauss();
        let height_mm = view.height_mm + 1e-3 * file.height_noise_um * noise;
        let wave = |length: f64| (TAU * (view.along_mm / length + 0.3 * self.side as f64)).sin();
        let rolls = (file.roll_wave_deg * wave(file.roll_wave_length_mm)).to_radians();
        let joint = match view.form {
            ViewForm::Plate { pitch, roll, yaw_rad } => {
                let width_mm = file.gap_mm + file.gap_wave_mm * wave(file.gap_wave_length_mm);
                Joint::Gap(Gap::new(PlateSeam {
                    height_mm: height_mm - (roll + rolls.tan()) * view.lateral_mm,
                    pitch,
                    roll: roll + rolls.tan(),
                    lateral_mm: view.lateral_mm,
                    yaw_rad,
                    width_mm,
                }))
            }
            ViewForm::Bare { pitch, roll, mark } => Joint::Gap(Gap::new(PlateSeam {
                height_mm: height_mm - roll * view.lateral_mm,
                pitch,
                roll,
                lateral_mm: view.lateral_mm,
                yaw_rad: mark.map_or(0.0, |mark| mark.yaw_rad),
                width_mm: mark.map_or(0.0, |_| WIDTH_MM),
            })),
            ViewForm::Corner { walls } => Joint::Corner(Root {
                interreflection: INTERREFLECTION,
                ..Root::new(Corner {
                    height_mm,
                    lateral_mm: view.lateral_mm,
                    walls: walls.map(|slope| (slope.atan() + rolls).tan()),
                })
            }),
        };
        let position_mm = [view.along_mm + APART_MM * self.side as f64, -view.lateral_mm];
        let mut scene = Scene {
            position_mm,
            light: Light::even(if self.dark { 0.0 } else { file.light }),
            smear_mm: 1e-3 * file.smear_um,
            ..Scene::new(joint, self.textures[0])
        };
        if self.textures[1] != self.textures[0] {
            scene.right_texture = Some(self.textures[1]);
        }
        if let ViewForm::Bare { mark: Some(mark), .. } = view.form {
            // Beyond its ends there is the plate.
            let [from, to] = mark.ends_mm.map(|end| end + position_mm[0]);
            for reaches_mm in [[f64::NEG_INFINITY, from], [to, f64::INFINITY]] {
                scene.tacks.push(Tack {
                    reaches_mm,
                    width_mm: WIDTH_MM + COVERS_MM,
                    brightness: 1.0,
                });
            }
        }
        if let ViewForm::Corner { .. } = view.form {
            let (width_mm, factor) = CONTACT;
            scene.stripes.push(Stripe {
                offset_mm: 0.0,
                width_mm,
                factor,
            });
        }
        scene.stripes.extend(self.scratches(view.along_mm));
        if random.chance(file.spatter_share) {
            self.spatter(&mut scene, view, random);
        }
        let stretches = Stretches {
            file,
            side: self.side,
            along_mm: view.along_mm,
            noise: self.noise,
        };
        stretches.give(&mut scene, random);
        scene
    }

    fn scratches(&self, along_mm: f64) -> impl Iterator<Item = Stripe> {
        let here = move |from: Option<f64>, to: Option<f64>| {
            from.is_none_or(|from| along_mm >= from) && to.is_none_or(|to| along_mm <= to)
        };
        let mine = self.file.scratch.iter().filter(move |scratch| {
            usize::from(scratch.side) == self.side + 1 && here(scratch.from_s_mm, scratch.to_s_mm)
        });
        mine.map(|scratch| Stripe {
            offset_mm: scratch.offset_mm,
            width_mm: scratch.width_mm,
            factor: scratch.brightness,
        })
    }

    /// One to three spots of spatter, dark or bright, every second of them on the seam.
    fn spatter(&self, scene: &mut Scene, view: &View, random: &mut SplitMix64) {
        let [long, wide] = SPATTER_MM;
        for _ in 0..1 + (3.0 * random.uniform()) as usize {
            let across = if random.chance(0.5) {
                view.lateral_mm + random.between(-0.1, 0.1)
            } else {
                random.between(-wide, wide)
            };
            let place = [random.between(-long, long), across];
            scene.blobs.push(Blob {
                middle_mm: [0, 1].map(|i| scene.position_mm[i] + place[i]),
                radius_mm: random.log_between(0.01, 0.12),
                brightness: if random.chance(0.5) {
                    random.between(0.05, 0.4)
                } else {
                    random.between(1.5, 2.5)
                },
            });
        }
    }
}
