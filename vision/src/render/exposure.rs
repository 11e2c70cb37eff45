//! From the brightness of a row to what its pixels count.

use super::film::{Film, fading};
use super::row::Row;
use super::scene::Light;
use super::sketch::Sketch;

impl Row {
    /// Light and haze at `y` (−1…1), so that brightness is in steps of 8 bits.
    pub fn light(&mut self, sketch: &Sketch, light: &Light, y: f64) {
        let [s0, s1, s2] = light.shading;
        let level = 255.0 * light.level;
        let (base, slope) = ((level * (1.0 + s1 * y)) as f32, (level * s0) as f32);
        let (middle, fall) = ((1.0 - s2 * y * y / 2.0) as f32, (s2 / 2.0) as f32);
        let haze = light.haze as f32;
        let [x, squares] = &sketch.shading;
        for ((brightness, x), square) in self.brightness.iter_mut().zip(x).zip(squares) {
            let light = (base + slope * x) * (middle - fall * square);
            *brightness = light * ((1.0 - haze) * *brightness + haze);
        }
    }

    /// Lays veil, glare and dirt over the row at `y` (−1…1), which is lit.
    pub fn cover(&mut self, sketch: &Sketch, film: &Film, y: f64) {
        let (glares, dirt) = sketch.bells.split_at(film.glares.len() * sketch.columns);
        for (spot, bell) in film.dirt.iter().zip(dirt.chunks_exact(sketch.columns)) {
            let gain = ((spot.factor - 1.0) * fading(y, spot.middle[1], spot.radius)) as f32;
            let row = self.brightness.iter_mut().zip(bell);
            row.for_each(|(brightness, bell)| *brightness *= 1.0 + gain * bell);
        }
        let veil = (255.0 * film.veil) as f32;
        self.brightness
            .iter_mut()
            .for_each(|brightness| *brightness += veil);
        for (glare, bell) in film.glares.iter().zip(glares.chunks_exact(sketch.columns)) {
            let level = (255.0 * glare.level * fading(y, glare.middle[1], glare.radius)) as f32;
            let row = self.brightness.iter_mut().zip(bell);
            row.for_each(|(brightness, bell)| *brightness += level * bell);
        }
    }

    /// Multiplies each pixel by its own gain: normally distributed numbers with this standard deviation.
    pub fn pattern(&mut self, gauss: &[f32], deviation: f32) {
        let row = self.brightness.iter_mut().zip(gauss);
        row.for_each(|(brightness, gauss)| *brightness *= 1.0 + deviation * gauss);
    }

    /// Counts and reads electrons: `step` is what one of them is in 8 bits, `read` the variance of reading.
    pub fn count(&self, gauss: &[f32], step: f32, read: f32, pixels: &mut [u8]) {
        /// Adding it leaves a whole number in the last bits of a float.
        const WHOLE: f32 = 8_388_608.0;
        for ((pixel, &mean), gauss) in pixels.iter_mut().zip(&self.brightness).zip(gauss) {
            let mean = mean.max(0.0);
            let value = mean + gauss * (mean * step + read).sqrt();
            *pixel = (value.clamp(0.0, 255.0) + WHOLE).to_bits() as u8;
        }
    }
}
