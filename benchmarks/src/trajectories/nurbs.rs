//! NURBS that are kept.

use curves::nurbs::{Nurbs, NurbsError};
use nalgebra::Vector3;

/// A NURBS with its own memory.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeForm {
    degree: usize,
    points: Vec<Vector3<f64>>,
    weights: Vec<f64>,
    knots: Vec<f64>,
}

impl FreeForm {
    /// See [`Nurbs::new`].
    pub fn new(
        degree: usize,
        points: Vec<Vector3<f64>>,
        weights: Vec<f64>,
        knots: Vec<f64>,
    ) -> Result<Self, NurbsError> {
        Nurbs::new(degree, &points, &weights, &knots)?;
        Ok(Self {
            degree,
            points,
            weights,
            knots,
        })
    }

    /// The curve.
    pub fn curve(&self) -> Nurbs<'_> {
        Nurbs::new(self.degree, &self.points, &self.weights, &self.knots).expect("new() has checked it")
    }
}
