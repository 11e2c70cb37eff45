//! Natural cubic spline (mathematics 0.4.1).

use thiserror::Error;

/// Why there is no spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SplineError {
    /// Fewer than two knots, x not strictly increasing, or a number not finite.
    #[error("knots")]
    Knots,
}

/// The C² curve y(x) through its knots with no curvature at both ends; outside it continues in a straight
/// line.
///
/// It borrows the knots and the second derivatives, so it needs no memory of its own.
#[derive(Clone, Copy, Debug)]
pub struct NaturalSpline<'a> {
    x: &'a [f64],
    y: &'a [f64],
    second: &'a [f64],
}

impl<'a> NaturalSpline<'a> {
    /// The spline through (`x`, `y`), with x strictly increasing. Its second derivatives are left in
    /// `second`; `scratch` is overwritten. All four slices have the same length, at least 2.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn solve(
        x: &'a [f64],
        y: &'a [f64],
        second: &'a mut [f64],
        scratch: &mut [f64],
    ) -> Result<Self, SplineError> {
        let n = x.len();
        assert!(
            y.len() == n && second.len() == n && scratch.len() == n,
            "slices of one length"
        );
        let finite = x.iter().chain(y).all(|value| value.is_finite());
        if n < 2 || !finite || x.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(SplineError::Knots);
        }
        // Thomas: row i is h₀·M[i−1] + 2(h₀+h₁)·M[i] + h₁·M[i+1] = 6·(chord₁ − chord₀).
        (second[0], scratch[0]) = (0.0, 0.0);
        for i in 1..n - 1 {
            let (h0, h1) = (x[i] - x[i - 1], x[i + 1] - x[i]);
            let right = 6.0 * ((y[i + 1] - y[i]) / h1 - (y[i] - y[i - 1]) / h0);
            let pivot = 2.0 * (h0 + h1) - h0 * scratch[i - 1];
            scratch[i] = h1 / pivot;
            second[i] = (right - h0 * second[i - 1]) / pivot;
        }
        second[n - 1] = 0.0;
        for i in (1..n - 1).rev() {
            second[i] -= scratch[i] * second[i + 1];
        }
        Ok(Self { x, y, second })
    }

    /// A spline solved before, whose `second` derivatives were kept. All three slices have the same length.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn of_solved(x: &'a [f64], y: &'a [f64], second: &'a [f64]) -> Self {
        let n = x.len();
        assert!(
            n >= 2 && y.len() == n && second.len() == n,
            "slices of one length"
        );
        Self { x, y, second }
    }

    /// Second derivatives at the knots.
    pub fn second(&self) -> &'a [f64] {
        self.second
    }

    /// Value, first and second derivative at `t`.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let last = self.x.len() - 1;
        if t < self.x[0] {
            return self.beyond(0, self.slope(0, 0.0), t);
        }
        if t > self.x[last] {
            return self.beyond(last, self.slope(last - 1, 1.0), t);
        }
        let i = self.x.partition_point(|&x| x <= t).clamp(1, last) - 1;
        let h = self.x[i + 1] - self.x[i];
        let b = (t - self.x[i]) / h;
        let a = 1.0 - b;
        let (m0, m1) = (self.second[i], self.second[i + 1]);
        let bend = ((a * a * a - a) * m0 + (b * b * b - b) * m1) * h * h / 6.0;
        [
            a * self.y[i] + b * self.y[i + 1] + bend,
            self.slope(i, b),
            a * m0 + b * m1,
        ]
    }

    /// First derivative in span `i` at its part `b` (0…1).
    fn slope(&self, i: usize, b: f64) -> f64 {
        let h = self.x[i + 1] - self.x[i];
        let a = 1.0 - b;
        (self.y[i + 1] - self.y[i]) / h
            + h / 6.0 * ((1.0 - 3.0 * a * a) * self.second[i] + (3.0 * b * b - 1.0) * self.second[i + 1])
    }

    fn beyond(&self, knot: usize, slope: f64, t: f64) -> [f64; 3] {
        [self.y[knot] + slope * (t - self.x[knot]), slope, 0.0]
    }
}
