//! Where the columns of a row are on the work, and how soft edges are there.

use super::marks::Tack;
use super::row::{Strip, smooth, softness};
use super::scene::Scene;
use super::sketch::Sketch;

/// The row at `r` and what it is of.
pub(super) struct Line<'a> {
    pub sketch: &'a Sketch,
    pub scene: &'a Scene,
    pub r: f64,
    /// Squares of the blurs' radii, column by column \[pixels\].
    pub radii_squared: &'a [f32],
}

impl Line<'_> {
    /// How far to each side an edge at a column is soft \[columns\].
    pub fn softness(&self, column: f64) -> f64 {
        softness(self.sketch, self.radii_squared, column)
    }

    /// How far an edge across the seam is soft to each side of a column, along travel \[mm\].
    fn soft_along(&self, column: usize) -> f64 {
        let soft = self.softness(column as f64);
        self.sketch.travel(soft * self.sketch.lens.pixel_mm)
    }

    /// The most of that over the row: the blur is largest at one of its ends, or at the seam beside a step.
    pub fn most_along(&self) -> f64 {
        let seam = self.sketch.seam_column(self.r).max(0.0) as usize;
        let last = self.sketch.columns - 1;
        [0, seam.saturating_sub(1), seam, last]
            .map(|column| self.soft_along(column.min(last)))
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// Column of a line on a side, so far outwards from the middle of the seam \[mm\].
    pub fn side_column(&self, outward: f64, side: usize) -> f64 {
        let lateral = if side == 0 { -outward } else { outward };
        self.sketch.side_column(self.r, lateral, side)
    }

    /// What it shows on a side of something between two places along travel on the work.
    pub fn reach(&self, side: usize, [from, to]: [f64; 2]) -> Reach {
        if from == f64::NEG_INFINITY && to == f64::INFINITY {
            return Reach::Everywhere;
        }
        let soft = self.most_along();
        let places = [0, self.sketch.columns - 1].map(|column| self.place(column, side));
        let (least, most) = (places[0].min(places[1]), places[0].max(places[1]));
        if from > to || most < from - soft || least > to + soft {
            Reach::Nowhere
        } else if least > from + soft && most < to - soft {
            Reach::Everywhere
        } else {
            Reach::Part(Ends { from, to })
        }
    }

    /// Place along travel on the work where the seam is beside what a column shows \[mm\].
    fn place(&self, column: usize, side: usize) -> f64 {
        let along = self.sketch.along(self.r, column, side);
        self.scene.position_mm[0] + along + self.sketch.lateral(self.r, column) * self.sketch.yaw_sin
    }

    /// Lays a tack over the row.
    pub fn close(&self, tack: &Tack, plain: &[f32], brightness: &mut [f32]) {
        let there = self.reach(0, tack.reaches_mm);
        if matches!(there, Reach::Nowhere) {
            return;
        }
        let half = tack.width_mm / 2.0;
        let edges = [-half, half].map(|lateral| self.sketch.line_column(self.r, lateral));
        let strip = Strip {
            edges,
            softness: edges.map(|column| self.softness(column)),
        };
        let columns = strip.columns(self.sketch.columns);
        let bright = tack.brightness as f32;
        for (column, share) in columns.clone().zip(strip.shares(columns)) {
            let share = match &there {
                Reach::Part(ends) => share * ends.share(self, 0, column),
                _ => share,
            };
            brightness[column] += (bright * plain[column] - brightness[column]) * share;
        }
    }
}

/// Column by column: place along travel from the scene's position and from the seam \[mm\], and one over the softness of
/// edges across the seam \[1/mm\].
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    pub along: Vec<f32>,
    pub lateral: Vec<f32>,
    pub sharpness: Vec<f32>,
}

impl Places {
    pub fn new(columns: usize) -> Self {
        let row = || vec![0.0; columns];
        Self {
            along: row(),
            lateral: row(),
            sharpness: row(),
        }
    }

    /// Takes up a row.
    pub fn take(&mut self, line: &Line) {
        let (sketch, r) = (line.sketch, line.r);
        let split = (sketch.seam_column(r).ceil().max(0.0) as usize).min(sketch.columns);
        let (first, per_column) = (sketch.lateral(r, 0) as f32, sketch.lateral_per_column() as f32);
        for (column, lateral) in self.lateral.iter_mut().enumerate() {
            *lateral = first + per_column * column as f32;
        }
        for (side, columns) in [0..split, split..sketch.columns].into_iter().enumerate() {
            sketch.places(r, side, columns.clone(), &mut self.along[columns]);
        }
        let slant = sketch.yaw_sin as f32;
        for (along, lateral) in self.along.iter_mut().zip(&self.lateral) {
            *along += slant * lateral;
        }
        let least = sketch.sharp_variance() as f32;
        let unit = sketch.travel(sketch.lens.pixel_mm) as f32;
        for (sharpness, radius_squared) in self.sharpness.iter_mut().zip(line.radii_squared) {
            *sharpness = 1.0 / (unit * (5.0 * (radius_squared / 4.0 + least)).sqrt());
        }
    }
}

/// What a row shows of something between two places along travel.
pub(super) enum Reach {
    Nowhere,
    Everywhere,
    Part(Ends),
}

/// Two ends along travel on the work \[mm\].
pub(super) struct Ends {
    from: f64,
    to: f64,
}

impl Ends {
    /// Share of a column that lies between them.
    pub fn share(&self, line: &Line, side: usize, column: usize) -> f32 {
        let place = line.place(column, side);
        let soft = line.soft_along(column);
        let after = smooth(((place - self.from) / soft) as f32);
        let before = smooth(((self.to - place) / soft) as f32);
        (after + before - 1.0).max(0.0)
    }
}
