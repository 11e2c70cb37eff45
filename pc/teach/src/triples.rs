//! The published normal from three triangles, to compare with (mathematics 2.3).
//!
//! Noise apart, it errs on a cylinder of radius R by up to 0.12·S/R, and its spread of 0.5·S/R asks for smaller rings
//! than the surface needs: the triangles leave some of the curvature in. [`crate::Ring::normal`] does not.

use crate::ring::{NEIGHBOURS, Ring};
use nalgebra::Vector3;
use shared::geometry::angle;

/// Normals of the triangles (1, 4, 6), (2, 5, 7) and (3, 6, 8) of a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triples {
    /// Cross products of two sides over the product of their lengths, as published: not of unit length.
    pub published: [Vector3<f64>; 3],
    /// Unit normals.
    pub normals: [Vector3<f64>; 3],
    /// Direction of the mean of the unit normals.
    pub normal: Vector3<f64>,
    /// Largest angle between two of the normals \[rad\].
    pub spread: f64,
}

/// Sides of the triangle that starts at point `k`: to the third and the fifth point after it.
fn sides(ring: &Ring, k: usize) -> [Vector3<f64>; 2] {
    [3, 5].map(|step| ring.point(k + step) - ring.point(k))
}

/// Unit normal of that triangle.
fn normal(ring: &Ring, k: usize) -> Vector3<f64> {
    let [b, c] = sides(ring, k);
    b.cross(&c).normalize()
}

impl Ring {
    /// The published three triangles.
    pub fn triples(&self) -> Triples {
        let normals = [0, 1, 2].map(|k| normal(self, k));
        let [a, b, c] = &normals;
        Triples {
            published: [0, 1, 2].map(|k| {
                let [b, c] = sides(self, k);
                b.cross(&c) / (b.norm() * c.norm())
            }),
            normals,
            normal: (a + b + c).normalize(),
            spread: angle(a, b).max(angle(b, c)).max(angle(c, a)),
        }
    }

    /// Direction of the mean of the unit normals of all eight such triangles.
    pub fn all_triples_normal(&self) -> Vector3<f64> {
        (0..NEIGHBOURS)
            .map(|k| normal(self, k))
            .sum::<Vector3<f64>>()
            .normalize()
    }
}
