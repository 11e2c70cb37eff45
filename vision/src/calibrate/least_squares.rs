//! Lines and planes through readings.

use nalgebra::{SMatrix, SVector};

/// Weighted least squares of N coefficients, by the normal equations.
#[derive(Clone, Debug)]
pub(super) struct LeastSquares<const N: usize, const M: usize> {
    information: SMatrix<f64, N, N>,
    sums: SMatrix<f64, N, M>,
}

impl<const N: usize, const M: usize> LeastSquares<N, M> {
    /// Without readings.
    pub fn new() -> Self {
        Self {
            information: SMatrix::zeros(),
            sums: SMatrix::zeros(),
        }
    }

    /// Adds a reading of M values where the coefficients' factors are `x`.
    pub fn add(&mut self, x: [f64; N], values: [f64; M], weight: f64) {
        let x = SVector::from(x);
        self.information += x * x.transpose() * weight;
        self.sums += x * SVector::from(values).transpose() * weight;
    }

    /// Leaves a coefficient at 0 if the readings do not depend on it.
    pub fn hold(&mut self, k: usize) {
        self.information.row_mut(k).fill(0.0);
        self.information.column_mut(k).fill(0.0);
        self.information[(k, k)] = 1.0;
        self.sums.row_mut(k).fill(0.0);
    }

    /// Coefficients, a column for each of the M values; `None` if the readings do not determine them.
    pub fn solve(&self) -> Option<SMatrix<f64, N, M>> {
        let solution = self.information.cholesky()?.solve(&self.sums);
        solution.iter().all(|x| x.is_finite()).then_some(solution)
    }
}
