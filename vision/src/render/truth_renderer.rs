//! The renderer whose pictures tests believe.

use super::blur::{Discs, Kernel, Lens, Part};
use super::random::SplitMix64;
use super::scene::Scene;
use super::sharp::Sharp;
use super::sight_line::WorkSurface;
use crate::noise::PhotonTransfer;
use crate::optics::{Optics, OpticsError};

/// Renders by the physics, slowly: the sharp work is sampled finer than pixels, smeared by travel, diffraction and the
/// pixels' area, and each pixel gathers it over the disc that its own depth makes of a point. Then the light, the
/// electrons that are counted and read, and 8 bits.
///
/// Not in the model: rays that the other side of a step or wall cuts off, an entocentric lens, aberrations but
/// a curved field, true glints.
#[derive(Debug)]
pub struct TruthRenderer {
    optics: Optics,
    noise: PhotonTransfer,
    samples: usize,
    sharp: Sharp,
    discs: Discs,
    /// Samples of the sharp work, rows of a stretch that is wider than the picture by the largest disc.
    samples_of_work: Vec<f32>,
    smeared: Vec<f32>,
    /// Sums along each row up to a sample.
    sums: Vec<f64>,
    depths: Vec<f32>,
}

/// The stretch of the focal plane that is sampled.
#[derive(Clone, Copy)]
struct Stretch {
    rows: usize,
    columns: usize,
    /// Samples added on each side of the picture.
    margin: usize,
}

impl TruthRenderer {
    /// A renderer for a camera. `samples` a pixel in each direction, one of them in its middle: 1 is quick, 3 is good.
    pub fn new(optics: Optics, noise: PhotonTransfer, samples: usize) -> Result<Self, OpticsError> {
        optics.check()?;
        Ok(Self {
            optics,
            noise,
            samples: samples.max(1),
            sharp: Sharp::default(),
            discs: Discs::default(),
            samples_of_work: Vec::new(),
            smeared: Vec::new(),
            sums: Vec::new(),
            depths: Vec::new(),
        })
    }

    /// The camera.
    pub fn optics(&self) -> &Optics {
        &self.optics
    }

    /// The picture of `scene`, rows from the top; the same seed gives the same noise.
    pub fn render(&mut self, scene: &Scene, seed: u64) -> Vec<u8> {
        let mut noise = SplitMix64::new(seed);
        let sensor = scene.sensor.noise.unwrap_or(self.noise);
        let step = 255.0 / sensor.full_well;
        self.light(scene)
            .iter()
            .enumerate()
            .map(|(pixel, &share)| {
                let share = if scene.sensor.pattern > 0.0 {
                    f64::from(share.max(0.0)) * scene.sensor.gain(pixel)
                } else {
                    f64::from(share.max(0.0))
                };
                let electrons = noise.count(share * sensor.full_well);
                let read = electrons + sensor.read_noise * noise.gauss()[0];
                (read * step).round().clamp(0.0, 255.0) as u8
            })
            .collect()
    }

    /// What reaches the pixels before noise, as shares of full scale.
    pub fn light(&mut self, scene: &Scene) -> Vec<f32> {
        let Optics { rows, columns, .. } = self.optics;
        let lens = Lens::new(&self.optics);
        let sample = lens.pixel_mm / self.samples as f64;
        let surface = WorkSurface::new(&scene.joint, &self.optics);
        let [r0, c0] = self.optics.centre();
        self.depths.clear();
        for row in 0..rows {
            let r = (row as f64 - r0) * lens.pixel_mm;
            let depth = |column: usize| {
                let x = (column as f64 - c0) * lens.pixel_mm;
                (surface.at(r, x).depth + scene.curved(r, x, &self.optics)) as f32
            };
            self.depths.extend((0..columns).map(depth));
        }
        let deepest = self.depths.iter().fold(0.0f32, |d, z| d.max(z.abs()));
        let largest = f64::from(deepest) * lens.spread / sample;
        self.discs.provide(largest);

        let pixel = self.samples as f64;
        let diffraction = lens.diffraction_mm / sample;
        let smear = scene.smear_mm * self.optics.tilt_rad.cos() / sample;
        let across = Kernel::new(diffraction, &[pixel]);
        let along = Kernel::new(diffraction, &[pixel, smear]);
        let margin = largest.ceil() as usize + 2 + across.reach().max(along.reach());
        let stretch = Stretch {
            rows: (rows - 1) * self.samples + 1 + 2 * margin,
            columns: (columns - 1) * self.samples + 1 + 2 * margin,
            margin,
        };
        self.sample(scene, &surface, stretch, sample);
        self.smear(stretch, &across, &along);
        self.gather(scene, stretch, lens.spread / sample)
    }

    fn sample(&mut self, scene: &Scene, surface: &WorkSurface, stretch: Stretch, sample: f64) {
        self.sharp.prepare(scene, &self.optics);
        self.samples_of_work.clear();
        let middle = |count: usize| (count as f64 - 1.0) / 2.0;
        for row in 0..stretch.rows {
            let r = (row as f64 - middle(stretch.rows)) * sample;
            let brightness = |column: usize| {
                let u = (column as f64 - middle(stretch.columns)) * sample;
                self.sharp.brightness(scene, &surface.at(r, u), sample)
            };
            self.samples_of_work.extend((0..stretch.columns).map(brightness));
        }
    }

    /// Diffraction, pixel and travel; the sums along rows are of the result.
    fn smear(&mut self, stretch: Stretch, across: &Kernel, along: &Kernel) {
        let Stretch { rows, columns, .. } = stretch;
        let clamped =
            |at: usize, k: usize, reach: usize, count: usize| (at + k).saturating_sub(reach).min(count - 1);
        self.smeared.clear();
        self.smeared.resize(rows * columns, 0.0);
        for row in 0..rows {
            let out = &mut self.smeared[row * columns..][..columns];
            for (k, &weight) in along.0.iter().enumerate() {
                let from = clamped(row, k, along.reach(), rows);
                let line = &self.samples_of_work[from * columns..][..columns];
                out.iter_mut().zip(line).for_each(|(o, x)| *o += weight * x);
            }
        }
        self.sums.clear();
        let (mut wide, mut blurred) = (Vec::new(), vec![0.0; columns]);
        for line in self.smeared.chunks_exact(columns) {
            wide.clear();
            wide.extend(
                (0..columns + 2 * across.reach()).map(|k| line[clamped(0, k, across.reach(), columns)]),
            );
            blurred.fill(0.0);
            for (k, &weight) in across.0.iter().enumerate() {
                blurred
                    .iter_mut()
                    .zip(&wide[k..])
                    .for_each(|(o, x)| *o += weight * x);
            }
            let mut sum = 0.0;
            self.sums.push(sum);
            self.sums.extend(blurred.iter().map(|&x| {
                sum += f64::from(x);
                sum
            }));
        }
    }

    /// The mean over each pixel's disc, in its light.
    fn gather(&self, scene: &Scene, stretch: Stretch, spread: f64) -> Vec<f32> {
        let Optics { rows, columns, .. } = self.optics;
        let [r0, c0] = self.optics.centre();
        let line = stretch.columns + 1;
        let (haze, clear) = (scene.light.haze, scene.film.is_clear());
        let mut picture = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            for column in 0..columns {
                let radius = f64::from(self.depths[row * columns + column].abs()) * spread;
                let [i, j] = [row, column].map(|at| stretch.margin + at * self.samples);
                let within = |i: usize, part: &Part| {
                    let sums = &self.sums[i * line..][..line];
                    let right = [sums[j + part.whole], sums[j + part.whole + 1]];
                    let left = [sums[j + 1 - part.whole], sums[j - part.whole]];
                    right[0] - left[0] + (right[1] - right[0] - (left[1] - left[0])) * part.fraction
                };
                let disc = self.discs.of(radius);
                let mut sum = within(i, &disc.parts[0]);
                for (k, part) in disc.parts.iter().enumerate().skip(1) {
                    sum += within(i - k, part) + within(i + k, part);
                }
                let x = (column as f64 - c0) / c0.max(1.0);
                let y = (row as f64 - r0) / r0.max(1.0);
                let light = scene.light.at(x, y) * ((1.0 - haze) * sum / disc.area + haze);
                let light = if clear {
                    light
                } else {
                    scene.film.through(light, x, y)
                };
                picture.push(light as f32);
            }
        }
        picture
    }
}
