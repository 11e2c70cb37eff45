//! What marks, the sides of a gap and tacks make of a row of a picture.

use super::line::{Line, Places, Reach};
use super::marks::{Mark, Run};
use super::row::{Strip, smooth};
use super::scene::Gap;
use super::side::Face;

/// The surface's share below which what marks it is no more looked up there: a gap.
const HARDLY: f32 = 0.05;

/// Where the light on a wall is divided into even strips, in lengths over which it fades by 1/e.
const WALL: [f64; 6] = [0.0, 0.25, 0.6, 1.1, 1.8, 3.0];

/// Column by column of one row.
#[derive(Clone, Debug, Default)]
pub(super) struct RowEffects {
    /// What marks along the seam add to the surface's factor, and those across it.
    marks: [Vec<f32>; 2],
    /// Factor of the surface, and the share that it takes.
    factor: Vec<f32>,
    cover: Vec<f32>,
    /// Light of the gap's walls.
    wall: Vec<f32>,
    /// The same three of one side.
    side: [Vec<f32>; 3],
    /// Where its columns are, if there are marks across.
    places: Places,
    /// Whether there are marks.
    marked: bool,
}

impl RowEffects {
    pub fn new(columns: usize) -> Self {
        let row = || vec![0.0; columns];
        Self {
            marks: [row(), row()],
            factor: row(),
            cover: row(),
            wall: row(),
            side: [row(), row(), row()],
            places: Places::new(columns),
            marked: false,
        }
    }

    /// Takes up the row at `r`. `rough` is how far the edges are off straight lines \[mm\].
    pub fn prepare(&mut self, line: &Line, gap: Option<&Gap>, rough: [f64; 2]) {
        self.factor.fill(0.0);
        self.cover.fill(0.0);
        self.wall.fill(0.0);
        let mut open = None;
        if let Some(gap) = gap {
            let half = gap.plate.width_mm / 2.0;
            let outward = [0, 1].map(|k| half + rough[k]);
            let edge = |k: usize| line.side_column(outward[k] + line.sketch.faces[k].begins, k);
            let edges = [edge(0), edge(1)];
            if gap.plate.width_mm > 0.0 {
                open = Some(edges);
            }
            for k in 0..2 {
                self.take_side(line, k, outward[k], open);
            }
        }
        self.marked = !line.scene.marks.is_empty();
        if self.marked {
            self.marks.iter_mut().for_each(|marks| marks.fill(0.0));
            if line.scene.marks.iter().any(|mark| mark.run == Run::Across) {
                self.places.take(line);
            }
            // Parallel marks lie side by side; others may cross them.
            let marks = line.scene.marks.iter();
            let parallel = marks.clone().filter(|mark| mark.slope == 0.0);
            for mark in parallel.chain(marks.filter(|mark| mark.slope != 0.0)) {
                match mark.run {
                    Run::Along => self.mark_along(line, mark, open),
                    Run::Across => self.mark_across(line, mark),
                }
            }
        }
    }

    /// Adds a side whose root edge is `outward` mm from the middle of the seam.
    fn take_side(&mut self, line: &Line, k: usize, outward: f64, open: Option<[f64; 2]>) {
        let (face, side) = (&line.sketch.faces[k], &line.scene.sides[k]);
        let there = line.reach(k, side.reaches_mm);
        if matches!(there, Reach::Nowhere) {
            return;
        }
        self.side.iter_mut().for_each(|row| row.fill(0.0));
        let [factor, cover, wall] = &mut self.side;
        let at = |x: f64| {
            let column = line.side_column(outward + x, k);
            (column, line.softness(column))
        };
        let outwards = k == 1;
        let begins = at(face.begins);
        add_step(cover, begins, outwards, 1.0);
        let mut before = 0.0;
        let mut from = begins;
        for &(ends, here) in face.strips() {
            add_step(factor, from, outwards, (here - before) as f32);
            (before, from) = (here, at(ends));
        }
        add_step(factor, from, outwards, (face.beyond - before) as f32);
        if let Some(edges) = open {
            light_wall(
                wall,
                face,
                begins,
                edges[1 - k],
                line.sketch.lens.pixel_mm,
                outwards,
            );
        }
        if let Reach::Part(ends) = &there {
            for column in 0..line.sketch.columns {
                let share = ends.share(line, k, column);
                self.side.iter_mut().for_each(|row| row[column] *= share);
            }
        }
        let rows = [&mut self.factor, &mut self.cover, &mut self.wall];
        for (sum, side) in rows.into_iter().zip(&self.side) {
            sum.iter_mut().zip(side).for_each(|(sum, side)| *sum += side);
        }
    }

    fn mark_along(&mut self, line: &Line, mark: &Mark, open: Option<[f64; 2]>) {
        let (sketch, r) = (line.sketch, line.r);
        let middle = mark.middle(line.scene.position_mm[0] + sketch.seam_along(r));
        let half = mark.width_mm / 2.0;
        let [from, to] = [middle - half, middle + half].map(|lateral| sketch.line_column(r, lateral));
        if to < -50.0 || from > sketch.columns as f64 + 50.0 {
            return;
        }
        let k = usize::from(middle >= 0.0);
        let there = line.reach(k, mark.reaches_mm);
        let column = ((from + to).max(0.0) / 2.0) as usize;
        let share = match &there {
            Reach::Nowhere => return,
            Reach::Everywhere => 1.0,
            Reach::Part(ends) => ends.share(line, k, column.min(sketch.columns - 1)),
        };
        let gain = (mark.factor - 1.0) as f32 * share;
        let crossed = if mark.slope == 0.0 { 0.0 } else { gain };
        // It does not reach into the gap.
        let pieces = match open {
            Some([left, right]) => [[from, to.min(left)], [from.max(right), to]],
            None => [[from, to], [0.0; 2]],
        };
        for edges in pieces.into_iter().filter(|[from, to]| from < to) {
            let strip = Strip {
                edges,
                softness: edges.map(|column| line.softness(column)),
            };
            let columns = strip.columns(sketch.columns);
            if columns.is_empty() {
                continue;
            }
            let row = self.marks[0][columns.clone()].iter_mut();
            row.zip(strip.shares(columns))
                .for_each(|(sum, share)| *sum += share * (gain + crossed * *sum));
        }
    }

    fn mark_across(&mut self, line: &Line, mark: &Mark) {
        let Places {
            along,
            lateral,
            sharpness,
        } = &self.places;
        let middle = (mark.offset_mm - line.scene.position_mm[0]) as f32;
        let (half, slope) = ((mark.width_mm / 2.0) as f32, mark.slope as f32);
        let far = |column: usize| along[column] - middle - slope * lateral[column];
        let ends = [far(0), far(along.len() - 1)];
        // A step between the sides shifts one of them against the other.
        let step = (line.sketch.along(line.r, 0, 0) - line.sketch.along(line.r, 0, 1)).abs() as f32;
        let reach = half + line.most_along() as f32 + step;
        if ends.iter().all(|&far| far > reach) || ends.iter().all(|&far| far < -reach) {
            return;
        }
        let there = line.reach(0, mark.reaches_mm);
        if matches!(there, Reach::Nowhere) {
            return;
        }
        let gain = (mark.factor - 1.0) as f32;
        // What it adds, and multiplies what others have made of the surface by.
        let crossed = if mark.slope == 0.0 { 0.0 } else { gain };
        let row = self.marks[1].iter_mut().zip(along).zip(lateral).zip(sharpness);
        for (column, (((sum, along), lateral), one)) in row.enumerate() {
            let far = along - middle - slope * lateral;
            let mut share = smooth((half + far) * one) - smooth((far - half) * one);
            if let Reach::Part(ends) = &there {
                share *= ends.share(line, 0, column);
            }
            *sum += share * (gain + crossed * *sum);
        }
    }

    /// Lays it over a row; `floor` is how bright the gap is.
    pub fn lay(&self, brightness: &mut [f32], plain: &[f32], floor: Option<f32>) {
        let marks = self.marks[0].iter().zip(&self.marks[1]);
        let Some(floor) = floor else {
            for (brightness, (along, across)) in brightness.iter_mut().zip(marks) {
                *brightness = (*brightness * (1.0 + along) * (1.0 + across)).max(0.0);
            }
            return;
        };
        let row = brightness.iter_mut().zip(plain);
        let sides = self.factor.iter().zip(&self.cover).zip(&self.wall);
        if self.marked {
            for (((brightness, plain), ((factor, cover), wall)), (along, across)) in row.zip(sides).zip(marks)
            {
                // Stripes and marks along the seam take away surface, however blurred the gap beside them is.
                let beside = (plain * along + *brightness - plain) * factor / cover.max(HARDLY);
                let surface = ((plain * factor + beside) * (1.0 + across)).max(0.0);
                *brightness = surface + floor * (1.0 - cover).max(0.0) + wall;
            }
        } else {
            for ((brightness, plain), ((factor, cover), wall)) in row.zip(sides) {
                let beside = (*brightness - plain) * factor / cover.max(HARDLY);
                *brightness = (plain * factor + beside).max(0.0) + floor * (1.0 - cover).max(0.0) + wall;
            }
        }
    }
}

/// Adds `delta` beyond a column, with an edge as soft as it is: rightwards or leftwards.
fn add_step(row: &mut [f32], (column, soft): (f64, f64), rightwards: bool, delta: f32) {
    if delta == 0.0 {
        return;
    }
    let bound = |x: f64| (x.ceil().max(0.0) as usize).min(row.len());
    let (from, to) = (bound(column - soft), bound(column + soft));
    let beyond = if rightwards { to..row.len() } else { 0..from };
    row[beyond].iter_mut().for_each(|value| *value += delta);
    let sign = if rightwards { 1.0 } else { -1.0 };
    let (at, gain) = (
        (sign * (from as f64 - column) / soft) as f32,
        (sign / soft) as f32,
    );
    for (k, value) in row[from..to].iter_mut().enumerate() {
        *value += delta * smooth(at + k as f32 * gain);
    }
}

/// Adds the light of a side's wall, from where the side begins towards the opposite edge.
fn light_wall(
    wall: &mut [f32],
    face: &Face,
    (column, soft): (f64, f64),
    opposite: f64,
    pixel_mm: f64,
    outwards: bool,
) {
    let [brightness, fades] = face.wall;
    if brightness <= 0.0 || fades <= 0.0 {
        return;
    }
    let inward = if outwards { -1.0 } else { 1.0 };
    let open = ((opposite - column) * inward).max(0.0);
    let at = |k: usize| column + inward * (WALL[k] * fades / pixel_mm).min(open);
    let mut before = 0.0;
    for k in 0..WALL.len() - 1 {
        let mean = ((-WALL[k]).exp() - (-WALL[k + 1]).exp()) / (WALL[k + 1] - WALL[k]);
        add_step(
            wall,
            (at(k), soft),
            !outwards,
            (brightness * (mean - before)) as f32,
        );
        before = mean;
    }
    let end = at(WALL.len() - 1);
    add_step(wall, (end, soft), !outwards, (-brightness * before) as f32);
}
