//! The course of the seams as far as they are taught, and how far the next point may be.

use super::SeamTeaching;
use nalgebra::{Matrix3, Vector3};
use shared::io::SIDES;

/// Points from which tangent and curvature are taken.
const RECENT: usize = 4;
/// The rule of the spacing is applied to this part of the chord's distance; the rest is for what is not foreseen.
const FORESEEN: f64 = 0.7;
/// A step is at most so many times as long as the one before.
const GROWTH: f64 = 2.0;
/// The first step is so many of the smallest.
const FIRST: f64 = 2.0;

/// What a seam begins or ends with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeamEnd {
    /// A plate begins or ends there.
    Plate,
    /// Something closes the gap there, such as a tack.
    Tack,
}

/// A seam on one side of the rib, at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredSeam {
    /// In the world \[mm\].
    pub position: Vector3<f64>,
    /// Unit normal of the skin, up to the head.
    pub normal: Vector3<f64>,
    /// Width of the gap; 0 if it was not measured \[mm\].
    pub width_mm: f64,
    /// 0…1.
    pub quality: f64,
    /// Standard deviation from picture to picture \[mm\].
    pub scatter_mm: f64,
    /// Pictures that saw it.
    pub pictures: usize,
    /// What the seam begins or ends with there; `None` where it goes on, or is not known to end.
    pub end: Option<SeamEnd>,
}

/// Both seams at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamPoint {
    /// Sum of the chords of seam 1 up to here \[mm\].
    pub s_mm: f64,
    /// Side 1 and 2.
    pub feet: [MeasuredSeam; SIDES],
}

impl SeamPoint {
    /// The point after `before` on both seams.
    pub fn after(before: Option<&Self>, feet: [MeasuredSeam; SIDES]) -> Self {
        let s_mm = before.map_or(0.0, |b| b.s_mm + (feet[0].position - b.feet[0].position).norm());
        Self { s_mm, feet }
    }

    /// Half way between the seams \[mm\].
    pub fn middle(&self) -> Vector3<f64> {
        (self.feet[0].position + self.feet[1].position) / 2.0
    }
}

/// Both seams around their newest points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course([Local; SIDES]);

impl Course {
    /// Around the end of `points`; `None` if there is none. `tangent` counts while there is no second one.
    pub fn of(points: &[SeamPoint], tangent: &Vector3<f64>) -> Option<Self> {
        let side = |k: usize| {
            let recent = &points[points.len().saturating_sub(RECENT)..];
            let feet: Vec<_> = recent.iter().map(|point| point.feet[k].position).collect();
            Local::of(&feet, tangent)
        };
        Some(Self([side(0)?, side(1)?]))
    }

    /// Where both seams are expected `step` \[mm\] further on, and the unit tangent between them.
    pub fn ahead(&self, step: f64) -> ([Vector3<f64>; SIDES], Vector3<f64>) {
        let [(first, t1), (second, t2)] = self.0.map(|side| side.ahead(step));
        ([first, second], (t1 + t2).normalize())
    }

    /// See [`Local::chord_distance`]: that of the seam that bends more.
    pub fn chord_distance(&self, step: f64, found: &[MeasuredSeam; SIDES]) -> f64 {
        let sides = self.0.iter().zip(found);
        let distances = sides.map(|(side, foot)| side.chord_distance(step, &foot.position));
        distances.fold(0.0, f64::max)
    }

    /// See [`Local::step`]: that of the seam that bends more.
    pub fn step(&self, config: &SeamTeaching, before: Option<f64>) -> f64 {
        let steps = self.0.iter().map(|side| side.step(config, before));
        steps.fold(f64::INFINITY, f64::min)
    }
}

/// A seam around its newest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// The newest point \[mm\].
    pub at: Vector3<f64>,
    /// Unit tangent there.
    pub tangent: Vector3<f64>,
    /// Curvature vector \[1/mm\].
    pub curvature: Vector3<f64>,
}

impl Local {
    /// Through the latest `points`, of which there is one at least, to their end; `tangent` counts while there is no
    /// second one.
    pub fn of(points: &[Vector3<f64>], tangent: &Vector3<f64>) -> Option<Self> {
        let at = *points.last()?;
        let straight = |tangent: Vector3<f64>| Self {
            at,
            tangent,
            curvature: Vector3::zeros(),
        };
        Some(match points {
            [_] => straight(*tangent),
            [before, _] => straight((at - before).normalize()),
            _ => Self::bent(points)?,
        })
    }

    /// The parabola through the points, by least squares over the chords.
    fn bent(points: &[Vector3<f64>]) -> Option<Self> {
        let mut places = vec![0.0];
        for pair in points.windows(2).rev() {
            places.push(places[places.len() - 1] - (pair[1] - pair[0]).norm());
        }
        places.reverse();
        let mut normal = Matrix3::zeros();
        let mut right = Matrix3::zeros();
        for (s, point) in places.iter().zip(points) {
            let powers = Vector3::new(1.0, *s, s * s);
            normal += powers * powers.transpose();
            right += powers * point.transpose();
        }
        let solved = normal.lu().solve(&right)?;
        let tangent = solved.row(1).transpose().normalize();
        let second = solved.row(2).transpose() * 2.0;
        Some(Self {
            at: *points.last()?,
            tangent,
            curvature: second - tangent * second.dot(&tangent),
        })
    }

    /// Where the seam is expected `step` \[mm\] further on, and its tangent there.
    pub fn ahead(&self, step: f64) -> (Vector3<f64>, Vector3<f64>) {
        (
            self.at + self.tangent * step + self.curvature * (step * step / 2.0),
            (self.tangent + self.curvature * step).normalize(),
        )
    }

    /// Distance of the seam from the chord to `found`, which is about `step` further on \[mm\]: that of the
    /// curvature so far, and as much as a bend that begins on the way can add.
    pub fn chord_distance(&self, step: f64, found: &Vector3<f64>) -> f64 {
        let (expected, tangent) = self.ahead(step);
        let miss = found - expected;
        let beside = (miss - tangent * miss.dot(&tangent)).norm();
        self.curvature.norm() * step * step / 8.0 + beside / 2.0
    }

    /// Way to the next point: Δs = min(Δs_max, √(8ρε), ρφ_max) (mathematics 0.4), not much longer than the
    /// step `before`.
    pub fn step(&self, config: &SeamTeaching, before: Option<f64>) -> f64 {
        let curvature = self.curvature.norm();
        let largest = before.map_or(FIRST * config.smallest_step_mm, |step| GROWTH * step);
        let mut step = largest.min(config.largest_step_mm);
        if curvature > 0.0 {
            step = step
                .min(libm::sqrt(8.0 * FORESEEN * config.chord_mm / curvature))
                .min(config.turn_deg.to_radians() / curvature);
        }
        step.max(config.smallest_step_mm)
    }
}
