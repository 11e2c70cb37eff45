//! What marks, the sides of a gap and tacks make of a row of a picture.

use super::marks::{Mark, Run, Tack};
use super::row::{Strip, smooth, softness};
use super::scene::{Gap, Scene};
use super::side::Face;
use super::sketch::Sketch;

/// The surface's share below which what marks it is no more looked up there: a gap.
const HARDLY: f32 = 0.05;

/// Where the light on a wall is divided into even strips, in lengths over which it fades by 1/e.
const WALL: [f64; 6] = [0.0, 0.25, 0.6, 1.1, 1.8, 3.0];

/// The row at `r` and what it is of.
pub(super) struct Line<'a> {
    pub sketch: &'a Sketch,
    pub scene: &'a Scene,
    pub r: f64,
    /// Squares of the blurs' radii, column by column \[pixels\].
    pub radii_squared: &'a [f32],
}

/// Column by column of one row.
#[derive(Clone, Debug, Default)]
pub(super) struct Dress {
    /// What marks along the seam add to the surface's factor, and those across it.
    marks: [Vec<f32>; 2],
    /// Factor of the surface, and the share that it takes.
    factor: Vec<f32>,
    cover: Vec<f32>,
    /// Light of the gap's walls.
    wall: Vec<f32>,
    /// The same three of one side.
    side: [Vec<f32>; 3],
    /// One over the softness of edges across the seam, where there are such marks \[1/mm\].
    sharpness: Vec<f32>,
    /// Whether there are marks.
    marked: bool,
}

impl Dress {
    pub fn new(columns: usize) -> Self {
        let row = || vec![0.0; columns];
        Self {
            marks: [row(), row()],
            factor: row(),
            cover: row(),
            wall: row(),
            side: [row(), row(), row()],
            sharpness: row(),
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
                for (column, one) in self.sharpness.iter_mut().enumerate() {
                    *one = (1.0 / line.soft_along(column)) as f32;
                }
            }
            // Parallel marks lie side by side; others may cross them.
            let (beside, slanted): (fn(&&Mark) -> bool, fn(&&Mark) -> bool) =
                (|mark| mark.slope == 0.0, |mark| mark.slope != 0.0);
            let marks = line.scene.marks.iter();
            for mark in marks.clone().filter(beside).chain(marks.filter(slanted)) {
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
                .for_each(|(sum, share)| *sum = added(*sum, gain * share, mark));
        }
    }

    fn mark_across(&mut self, line: &Line, mark: &Mark) {
        let (sketch, r) = (line.sketch, line.r);
        let seam = sketch.seam_column(r);
        let soft = line.most_along();
        let half = mark.width_mm / 2.0;
        let side = |column: usize| usize::from(column as f64 >= seam);
        let far = |column: usize| {
            let place = line.place(column, side(column));
            place - mark.middle(sketch.lateral(r, column))
        };
        let ends = [far(0), far(sketch.columns - 1)];
        // A step between the sides shifts one of them against the other.
        let step = sketch.along(r, 0, 0) - sketch.along(r, 0, 1);
        let reach = half + soft + step.abs();
        if ends.iter().all(|&far| far > reach) || ends.iter().all(|&far| far < -reach) {
            return;
        }
        let there = line.reach(0, mark.reaches_mm);
        if matches!(there, Reach::Nowhere) {
            return;
        }
        let gain = (mark.factor - 1.0) as f32;
        let row = self.marks[1].iter_mut().zip(&self.sharpness);
        for (column, (sum, one)) in row.enumerate() {
            let far = far(column);
            let mut share = smooth((half + far) as f32 * one) - smooth((far - half) as f32 * one);
            if let Reach::Part(ends) = &there {
                share *= ends.share(line, 0, column);
            }
            *sum = added(*sum, gain * share, mark);
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

impl Line<'_> {
    /// How far to each side an edge at a column is soft \[columns\].
    fn softness(&self, column: f64) -> f64 {
        softness(self.sketch, self.radii_squared, column)
    }

    /// How far an edge across the seam is soft to each side of a column, along travel \[mm\].
    fn soft_along(&self, column: usize) -> f64 {
        let soft = self.softness(column as f64);
        self.sketch.travel(soft * self.sketch.lens.pixel_mm)
    }

    /// The most of that over the row: the blur is largest at one of its ends, or at the seam beside a step.
    fn most_along(&self) -> f64 {
        let seam = self.sketch.seam_column(self.r).max(0.0) as usize;
        let last = self.sketch.columns - 1;
        [0, seam.saturating_sub(1), seam, last]
            .map(|column| self.soft_along(column.min(last)))
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// Column of a line on a side, so far outwards from the middle of the seam \[mm\].
    fn side_column(&self, outward: f64, side: usize) -> f64 {
        let lateral = if side == 0 { -outward } else { outward };
        self.sketch.side_column(self.r, lateral, side)
    }

    /// What it shows on a side of something between two places along travel on the work.
    fn reach(&self, side: usize, [from, to]: [f64; 2]) -> Reach {
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

/// What a mark makes of what others have made of the surface's factor: one that is parallel to the seam or square to it lies
/// beside them, others cross them.
fn added(sum: f32, gain: f32, mark: &Mark) -> f32 {
    if mark.slope == 0.0 {
        sum + gain
    } else {
        sum + gain * (1.0 + sum)
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

/// What a row shows of something between two places along travel.
enum Reach {
    Nowhere,
    Everywhere,
    Part(Ends),
}

/// Two ends along travel on the work \[mm\].
struct Ends {
    from: f64,
    to: f64,
}

impl Ends {
    /// Share of a column that lies between them.
    fn share(&self, line: &Line, side: usize, column: usize) -> f32 {
        let place = line.place(column, side);
        let soft = line.soft_along(column);
        let after = smooth(((place - self.from) / soft) as f32);
        let before = smooth(((self.to - place) / soft) as f32);
        (after + before - 1.0).max(0.0)
    }
}
