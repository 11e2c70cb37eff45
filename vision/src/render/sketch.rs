//! A scene, prepared column by column for rows to be rendered.

use super::blur::Lens;
use super::film::{Film, fading};
use super::grid::Grid;
use super::scene::{Joint, Scene};
use super::side::{Face, Side, slant};
use super::tile::Tile;
use crate::optics::Optics;
use std::ops::Range;
use std::sync::Arc;

/// What rows of a picture have in common. Lengths are millimetres.
#[derive(Clone, Debug)]
pub(super) struct Sketch {
    pub lens: Lens,
    pub columns: usize,
    /// Column of the optical axis.
    pub middle: f64,
    /// u of the seam at r = 0 and what it gains along r.
    seam: [f64; 2],
    /// What a step between the sides shifts a line along the seam by, seen in one row: left and right \[mm along u\].
    shift: [f64; 2],
    /// Way square to the seam for a way along u.
    pub squareness: f64,
    /// sin ψ.
    pub yaw_sin: f64,
    /// a of the seam at r = 0 and what it gains along r.
    along: [f64; 2],
    /// Depth gained along r.
    steepness: f64,
    /// cos α + p sin α.
    divisor: f64,
    /// What the surface's height takes from the depth in each column, on a plate left and right of the seam; a corner's
    /// are the same.
    pub fall: [Vec<f32>; 2],
    /// The same with what the curvature of the field adds in a column.
    pub focus: [Vec<f32>; 2],
    /// What it adds along rows: for r².
    curvature: f64,
    /// The sides of a gap as they appear.
    pub faces: [Face; 2],
    /// How each glare and then each spot of dirt fades over the columns, one after the other.
    pub bells: Vec<f32>,
    optics: Optics,
    /// Brightness of each column's wall relative to the left and right one, root far away.
    pub lit: Vec<f32>,
    /// Brightness of the walls.
    pub walls: [f32; 2],
    /// Whether `lit` and `walls` are anything but 1.
    pub corner: bool,
    /// x of the shading, −1…1, and x².
    pub shading: [Vec<f32>; 2],
    /// Which row and column of its tile the picture begins at, for each side of the seam.
    pub begin: [[usize; 2]; 2],
    /// Way across the seam in the surface for each column, as blobs have it.
    pub across: Vec<f32>,
    /// sin and cos of the tilt.
    tilt: [f64; 2],
    /// Row of the optical axis.
    middle_row: f64,
    /// How the tiles left and right repeat, their rows and columns for one of the picture, and dn/du of their surfaces.
    grids: [Grid; 2],
    scales: [[f64; 2]; 2],
    slopes: [f64; 2],
}

impl Sketch {
    pub fn new(tiles: &[Arc<Tile>; 2]) -> Self {
        let optics = tiles[0].optics();
        let columns = optics.columns;
        let [middle_row, middle] = optics.centre();
        let (sin, cos) = optics.tilt_rad.sin_cos();
        let x = |column: usize| ((column as f64 - middle) / middle.max(1.0)) as f32;
        Self {
            lens: Lens::new(optics),
            columns,
            middle,
            seam: [0.0; 2],
            shift: [0.0; 2],
            squareness: 1.0,
            yaw_sin: 0.0,
            along: [0.0; 2],
            steepness: 1.0,
            divisor: 1.0,
            fall: [vec![0.0; columns], vec![0.0; columns]],
            focus: [vec![0.0; columns], vec![0.0; columns]],
            curvature: 0.0,
            faces: Face::both(&[Side::default(); 2], 0.0),
            bells: Vec::new(),
            optics: *optics,
            lit: vec![1.0; columns],
            walls: [1.0; 2],
            corner: false,
            shading: [
                (0..columns).map(x).collect(),
                (0..columns).map(|c| x(c) * x(c)).collect(),
            ],
            begin: [[0; 2]; 2],
            across: vec![0.0; columns],
            tilt: [sin, cos],
            middle_row,
            grids: tiles.each_ref().map(|tile| tile.grid()),
            scales: tiles.each_ref().map(|tile| tile.scale()),
            slopes: tiles.each_ref().map(|tile| tile.slope()),
        }
    }

    /// Takes up a scene.
    pub fn prepare(&mut self, scene: &Scene) {
        let [sin, cos] = self.tilt;
        let (g, middle) = (self.lens.pixel_mm, self.middle);
        let u = |column: usize| (column as f64 - middle) * g;
        let height = match &scene.joint {
            Joint::Gap(gap) => {
                let (p, q) = (gap.plate.pitch, gap.plate.roll);
                let (h, u0) = (gap.plate.height_mm, gap.plate.lateral_mm);
                let tangent = gap.plate.yaw_rad.tan();
                // r = a cos α + n sin α with n = h + p a + q u and u = u0 + a tan ψ.
                let gain = 1.0 / (cos + (p + q * tangent) * sin);
                self.along = [-(h + q * u0) * sin * gain, gain];
                self.seam = [u0 + self.along[0] * tangent, gain * tangent];
                self.shift = [0.5, -0.5].map(|side| side * gap.step_mm * sin * gain * tangent);
                let divisor = cos + p * sin;
                self.divisor = divisor;
                self.squareness = gap.plate.squareness() * (1.0 + tangent * q * sin / divisor);
                self.yaw_sin = gap.plate.yaw_rad.sin();
                self.steepness = (sin - p * cos) / divisor;
                for column in 0..self.columns {
                    let level = h + q * u(column);
                    self.across[column] = u(column) as f32;
                    self.fall[0][column] = ((level - gap.step_mm / 2.0) / divisor) as f32;
                    self.fall[1][column] = ((level + gap.step_mm / 2.0) / divisor) as f32;
                }
                self.corner = false;
                if scene.has_effects() {
                    self.faces = Face::both(&scene.sides, slant(&gap.plate, &self.optics));
                }
                h
            }
            Joint::Corner(root) => {
                let (h, u0) = (root.corner.height_mm, root.corner.lateral_mm);
                self.seam = [u0, 0.0];
                self.shift = [0.0; 2];
                self.squareness = 1.0;
                self.yaw_sin = 0.0;
                self.along = [-h * sin / cos, 1.0 / cos];
                self.divisor = cos;
                self.steepness = sin / cos;
                for column in 0..self.columns {
                    let lateral = u(column) - u0;
                    let wall = root.corner.walls[usize::from(lateral >= 0.0)];
                    self.across[column] = (u0 + lateral * wall.hypot(1.0)) as f32;
                    let fall = ((h + root.rise(lateral)) / cos) as f32;
                    self.fall[0][column] = fall;
                    self.fall[1][column] = fall;
                    self.lit[column] = root.interreflected(lateral) as f32;
                }
                self.walls = root.brightness.map(|b| b as f32);
                self.corner = true;
                h
            }
        };
        self.bend(scene);
        self.frame(&scene.film);
        // The texture goes with the work, along travel as the rows of the picture see it, and across: on a wall as far
        // as from the root. Of the right wall it is another part.
        let [lateral, part] = match &scene.joint {
            Joint::Gap(_) => [0.0, 0.0],
            Joint::Corner(root) => [root.corner.lateral_mm, 0.5],
        };
        for side in 0..2 {
            let (grid, slope) = (self.grids[side], self.slopes[side]);
            let across = (scene.position_mm[1] + lateral) / slope.hypot(1.0);
            let along = scene.position_mm[0] * cos - height * sin + slope * sin * across;
            let part = part * side as f64;
            let scale = self.scales[side];
            let row = along / g * scale[0] - self.middle_row + part * grid.size[0] as f64;
            let column = across / g * scale[1] - lateral / g - self.middle + part * grid.size[1] as f64;
            let [row, column] = [row, column].map(|x| x.round() as i64);
            let columns = grid.size[1] as i64;
            let periods = column.div_euclid(columns);
            self.begin[side] = [grid.row(row, periods), column.rem_euclid(columns) as usize];
        }
    }

    /// Takes up the curvature of the field.
    fn bend(&mut self, scene: &Scene) {
        let (g, middle) = (self.lens.pixel_mm, self.middle);
        self.curvature = scene.curved(1.0, 0.0, &self.optics);
        for (focus, fall) in self.focus.iter_mut().zip(&self.fall) {
            focus.copy_from_slice(fall);
            if scene.curvature_mm != 0.0 {
                for (column, focus) in focus.iter_mut().enumerate() {
                    *focus -= scene.curved(0.0, (column as f64 - middle) * g, &self.optics) as f32;
                }
            }
        }
    }

    /// Takes up what lies over the picture.
    fn frame(&mut self, film: &Film) {
        self.bells.clear();
        let glares = film.glares.iter().map(|glare| (glare.middle, glare.radius));
        let dirt = film.dirt.iter().map(|dirt| (dirt.middle, dirt.radius));
        for (middle, radius) in glares.chain(dirt) {
            let bell = |x: &f32| fading(f64::from(*x), middle[0], radius) as f32;
            self.bells.extend(self.shading[0].iter().map(bell));
        }
    }

    /// Rows of the tiles that a row of the picture shows, on each side of the seam.
    pub fn tile_rows(&self, row: usize) -> [usize; 2] {
        [0, 1].map(|side| (self.begin[side][0] + row) % self.grids[side].size[0])
    }

    /// Depth at `r` over a height of 0.
    pub fn depth(&self, r: f64) -> f64 {
        r * self.steepness + self.curvature * r * r
    }

    /// Column in which the middle of the seam lies at `r`.
    pub fn seam_column(&self, r: f64) -> f64 {
        self.middle + (self.seam[0] + self.seam[1] * r) / self.lens.pixel_mm
    }

    /// Column of a line that runs `lateral` mm from the seam, square to it.
    pub fn line_column(&self, r: f64, lateral: f64) -> f64 {
        self.side_column(r, lateral, usize::from(lateral >= 0.0))
    }

    /// The same of a line on the plate of a side, whichever side of the seam it runs on.
    pub fn side_column(&self, r: f64, lateral: f64, side: usize) -> f64 {
        self.seam_column(r) + (lateral / self.squareness + self.shift[side]) / self.lens.pixel_mm
    }

    /// How far from the middle of the seam a column is, square to it \[mm\].
    pub fn lateral(&self, r: f64, column: usize) -> f64 {
        (column as f64 - self.seam_column(r)) * self.lens.pixel_mm * self.squareness
    }

    /// a of the seam at `r`.
    pub fn seam_along(&self, r: f64) -> f64 {
        self.along[0] + self.along[1] * r
    }

    /// Way along travel for a way along r.
    pub fn travel(&self, r: f64) -> f64 {
        r / self.divisor
    }

    /// Way square to the seam for one column \[mm\].
    pub fn lateral_per_column(&self) -> f64 {
        self.lens.pixel_mm * self.squareness
    }

    /// Variance of what blurs edges that are in focus \[pixels²\].
    pub fn sharp_variance(&self) -> f64 {
        (self.lens.diffraction_mm / self.lens.pixel_mm).powi(2) + 1.0 / 12.0
    }

    /// a of the surface in some columns at `r`, on a side of the seam.
    pub fn places(&self, r: f64, side: usize, columns: Range<usize>, out: &mut [f32]) {
        let (first, sin) = (self.travel(r) as f32, self.tilt[0] as f32);
        for (out, fall) in out.iter_mut().zip(&self.fall[side][columns]) {
            *out = first - fall * sin;
        }
    }

    /// a of a column's surface at `r`, on a side of the seam.
    pub fn along(&self, r: f64, column: usize, side: usize) -> f64 {
        self.travel(r) - f64::from(self.fall[side][column]) * self.tilt[0]
    }
}
