//! Random joints with what real ones have, one effect at a time or mixed.

use crate::camera::Exposure;
use crate::texture::{Grain, Texture};
use crate::work::{Blob, Glare, Mark, Shadow, Side, Work};
use rand::rngs::SmallRng;
use rand::{Rng, RngExt, SeedableRng};
use vision::{Optics, PhotonTransfer};

/// Exposure \[s\] and speeds \[mm/s\].
const EXPOSURE_S: f64 = 50e-6;
const SPEEDS: [f64; 2] = [83.0, 150.0];

/// What a picture has beside a plain joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    Plain,
    /// One plate has 30 to 90 % of the other's brightness.
    Ratio,
    /// One plate has 3 to 20 % of the other's brightness.
    DimPlate,
    /// The plates are 20 to 100 µm offset, and the lower one lies in the other's shadow.
    Step,
    /// Offset by 0.1 to 0.2 mm.
    HighStep,
    /// Only one plate is in sight.
    OnePlate,
    /// Both plates end in the picture.
    PlateEnds,
    /// Spatter hides one edge.
    SpatterOnEdge,
    /// A closed joint with a dark scratch along it.
    ClosedScratched,
    /// A closed joint with regular grooves along it.
    ClosedGrooved,
    /// A dark scratch beside the gap.
    Scratch,
    /// Bright lines along the edges, and a dark scratch beside the gap.
    BrightEdgesScratch,
    /// Bright lines along the edges, 2 to 5 times the plate.
    BrightEdges,
    /// Regular grooves beside the gap.
    Grooves,
    /// A chamfer of 15 to 40 µm on one side.
    Chamfer,
    /// Chamfers on both.
    Chamfers,
    /// A rolled edge of 20 to 60 µm.
    RolledEdge,
    /// A burr of 10 to 40 µm.
    Burr,
    /// Lit walls of the gap, at a roll of 6 to 10°.
    LitWalls,
    /// A veil of 10 to 50 %.
    Veil,
    /// Glare.
    Glare,
    /// More noise than is calibrated.
    Noise,
    /// Up to 40 µm of travel during the exposure.
    Smear,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 23] = [
        Self::Plain,
        Self::Ratio,
        Self::DimPlate,
        Self::Step,
        Self::HighStep,
        Self::OnePlate,
        Self::PlateEnds,
        Self::SpatterOnEdge,
        Self::ClosedScratched,
        Self::ClosedGrooved,
        Self::Scratch,
        Self::BrightEdgesScratch,
        Self::BrightEdges,
        Self::Grooves,
        Self::Chamfer,
        Self::Chamfers,
        Self::RolledEdge,
        Self::Burr,
        Self::LitWalls,
        Self::Veil,
        Self::Glare,
        Self::Noise,
        Self::Smear,
    ];

    /// Whether there is a seam to be measured.
    pub fn has_seam(self) -> bool {
        !matches!(self, Self::OnePlate | Self::ClosedScratched | Self::ClosedGrooved)
    }
}

/// How the plates were made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Fine and coarse noise.
    Ground,
    /// Streaks along the seam.
    Rolled,
    /// With glints.
    Blasted,
}

/// Work and how its picture is taken.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The work.
    pub work: Work,
    /// The exposure.
    pub exposure: Exposure,
    /// How the plates were made.
    pub finish: Finish,
}

struct Draw(SmallRng);

impl Draw {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.0.random::<f64>()
    }

    fn log_between(&mut self, from: f64, to: f64) -> f64 {
        self.between(from.ln(), to.ln()).exp()
    }

    fn sign(&mut self) -> f64 {
        if self.0.random::<bool>() { 1.0 } else { -1.0 }
    }

    fn side(&mut self) -> usize {
        usize::from(self.0.random::<bool>())
    }
}

/// The subject of `seed`, with all of `effects`, before a camera with `noise` that is as it was calibrated.
pub fn subject(effects: &[Effect], optics: &Optics, noise: PhotonTransfer, seed: u64) -> Subject {
    let mut draw = Draw(SmallRng::seed_from_u64(seed));
    let finish = [Finish::Ground, Finish::Rolled, Finish::Blasted][draw.0.random_range(0..3)];
    let half_view = 0.5 * optics.object_pixel_mm() * optics.columns as f64;
    let half_height = 0.5 * optics.object_pixel_mm() * optics.rows as f64 * optics.tilt_rad.sin();
    let mut symmetric = |limit: f64| draw.between(-limit, limit);
    let roll = symmetric(8f64.to_radians()).tan();
    let height_mm = symmetric((0.5 * half_height).min(0.2));
    let lateral_mm = symmetric((0.45 * half_view).min(0.3));
    let yaw_rad = symmetric(3.4f64.to_radians());
    let shading = [symmetric(0.15), symmetric(0.15)];
    let textures = [0, 1].map(|_| texture(finish, draw.0.next_u64()));
    let mut subject = Subject {
        work: Work {
            height_mm,
            roll,
            lateral_mm,
            yaw_rad,
            width_mm: draw.log_between(0.03, 0.3),
            step_mm: 0.0,
            sides: [Side::default(); 2],
            textures,
            roughness_mm: 0.003,
            marks: Vec::new(),
            shadows: Vec::new(),
            blobs: Vec::new(),
            along_mm: draw.between(0.0, 3.0),
            level: draw.between(0.35, 0.6),
            shading,
            veil: 0.01,
            glare: None,
        },
        exposure: Exposure {
            noise,
            smear_mm: EXPOSURE_S * draw.between(SPEEDS[0], SPEEDS[1]),
            seed,
        },
        finish,
    };
    for effect in effects {
        apply(*effect, &mut subject, &mut draw);
    }
    subject
}

fn texture(finish: Finish, seed: u64) -> Texture {
    let grain = |along: f64, across: f64, contrast: f64| Grain {
        along_mm: along,
        across_mm: across,
        contrast,
    };
    match finish {
        Finish::Ground => Texture::new(
            &[grain(0.012, 0.012, 0.12), grain(0.032, 0.032, 0.1)],
            false,
            seed,
        ),
        Finish::Rolled => Texture::new(&[grain(0.2, 0.012, 0.1), grain(0.016, 0.012, 0.09)], false, seed),
        Finish::Blasted => Texture::new(&[grain(0.012, 0.012, 0.25), grain(0.04, 0.04, 0.12)], true, seed),
    }
}

fn apply(effect: Effect, subject: &mut Subject, draw: &mut Draw) {
    let work = &mut subject.work;
    let half = work.width_mm / 2.0;
    match effect {
        Effect::Plain => {}
        Effect::Ratio => work.sides[draw.side()].brightness = draw.between(0.3, 0.9),
        Effect::DimPlate => work.sides[draw.side()].brightness = draw.log_between(0.03, 0.2),
        Effect::Step | Effect::HighStep => {
            let [least, most] = if effect == Effect::Step {
                [0.02, 0.1]
            } else {
                [0.1, 0.2]
            };
            work.step_mm = draw.sign() * draw.between(least, most);
            work.shadows.push(Shadow {
                side: usize::from(work.step_mm < 0.0),
                width_mm: work.step_mm.abs() * draw.between(0.4, 1.4),
                factor: draw.log_between(0.08, 0.5),
            });
        }
        Effect::OnePlate => work.sides[draw.side()].ends_mm = f64::NEG_INFINITY,
        Effect::PlateEnds => {
            let end = work.along_mm + draw.between(-0.3, 0.3);
            work.sides.iter_mut().for_each(|side| side.ends_mm = end);
        }
        Effect::SpatterOnEdge => {
            let across = draw.sign() * (half + draw.between(-0.02, 0.05));
            // Where the band crosses the seam.
            work.blobs.push(Blob {
                middle_mm: [work.height_mm + draw.between(-0.05, 0.05), across],
                radius_mm: draw.between(0.06, 0.2),
                brightness: draw.log_between(0.05, 1.8),
            });
        }
        Effect::ClosedScratched => {
            work.width_mm = 0.0;
            let mark = scratch(draw, -0.02, 0.02);
            work.marks.push(mark);
        }
        Effect::ClosedGrooved | Effect::Grooves => {
            let (pitch, share) = (draw.between(0.06, 0.25), draw.between(0.2, 0.5));
            let (factor, shift) = (draw.log_between(0.05, 0.6), draw.between(0.0, pitch));
            let beside = if effect == Effect::Grooves {
                half + 0.02
            } else {
                0.0
            };
            if effect == Effect::ClosedGrooved {
                work.width_mm = 0.0;
            }
            let places = (-12..=12).map(|k| shift + f64::from(k) * pitch);
            work.marks
                .extend(places.filter(|at| at.abs() >= beside).map(|offset_mm| Mark {
                    offset_mm,
                    width_mm: share * pitch,
                    factor,
                    slope: 0.0,
                }));
        }
        Effect::Scratch => {
            let side = draw.sign();
            let mut mark = scratch(draw, 0.03, 0.25);
            mark.offset_mm = side * (half + mark.width_mm / 2.0 + mark.offset_mm);
            work.marks.push(mark);
        }
        Effect::BrightEdgesScratch => {
            apply(Effect::BrightEdges, subject, draw);
            apply(Effect::Scratch, subject, draw);
        }
        Effect::BrightEdges => {
            for side in &mut work.sides {
                side.rim = [draw.between(0.005, 0.02), draw.between(2.0, 5.0)];
            }
        }
        Effect::Chamfer | Effect::Chamfers => {
            let first = draw.side();
            for k in 0..2 {
                if k == first || effect == Effect::Chamfers {
                    work.sides[k].chamfer_mm = draw.between(0.015, 0.04);
                    work.sides[k].chamfer_brightness = draw.log_between(0.25, 1.5);
                }
            }
        }
        Effect::RolledEdge => work.sides[draw.side()].rounding_mm = draw.between(0.02, 0.06),
        Effect::Burr => work.sides[draw.side()].burr_mm = draw.between(0.01, 0.04),
        Effect::LitWalls => {
            work.roll = draw.sign() * draw.between(6.0, 10.0).to_radians().tan();
            work.sides
                .iter_mut()
                .for_each(|side| side.wall_brightness = draw.between(0.2, 0.7));
        }
        Effect::Veil => work.veil = draw.between(0.1, 0.5) * work.level,
        Effect::Glare => {
            work.glare = Some(Glare {
                middle: [draw.between(-1.0, 1.0), draw.between(-1.0, 1.0)],
                radius: draw.between(0.15, 0.6),
                level: draw.between(0.2, 0.8),
            });
        }
        Effect::Noise => {
            subject.exposure.noise.full_well *= draw.between(0.5, 0.8);
            subject.exposure.noise.read_noise *= draw.between(1.0, 1.6);
        }
        Effect::Smear => subject.exposure.smear_mm = draw.between(0.015, 0.04),
    }
}

/// A dark scratch nearly along the seam.
fn scratch(draw: &mut Draw, nearest: f64, farthest: f64) -> Mark {
    Mark {
        offset_mm: draw.between(nearest, farthest),
        width_mm: draw.between(0.01, 0.06),
        factor: draw.log_between(0.05, 0.35),
        slope: draw.between(-0.03, 0.03),
    }
}
