//! One row of a picture in the making.

use super::line::Line;
use super::row_effects::RowEffects;
use super::scene::{Blob, Gap, Scene, Stripe};
use super::sketch::Sketch;
use super::source::Source;
use super::texture::roughness;
use super::tile::Tile;
use std::ops::Range;
use std::sync::Arc;

/// Where the roughness of an edge is looked up, in radii of the blur: places that spread as far as a disc does.
const ROUGHNESS_AT: [f64; 5] = [-0.7, -0.35, 0.0, 0.35, 0.7];

/// Brightness of a row, and how blurred it is.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub brightness: Vec<f32>,
    /// Squares of the blurs' radii \[pixels\].
    radii_squared: Vec<f32>,
    /// The other wall's texture, where it is blurred into a wall's.
    other: Vec<f32>,
    /// The surface as it is without stripes.
    plain: Vec<f32>,
    effects: RowEffects,
}

/// Share of a blurred edge at `t` of its half width.
pub(super) fn smooth(t: f32) -> f32 {
    let t = t.clamp(-1.0, 1.0);
    0.5 + t * (0.75 - 0.25 * t * t)
}

/// How many columns a blurred edge at a column reaches to each side: a cubic step of the same variance as disc,
/// diffraction and pixel.
pub(super) fn softness(sketch: &Sketch, radii_squared: &[f32], column: f64) -> f64 {
    let column = (column.max(0.0) as usize).min(sketch.columns - 1);
    let diffraction = sketch.lens.diffraction_mm / sketch.lens.pixel_mm;
    let variance = f64::from(radii_squared[column]) / 4.0 + diffraction.powi(2) + 1.0 / 12.0;
    (5.0 * variance).sqrt()
}

/// Height of a disc of so many half widths of its blur, such that it keeps its light: blurred with the profile
/// [`smooth`] it covers π(radius² + 0.2) if the radius is above 1, and this polynomial below.
fn flattened(radius: f64) -> f64 {
    let square = radius * radius;
    let covered = if radius < 1.0 {
        0.1 + 0.375 * radius + 0.5 * square + 0.25 * square * radius - 0.025 * square * square * radius
    } else {
        square + 0.2
    };
    square / covered
}

/// A blurred strip across a row: its edges \[columns\], and how far to each side they are soft.
pub(super) struct Strip {
    pub edges: [f64; 2],
    pub softness: [f64; 2],
}

impl Strip {
    /// The columns it touches.
    pub fn columns(&self, count: usize) -> Range<usize> {
        let bound = |x: f64| (x.ceil().max(0.0) as usize).min(count);
        bound(self.edges[0] - self.softness[0])..bound(self.edges[1] + self.softness[1])
    }

    /// Share of each of these columns that lies in it.
    pub fn shares(&self, columns: Range<usize>) -> impl Iterator<Item = f32> {
        let start = columns.start as f64;
        let [left, right] = [0, 1].map(|k| {
            let (at, gain) = ((start - self.edges[k]) / self.softness[k], 1.0 / self.softness[k]);
            (at as f32, gain as f32)
        });
        (0..columns.len()).map(move |k| {
            let k = k as f32;
            smooth(left.0 + k * left.1) - smooth(right.0 + k * right.1)
        })
    }
}

impl Row {
    pub fn new(columns: usize) -> Self {
        Self {
            brightness: vec![0.0; columns],
            radii_squared: vec![0.0; columns],
            other: vec![0.0; columns],
            plain: vec![0.0; columns],
            effects: RowEffects::new(columns),
        }
    }

    /// The textured surface in the row that lies at `r`.
    pub fn see(&mut self, tiles: &[Arc<Tile>; 2], sketch: &Sketch, row: usize, r: f64) {
        let seam = sketch.seam_column(r);
        let split = (seam.ceil().max(0.0) as usize).min(sketch.columns);
        let radius = sketch.lens.spread / sketch.lens.pixel_mm;
        let (depth, radius) = ((sketch.depth(r) * radius) as f32, radius as f32);
        let rows = sketch.tile_rows(row);
        for (side, columns) in [0..split, split..sketch.columns].into_iter().enumerate() {
            let falls = &sketch.focus[side][columns.clone()];
            for (squared, fall) in self.radii_squared[columns.clone()].iter_mut().zip(falls) {
                let defocus = depth - fall * radius;
                *squared = defocus * defocus;
            }
            let source = Source::new(&tiles[side], rows[side], sketch.begin[side][1]);
            source.blend(
                &self.radii_squared,
                columns.clone(),
                &mut self.brightness[columns],
            );
        }
        if sketch.corner {
            self.join_walls(tiles, sketch, rows, split, seam);
        }
        self.plain.copy_from_slice(&self.brightness);
    }

    /// Blurs the textures and the brightness of two walls into each other.
    fn join_walls(
        &mut self,
        tiles: &[Arc<Tile>; 2],
        sketch: &Sketch,
        rows: [usize; 2],
        split: usize,
        seam: f64,
    ) {
        let softness = self.softness(sketch, seam);
        let touched = Strip {
            edges: [seam; 2],
            softness: [softness; 2],
        };
        let touched = touched.columns(sketch.columns);
        let split = split.clamp(touched.start, touched.end);
        let sides = [touched.start..split, split..touched.end];
        for (side, columns) in sides.into_iter().enumerate() {
            let other = Source::new(&tiles[1 - side], rows[1 - side], sketch.begin[1 - side][1]);
            let out = &mut self.other[columns.clone()];
            other.blend(&self.radii_squared, columns.clone(), out);
            for (column, (own, other)) in columns.clone().zip(self.brightness[columns].iter_mut().zip(out)) {
                let share = smooth(((column as f64 - seam).abs() / softness) as f32);
                *own = *other + (*own - *other) * share;
            }
        }
        let ([left, right], at) = (sketch.walls, (-seam / softness) as f32);
        let per_column = (1.0 / softness) as f32;
        for (column, (brightness, lit)) in self.brightness.iter_mut().zip(&sketch.lit).enumerate() {
            *brightness *= lit * (left + (right - left) * smooth(at + column as f32 * per_column));
        }
    }

    /// How many columns a blurred edge at a column reaches to each side.
    fn softness(&self, sketch: &Sketch, column: f64) -> f64 {
        softness(sketch, &self.radii_squared, column)
    }

    /// A strip between two ways from the seam, square to it \[mm\].
    fn strip(&self, sketch: &Sketch, r: f64, edges_mm: [f64; 2]) -> Strip {
        let edges = edges_mm.map(|lateral| sketch.line_column(r, lateral));
        let softness = [edges[0], edges[1].ceil()].map(|column| self.softness(sketch, column));
        Strip { edges, softness }
    }

    /// Lays a stripe over the surface.
    pub fn lay_stripe(&mut self, sketch: &Sketch, r: f64, stripe: &Stripe) {
        let half = stripe.width_mm / 2.0;
        let strip = self.strip(sketch, r, [stripe.offset_mm - half, stripe.offset_mm + half]);
        let columns = strip.columns(sketch.columns);
        let gain = stripe.factor as f32 - 1.0;
        let row = self.brightness[columns.clone()].iter_mut();
        row.zip(strip.shares(columns))
            .for_each(|(brightness, share)| *brightness *= 1.0 + gain * share);
    }

    /// How far its edges are off straight lines in this row, outwards \[mm\]; `along` is where on the work it shows them.
    fn roughness(&self, sketch: &Sketch, scene: &Scene, gap: &Gap, along: [f64; 2], r: f64) -> [f64; 2] {
        if gap.roughness_mm <= 0.0 {
            return [0.0; 2];
        }
        let column = (sketch.seam_column(r).max(0.0) as usize).min(sketch.columns - 1);
        let blur = f64::from(self.radii_squared[column].sqrt()) * sketch.lens.pixel_mm;
        [0, 1].map(|edge| {
            let at = |k: f64| roughness(scene.texture.seed, edge, along[edge] + sketch.travel(k * blur));
            let rough = ROUGHNESS_AT.iter().map(|&k| at(k)).sum::<f64>() / ROUGHNESS_AT.len() as f64;
            gap.roughness_mm * rough
        })
    }

    /// Lays marks on the surface, gives both sides of a gap what they have, and closes it where there are tacks.
    pub fn fill_with_effects(&mut self, sketch: &Sketch, scene: &Scene, gap: Option<&Gap>, r: f64) {
        let rough = match gap {
            Some(gap) if gap.plate.width_mm > 0.0 => {
                let seam = (sketch.seam_column(r).max(0.0) as usize).min(sketch.columns - 1);
                let along = [0, 1].map(|side| scene.position_mm[0] + sketch.along(r, seam, side));
                self.roughness(sketch, scene, gap, along, r)
            }
            _ => [0.0; 2],
        };
        let line = Line {
            sketch,
            scene,
            r,
            radii_squared: &self.radii_squared,
        };
        self.effects.prepare(&line, gap, rough);
        let floor = gap.map(|gap| gap.brightness as f32);
        self.effects.lay(&mut self.brightness, &self.plain, floor);
        for tack in &scene.tacks {
            line.close(tack, &self.plain, &mut self.brightness);
        }
    }

    /// Opens the gap beside the stripes.
    pub fn open_gap(&mut self, sketch: &Sketch, scene: &Scene, gap: &Gap, r: f64) {
        if gap.plate.width_mm <= 0.0 {
            return;
        }
        let along = scene.position_mm[0] + sketch.seam_along(r);
        let rough = self.roughness(sketch, scene, gap, [along; 2], r);
        let out = |edge: usize| gap.plate.width_mm / 2.0 + rough[edge];
        let strip = self.strip(sketch, r, [-out(0), out(1)]);
        let columns = strip.columns(sketch.columns);
        let row = self.brightness[columns.clone()]
            .iter_mut()
            .zip(&self.plain[columns.clone()]);
        // A gap takes away plain surface, for stripes do not reach into it, however blurred both are.
        for ((brightness, plain), share) in row.zip(strip.shares(columns)) {
            *brightness = (*brightness - share * (plain - gap.brightness as f32)).max(0.0);
        }
    }

    /// Lays a blob over everything.
    pub fn lay_blob(&mut self, sketch: &Sketch, scene: &Scene, r: f64, blob: &Blob) {
        let [a, u] = [0, 1].map(|k| blob.middle_mm[k] - scene.position_mm[k]);
        let middle = sketch
            .across
            .partition_point(|&across| f64::from(across) < u)
            .min(sketch.columns - 1);
        let softness = self.softness(sketch, middle as f64) * sketch.lens.pixel_mm;
        let reach = blob.radius_mm + softness;
        let height = flattened(blob.radius_mm / softness) as f32;
        let split = sketch.seam_column(r).ceil();
        let side = |column: usize| usize::from(column as f64 >= split);
        // A surface gains no more along travel than it is wide, up to walls of 45°.
        if (sketch.along(r, middle, side(middle)) - a).abs() > 2.0 * reach {
            return;
        }
        let bound = |u: f64| sketch.across.partition_point(|&across| f64::from(across) < u);
        for column in bound(u - reach)..bound(u + reach) {
            let along = sketch.along(r, column, side(column)) - a;
            let far = along.hypot(f64::from(sketch.across[column]) - u);
            let share = height * smooth(((blob.radius_mm - far) / softness) as f32);
            let brightness = &mut self.brightness[column];
            *brightness += (blob.brightness as f32 - *brightness) * share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{flattened, smooth};

    #[test]
    fn a_blurred_disc_keeps_its_light() {
        for radius in [0.05, 0.3, 0.99, 1.01, 2.5] {
            let step = 1e-3;
            let rings = (0..4000).map(|k| (f64::from(k) + 0.5) * step);
            let light: f64 = rings
                .map(|far| 2.0 * far * step * f64::from(smooth((radius - far) as f32)))
                .sum();
            let kept = flattened(radius) * light / (radius * radius);
            assert!((kept - 1.0).abs() < 1e-3, "{radius}: {kept}");
        }
    }
}
