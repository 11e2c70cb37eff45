//! Rays from the pixels through the lens to the work.

use crate::section::{Piece, Section};
use crate::work::Work;
use nalgebra::Vector3;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use vision::{Optics, PhotonTransfer};

/// Random numbers a ray takes: lens, area of the pixel, diffraction, travel.
const NUMBERS: usize = 7;
/// Standard deviation of diffraction, in wavelengths over the aperture.
const DIFFRACTION: f64 = 0.21;
/// Depth in which the light on a gap's wall fades \[mm\].
const FADING_MM: f64 = 0.1;
/// Spatter lies so far above the plate \[mm\].
const SPATTER_MM: f64 = 0.01;
/// Length over which edges wander \[mm\].
const WANDER_MM: f64 = 0.03;

/// A camera that traces rays.
#[derive(Clone, Debug)]
pub struct Camera {
    optics: Optics,
    rays: usize,
    /// Steps of the numbers from ray to ray: they fill their cube evenly.
    steps: [f64; NUMBERS],
}

/// How a picture is taken.
#[derive(Clone, Copy, Debug)]
pub struct Exposure {
    /// Electrons of light and noise.
    pub noise: PhotonTransfer,
    /// How far the work travels meanwhile \[mm\].
    pub smear_mm: f64,
    /// Of everything random.
    pub seed: u64,
}

/// The seam's own frame, and the two sides in it.
struct Joint<'a> {
    work: &'a Work,
    origin: Vector3<f64>,
    along: Vector3<f64>,
    across: Vector3<f64>,
    out: Vector3<f64>,
    sides: [Section; 2],
    wander: [Vec<f64>; 2],
}

impl Camera {
    /// A camera that traces so many rays a pixel.
    pub fn new(optics: Optics, rays: usize) -> Self {
        // The root of x^(n+1) = x + 1 (generalised golden ratio).
        let mut root = 1.2f64;
        for _ in 0..60 {
            root = (1.0 + root).powf(1.0 / (NUMBERS as f64 + 1.0));
        }
        Self {
            optics,
            rays,
            steps: std::array::from_fn(|k| root.powi(-(k as i32) - 1)),
        }
    }

    /// The picture, rows from the top.
    pub fn picture(&self, work: &Work, exposure: &Exposure) -> Vec<u8> {
        let Optics { rows, columns, .. } = self.optics;
        let [r0, c0] = self.optics.centre();
        let joint = Joint::new(work, exposure.seed);
        let mut random = SmallRng::seed_from_u64(exposure.seed ^ 0x5eed);
        let full_well = exposure.noise.full_well;
        let mut pixels = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            for column in 0..columns {
                let at = [row as f64 - r0, column as f64 - c0];
                let (x, y) = (at[1] / c0, at[0] / r0);
                let light = work.level * (1.0 + work.shading[0] * x + work.shading[1] * y);
                let glare = work.glare.map_or(0.0, |glare| {
                    let (dx, dy) = (x - glare.middle[0], y - glare.middle[1]);
                    glare.level * (-(dx * dx + dy * dy) / (2.0 * glare.radius * glare.radius)).exp()
                });
                let seen = self.seen(&joint, at, exposure.smear_mm, &mut random);
                let share = (light * seen + work.veil + glare).clamp(0.0, 4.0);
                let electrons = share * full_well;
                let noise = (electrons + exposure.noise.read_noise.powi(2)).sqrt() * gauss(&mut random);
                let level = ((electrons + noise) * 255.0 / full_well).round();
                pixels.push(level.clamp(0.0, 255.0) as u8);
            }
        }
        pixels
    }

    /// Mean brightness of what the rays of a pixel meet, `at` rows and columns from the middle.
    fn seen(&self, joint: &Joint, at: [f64; 2], smear_mm: f64, random: &mut SmallRng) -> f64 {
        let g = self.optics.object_pixel_mm();
        let (sin, cos) = self.optics.tilt_rad.sin_cos();
        let down = Vector3::new(cos, 0.0, sin);
        let right = Vector3::new(0.0, 1.0, 0.0);
        let sight = Vector3::new(sin, 0.0, -cos);
        let lens = self.optics.aperture.asin().tan();
        let blur = DIFFRACTION * self.optics.wavelength_mm / self.optics.aperture;
        let mut numbers: [f64; NUMBERS] = std::array::from_fn(|_| random.random());
        let mut sum = 0.0;
        for _ in 0..self.rays {
            for (number, step) in numbers.iter_mut().zip(&self.steps) {
                *number = (*number + step).fract();
            }
            let [radius, turn, y, x, blur_radius, blur_turn, travel] = numbers;
            let spread = blur * (-2.0 * (1.0 - blur_radius).ln()).sqrt();
            let (blur_sin, blur_cos) = (std::f64::consts::TAU * blur_turn).sin_cos();
            let r = (at[0] + y - 0.5) * g + spread * blur_sin;
            let u = (at[1] + x - 0.5) * g + spread * blur_cos;
            let (lens_sin, lens_cos) = (std::f64::consts::TAU * turn).sin_cos();
            let tilt = lens * radius.sqrt();
            let from = r * down + u * right - Vector3::new((travel - 0.5) * smear_mm, 0.0, 0.0);
            let direction = sight + tilt * (lens_sin * down + lens_cos * right);
            sum += joint.brightness(&from, &direction);
        }
        sum / self.rays as f64
    }
}

impl<'a> Joint<'a> {
    fn new(work: &'a Work, seed: u64) -> Self {
        let slope = work.yaw_rad.tan();
        let along = Vector3::new(1.0, slope, work.roll * slope).normalize();
        let out = Vector3::new(0.0, -work.roll, 1.0).normalize();
        let half = work.width_mm / 2.0;
        let side = |k: usize| {
            let level = if k == 0 { -0.5 } else { 0.5 } * work.step_mm;
            Section::new(&work.sides[k], half, level)
        };
        let mut random = SmallRng::seed_from_u64(seed ^ 0xed6e);
        let mut wander = || (0..512).map(|_| work.roughness_mm * gauss(&mut random)).collect();
        Self {
            work,
            origin: Vector3::new(0.0, work.lateral_mm, work.height_mm + work.roll * work.lateral_mm),
            along,
            across: out.cross(&along),
            out,
            sides: [side(0), side(1)],
            wander: [wander(), wander()],
        }
    }

    /// How far the edge of a side is off its straight line, towards the outside.
    fn wander(&self, side: usize, along: f64) -> f64 {
        let x = along / WANDER_MM;
        let floor = x.floor();
        let at = |k: f64| self.wander[side][(k as i64).rem_euclid(512) as usize];
        at(floor) + (at(floor + 1.0) - at(floor)) * (x - floor)
    }

    /// Brightness of what a ray first meets.
    fn brightness(&self, from: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
        let from = from - self.origin;
        let ray = |axis: &Vector3<f64>| [from.dot(axis), direction.dot(axis)];
        let (s, x, y) = (ray(&self.along), ray(&self.across), ray(&self.out));
        let along = |t: f64| s[0] + s[1] * t;
        let near = along(-y[0] / y[1]) + self.work.along_mm;
        let blob = self.blob(&s, &x, &y);
        let mut first: Option<(f64, f64)> = None;
        for (k, section) in self.sides.iter().enumerate() {
            let mirror = if k == 0 { -1.0 } else { 1.0 };
            let shifted = [mirror * x[0] - self.wander(k, near), mirror * x[1]];
            let Some(hit) = section.meet(shifted, y) else {
                continue;
            };
            let side = &self.work.sides[k];
            let place = along(hit.t) + self.work.along_mm;
            if place > side.ends_mm || first.is_some_and(|(t, _)| t <= hit.t) {
                continue;
            }
            let brightness = match hit.piece {
                Piece::Wall => {
                    let depth = -(y[0] + y[1] * hit.t);
                    side.wall_brightness * (-depth.max(0.0) / FADING_MM).exp()
                }
                Piece::Face => self.face(k, place, hit.arc, x[0] + x[1] * hit.t),
            };
            first = Some((hit.t, brightness));
        }
        match (first, blob) {
            (Some((t, _)), Some((t_blob, brightness))) if t_blob <= t => brightness,
            (None, Some((_, brightness))) => brightness,
            (Some((_, brightness)), _) => brightness,
            (None, None) => 0.01,
        }
    }

    /// Brightness of the face of a side, at a length `arc` from its edge and `x` across the seam.
    fn face(&self, k: usize, place: f64, arc: f64, x: f64) -> f64 {
        let (work, side) = (self.work, &self.work.sides[k]);
        let mut brightness = side.brightness * work.textures[k].at(place, x);
        if arc < side.chamfer_mm * std::f64::consts::SQRT_2 {
            brightness *= side.chamfer_brightness;
        }
        if arc < side.rim[0] {
            brightness *= side.rim[1];
        }
        for mark in &work.marks {
            let off = x - mark.offset_mm - mark.slope * (place - work.along_mm);
            if off.abs() < mark.width_mm / 2.0 {
                brightness *= mark.factor;
            }
        }
        for shadow in work.shadows.iter().filter(|shadow| shadow.side == k) {
            if arc < shadow.width_mm {
                brightness *= shadow.factor;
            }
        }
        brightness
    }

    /// Where a ray meets spatter, and how bright that is.
    fn blob(&self, s: &[f64; 2], x: &[f64; 2], y: &[f64; 2]) -> Option<(f64, f64)> {
        let t = (SPATTER_MM - y[0]) / y[1];
        let (along, across) = (s[0] + s[1] * t, x[0] + x[1] * t);
        let met = self.work.blobs.iter().find(|blob| {
            let [a, u] = blob.middle_mm;
            (along - a).hypot(across - u) < blob.radius_mm
        });
        met.map(|blob| (t, blob.brightness))
    }
}

/// A normal random number.
fn gauss(random: &mut SmallRng) -> f64 {
    let (a, b): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}
