//! Smooth curves through points in any number of channels: natural cubic splines with one parameter.

use curves::{NaturalSpline, SplineError};

/// A natural cubic spline in `N` channels of which the first three are a position \[mm\].
#[derive(Clone, Debug)]
pub struct Curve<const N: usize> {
    x: Vec<f64>,
    channels: [Channel; N],
}

#[derive(Clone, Debug, Default)]
struct Channel {
    value: Vec<f64>,
    second: Vec<f64>,
}

/// Value, first and second derivative of every channel.
pub type Jet<const N: usize> = [[f64; N]; 3];

/// Nodes and weights of the five-point Gauss–Legendre rule on −1…1.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Rounds of re-parametrisation; each one brings |dP/ds| closer to 1 until the spline itself limits it.
const ROUNDS: usize = 3;

impl<const N: usize> Curve<N> {
    /// The spline through `points` at the parameters `x`, which increase strictly.
    pub fn through(x: Vec<f64>, points: &[[f64; N]]) -> Result<Self, SplineError> {
        let channels = std::array::from_fn(|c| Channel {
            value: points.iter().map(|p| p[c]).collect(),
            second: vec![0.0; points.len()],
        });
        let mut curve = Self { x, channels };
        curve.solve()?;
        Ok(curve)
    }

    /// The spline through `points` over its own arc length: first over the chords, then re-parametrised.
    pub fn by_length(points: &[[f64; N]]) -> Result<Self, SplineError> {
        let chords = points.windows(2).map(|p| distance(&p[0], &p[1]));
        let mut curve = Self::through(running_sum(chords), points)?;
        for _ in 0..ROUNDS {
            let lengths: Vec<f64> = (1..points.len()).map(|i| curve.span_length(i)).collect();
            curve.x = running_sum(lengths.into_iter());
            curve.solve()?;
        }
        Ok(curve)
    }

    fn solve(&mut self) -> Result<(), SplineError> {
        let mut scratch = vec![0.0; self.x.len()];
        for channel in &mut self.channels {
            NaturalSpline::solve(&self.x, &channel.value, &mut channel.second, &mut scratch)?;
        }
        Ok(())
    }

    /// Parameters of the points.
    pub fn parameters(&self) -> &[f64] {
        &self.x
    }

    /// Parameter of the last point.
    pub fn end(&self) -> f64 {
        self.x.last().copied().unwrap_or(0.0)
    }

    /// All channels at `t`; outside the points the curve continues in a straight line.
    pub fn at(&self, t: f64) -> Jet<N> {
        let mut jet = [[0.0; N]; 3];
        for (c, channel) in self.channels.iter().enumerate() {
            let spline = NaturalSpline::of_solved(&self.x, &channel.value, &channel.second);
            for (derivative, value) in spline.at(t).into_iter().enumerate() {
                jet[derivative][c] = value;
            }
        }
        jet
    }

    /// Largest | |dP/dt| − 1 | between the points, sampled eight times a span.
    pub fn speed_error(&self) -> f64 {
        let spans = self.x.windows(2);
        spans
            .flat_map(|x| (0..8).map(|i| x[0] + (x[1] - x[0]) * (f64::from(i) + 0.5) / 8.0))
            .map(|t| (self.speed(t) - 1.0).abs())
            .fold(0.0, f64::max)
    }

    fn speed(&self, t: f64) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|c| self.at(t)[1][c]);
        libm::sqrt(x * x + y * y + z * z)
    }

    fn span_length(&self, i: usize) -> f64 {
        let half = (self.x[i] - self.x[i - 1]) / 2.0;
        let middle = (self.x[i] + self.x[i - 1]) / 2.0;
        GAUSS
            .iter()
            .map(|(node, weight)| weight * half * self.speed(middle + half * node))
            .sum()
    }
}

/// Distance of two points in their first three channels \[mm\].
pub fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    libm::sqrt((0..3).map(|i| (b[i] - a[i]) * (b[i] - a[i])).sum())
}

/// 0 and the sums of the first 1, 2, … values.
fn running_sum(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let sums = values.scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_by_length_runs_at_unit_speed() {
        let radius = 600.0;
        let points: Vec<[f64; 3]> = (0..=40)
            .map(|i| f64::from(i) * 10.0 / radius)
            .map(|phi| [radius * libm::sin(phi), radius * (1.0 - libm::cos(phi)), 0.0])
            .collect();
        let curve = Curve::by_length(&points).unwrap();
        assert!((curve.end() - 400.0).abs() < 1e-3, "length {}", curve.end());
        assert!(curve.speed_error() < 5e-5, "{}", curve.speed_error());
    }

    #[test]
    fn equal_points_make_no_curve() {
        assert!(Curve::by_length(&[[0.0; 3], [0.0; 3], [1.0; 3]]).is_err());
    }
}
