//! The two sides of a gap, each with a brightness and an edge of its own.

use crate::geometry::PlateSeam;
use crate::optics::Optics;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Depth over which the light on the wall of a gap fades by 1/e \[mm\].
pub(super) const FADING_MM: f64 = 0.1;

/// What a burr takes across the seam for its height, from the edge to its crest and from there to the plate.
const RISE: f64 = 0.3;
const FALL: f64 = 1.2;

/// Form of an edge, and its size \[mm\]; a sharp one is a burr without height.
#[derive(Clone, Copy)]
enum Form {
    Chamfer(f64),
    Rolled(f64),
    Burr(f64),
}

/// One side of a gap. What lies beside its edge runs along the seam with it; lengths are counted from the root edge,
/// where the plate's face or its chamfer meets the wall of the gap, along the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Brightness of its plate; 1 is that of the light's level.
    pub brightness: f64,
    /// Leg of a chamfer of 45° \[mm\].
    pub chamfer_mm: f64,
    /// Radius of a rolled edge, where there is no chamfer \[mm\].
    pub rounding_mm: f64,
    /// Height of a burr, where there is neither \[mm\]: it rises over 0.3 of it and falls over 1.2.
    pub burr_mm: f64,
    /// What chamfer, rolled edge or burr multiplies the plate's brightness by.
    pub edge_factor: f64,
    /// Brightness of the gap's wall at the top; it fades with depth.
    pub wall_brightness: f64,
    /// Width \[mm\] and factor of a line along the edge.
    pub rim: [f64; 2],
    /// Width \[mm\] and factor of the shadow that a higher plate throws.
    pub shadow: [f64; 2],
    /// From where to where along travel on the work there is a plate \[mm\]; it ends square to the seam.
    pub reaches_mm: [f64; 2],
}

impl Default for Side {
    /// A sharp edge of an even plate without end, over a dark wall.
    fn default() -> Self {
        Self {
            brightness: 1.0,
            chamfer_mm: 0.0,
            rounding_mm: 0.0,
            burr_mm: 0.0,
            edge_factor: 1.0,
            wall_brightness: 0.0,
            rim: [0.0, 1.0],
            shadow: [0.0, 1.0],
            reaches_mm: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

impl Side {
    /// Nothing: in place of it one looks into the depth.
    pub fn missing() -> Self {
        Self {
            reaches_mm: [f64::INFINITY; 2],
            ..Self::default()
        }
    }

    fn form(&self) -> Form {
        if self.chamfer_mm > 0.0 {
            Form::Chamfer(self.chamfer_mm)
        } else if self.rounding_mm > 0.0 {
            Form::Rolled(self.rounding_mm)
        } else {
            Form::Burr(self.burr_mm)
        }
    }

    /// Length of chamfer, rolled edge or burr along the surface \[mm\].
    fn edge_length(&self) -> f64 {
        match self.form() {
            Form::Chamfer(leg) => leg * SQRT_2,
            Form::Rolled(radius) => radius * FRAC_PI_2,
            Form::Burr(height) => height * (RISE.hypot(1.0) + FALL.hypot(1.0)),
        }
    }

    /// A point of the surface, so far along it from the root edge: how far outside the edge, and how deep below the
    /// plate \[mm\].
    fn surface(&self, arc: f64) -> [f64; 2] {
        let beyond = arc - self.edge_length();
        match self.form() {
            Form::Chamfer(leg) if beyond < 0.0 => [arc / SQRT_2, leg - arc / SQRT_2],
            Form::Chamfer(leg) => [leg + beyond, 0.0],
            Form::Rolled(radius) if beyond < 0.0 => {
                let (sin, cos) = (arc / radius).sin_cos();
                [radius * (1.0 - cos), radius * (1.0 - sin)]
            }
            Form::Rolled(radius) => [radius + beyond, 0.0],
            Form::Burr(height) if beyond < 0.0 => {
                let rise = (arc / RISE.hypot(1.0)).min(height);
                let fall = (arc / RISE.hypot(1.0) - height).max(0.0) * RISE.hypot(1.0) / FALL.hypot(1.0);
                [RISE * rise + FALL * fall, fall - rise]
            }
            Form::Burr(height) => [(RISE + FALL) * height + beyond, 0.0],
        }
    }

    /// Whether it is there, at a place along travel on the work.
    pub fn is_at(&self, place_mm: f64) -> bool {
        (self.reaches_mm[0]..=self.reaches_mm[1]).contains(&place_mm)
    }
}

/// What lines of sight gain across the seam on their way from a plate's face down into the gap, mm for mm of depth
/// (mathematics 0.12): above 0 they come from the right, so that the left wall is seen.
pub(super) fn slant(plate: &PlateSeam, optics: &Optics) -> f64 {
    let (sin, cos) = optics.tilt_rad.sin_cos();
    let tangent = plate.yaw_rad.tan();
    let along = Vector3::new(1.0, tangent, plate.pitch + plate.roll * tangent).normalize();
    let out = plate.normal();
    let sight = Vector3::new(sin, 0.0, -cos);
    sight.dot(&out.cross(&along)) / sight.dot(&out)
}

/// Strips beside an edge that a side can have: two of it, a line, a shadow.
const STRIPS: usize = 4;

/// How a side appears to lines of sight that pass the plane of its plate so far outside its root edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Face {
    /// Where the side begins \[mm\].
    pub begins: f64,
    /// Where each strip ends \[mm\], and by what it multiplies the texture. They follow each other outwards.
    strips: [(f64, f64); STRIPS],
    count: usize,
    /// Factor beyond them.
    pub beyond: f64,
    /// Brightness of the wall where it begins to be seen, inward from `begins`, and the length over which it fades by
    /// 1/e \[mm\]; a length of 0 if it is hidden.
    pub wall: [f64; 2],
}

impl Face {
    /// The faces of the left and right side of a plate that is seen with this [`slant`].
    pub fn both([left, right]: &[Side; 2], slant: f64) -> [Self; 2] {
        [Self::new(left, -slant), Self::new(right, slant)]
    }

    /// The face of a side; `slant` is above 0 if its wall is hidden.
    fn new(side: &Side, slant: f64) -> Self {
        let at = |arc: f64| {
            let [x, depth] = side.surface(arc);
            x + slant * depth
        };
        let [_, root] = side.surface(0.0);
        let begins = match side.form() {
            Form::Chamfer(leg) => slant * leg,
            // Where lines of sight touch the arc.
            Form::Rolled(radius) if slant > 0.0 => radius * (1.0 + slant - 1f64.hypot(slant)),
            Form::Rolled(radius) => slant * radius,
            Form::Burr(height) => (height * (RISE - slant)).min(0.0),
        };
        let zones = [
            (side.edge_length(), side.edge_factor),
            (side.rim[0], side.rim[1]),
            (side.shadow[0], side.shadow[1]),
        ];
        let mut strips = [(begins, side.brightness); STRIPS];
        let mut count = 0;
        let mut from = 0.0;
        while let Some(to) = zones
            .iter()
            .map(|zone| zone.0)
            .filter(|&to| to > from)
            .min_by(f64::total_cmp)
        {
            let here = zones.iter().filter(|zone| zone.0 >= to);
            let factor: f64 = here.map(|zone| zone.1).product();
            strips[count] = (at(to).max(begins), side.brightness * factor);
            count += 1;
            from = to;
        }
        let fades = FADING_MM * (-slant).max(0.0);
        Self {
            begins,
            strips,
            count,
            beyond: side.brightness,
            wall: [side.wall_brightness * (-root / FADING_MM).exp(), fades],
        }
    }

    /// Its strips from the edge outwards: where each ends \[mm\], and by what it multiplies the texture.
    pub fn strips(&self) -> &[(f64, f64)] {
        &self.strips[..self.count]
    }

    /// What multiplies the texture at `x` mm outside the edge; changes are as soft as `sample` mm are wide.
    pub fn factor(&self, x: f64, sample: f64) -> f64 {
        let Some(&(_, first)) = self.strips().first() else {
            return self.beyond;
        };
        let next = self.strips().iter().skip(1).map(|strip| strip.1);
        let next = next.chain([self.beyond]);
        let mut factor = first;
        let mut before = first;
        for (&(ends, _), next) in self.strips().iter().zip(next) {
            factor += (next - before) * ((x - ends) / sample + 0.5).clamp(0.0, 1.0);
            before = next;
        }
        factor
    }

    /// Brightness of the wall at `x` mm outside the edge.
    pub fn wall_at(&self, x: f64) -> f64 {
        let [brightness, fades] = self.wall;
        if fades > 0.0 && x < self.begins {
            brightness * ((x - self.begins) / fades).exp()
        } else {
            0.0
        }
    }
}
