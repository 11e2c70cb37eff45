//! Smoothing of measured curves by natural cubic splines (Reinsch 1967): the smoothest curve that is as far from its
//! points as they scatter.

use nalgebra::{Matrix3, Vector3};

/// Bisections of the smoothing.
const HALVINGS: usize = 60;
/// Powers of ten of the smoothing \[1\] between which the best is found, times the cube of the mean spacing.
const POWERS: [f64; 2] = [-12.0, 12.0];

/// Mean square of the distances that is aimed at, in standard deviations. Less than 1, so that places where the seam
/// bends more than elsewhere keep their bend.
const MISFIT: f64 = 0.5;

/// Points over a parameter, with a standard deviation each.
#[derive(Clone, Debug)]
pub struct Scattered<'a, const N: usize> {
    /// Increases strictly.
    pub x: &'a [f64],
    /// Measured.
    pub y: &'a [[f64; N]],
    /// Of each channel of each point; 0 for points that are exact.
    pub sigma: &'a [f64],
}

impl<const N: usize> Scattered<'_, N> {
    /// The points of a parabola and the smoothest natural spline that are together not farther from the points than
    /// they scatter. Exact points stay.
    pub fn smoothed(&self) -> Vec<[f64; N]> {
        if self.x.len() < 3 || self.sigma.iter().all(|sigma| *sigma <= 0.0) {
            return self.y.to_vec();
        }
        // The ends of a natural spline are straight: what bends all along is taken out before.
        let Some(parabola) = self.parabola() else {
            return self.y.to_vec();
        };
        let combine = |a: &[[f64; N]], b: &[[f64; N]], sign: f64| -> Vec<[f64; N]> {
            let pairs = a.iter().zip(b);
            pairs
                .map(|(a, b)| std::array::from_fn(|c| a[c] + sign * b[c]))
                .collect()
        };
        let rest = combine(self.y, &parabola, -1.0);
        let rest = Scattered { y: &rest, ..*self };
        combine(&rest.spline(), &parabola, 1.0)
    }

    /// The points of the nearest parabola.
    fn parabola(&self) -> Option<Vec<[f64; N]>> {
        let (first, last) = (self.x[0], self.x[self.x.len() - 1]);
        let powers = |x: f64| {
            let t = (2.0 * x - first - last) / (last - first);
            Vector3::new(1.0, t, t * t)
        };
        let mut normal = Matrix3::zeros();
        let mut right = [Vector3::zeros(); N];
        for (x, y) in self.x.iter().zip(self.y) {
            let powers = powers(*x);
            normal += powers * powers.transpose();
            for (right, y) in right.iter_mut().zip(y) {
                *right += powers * *y;
            }
        }
        let inverse = normal.try_inverse()?;
        let factors = right.map(|right| inverse * right);
        Some(
            self.x
                .iter()
                .map(|x| factors.map(|f| f.dot(&powers(*x))))
                .collect(),
        )
    }

    /// The points of the smoothest natural spline that is not farther from the points than they scatter.
    fn spline(&self) -> Vec<[f64; N]> {
        let n = self.x.len();
        let spacing = (self.x[n - 1] - self.x[0]) / (n - 1) as f64;
        let mean = self.sigma.iter().map(|s| s * s).sum::<f64>() / n as f64;
        let scale = spacing * spacing * spacing / mean;
        let [mut low, mut high] = POWERS;
        let at = |power: f64| self.with(scale * libm::pow(10.0, power));
        if self.misfit(&at(high)) <= MISFIT {
            return at(high);
        }
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            if self.misfit(&at(middle)) < MISFIT {
                low = middle;
            } else {
                high = middle;
            }
        }
        at(low)
    }

    /// Mean square of the distances in standard deviations.
    fn misfit(&self, smooth: &[[f64; N]]) -> f64 {
        let mut sum = 0.0;
        let mut count = 0;
        for ((y, g), sigma) in self.y.iter().zip(smooth).zip(self.sigma) {
            if *sigma > 0.0 {
                sum += (0..N)
                    .map(|c| (y[c] - g[c]) * (y[c] - g[c]) / (sigma * sigma))
                    .sum::<f64>();
                count += N;
            }
        }
        sum / count as f64
    }

    /// The points of the spline g that makes Σ((y − g)/σ)² + λ∫g″² least.
    fn with(&self, lambda: f64) -> Vec<[f64; N]> {
        let n = self.x.len();
        let h: Vec<f64> = self.x.windows(2).map(|x| x[1] - x[0]).collect();
        let variance: Vec<f64> = self.sigma.iter().map(|s| s * s).collect();
        // Column j of Q has three numbers, at points j, j + 1 and j + 2.
        let q = |j: usize| [1.0 / h[j], -1.0 / h[j] - 1.0 / h[j + 1], 1.0 / h[j + 1]];
        let m = n - 2;
        let mut bands = vec![[0.0; 3]; m];
        for (j, band) in bands.iter_mut().enumerate() {
            let own = q(j);
            let product = |other: [f64; 3], shift: usize| {
                (shift..3)
                    .map(|i| own[i] * other[i - shift] * variance[j + i])
                    .sum::<f64>()
            };
            band[0] = (h[j] + h[j + 1]) / 3.0 + lambda * product(own, 0);
            if j + 1 < m {
                band[1] = h[j + 1] / 6.0 + lambda * product(q(j + 1), 1);
            }
            if j + 2 < m {
                band[2] = lambda * product(q(j + 2), 2);
            }
        }
        factor(&mut bands);
        let mut smooth = self.y.to_vec();
        for c in 0..N {
            let mut second: Vec<f64> = (0..m)
                .map(|j| {
                    let column = q(j);
                    (0..3).map(|i| column[i] * self.y[j + i][c]).sum()
                })
                .collect();
            solve(&bands, &mut second);
            for (j, second) in second.iter().enumerate() {
                for (i, value) in q(j).into_iter().enumerate() {
                    smooth[j + i][c] -= lambda * variance[j + i] * value * second;
                }
            }
        }
        smooth
    }
}

/// Factors a symmetric matrix of five bands, given by its diagonal and the two above, into L·D·Lᵀ in its place.
fn factor(bands: &mut [[f64; 3]]) {
    for j in 0..bands.len() {
        if let Some([d, _, l2]) = j.checked_sub(2).map(|i| bands[i]) {
            bands[j][0] -= d * l2 * l2;
        }
        if let Some([d, l1, l2]) = j.checked_sub(1).map(|i| bands[i]) {
            bands[j][0] -= d * l1 * l1;
            bands[j][1] -= d * l1 * l2;
        }
        let d = bands[j][0];
        bands[j][1] /= d;
        bands[j][2] /= d;
    }
}

/// Solves with the factors.
fn solve(bands: &[[f64; 3]], right: &mut [f64]) {
    let n = right.len();
    for j in 0..n {
        if j >= 1 {
            right[j] -= bands[j - 1][1] * right[j - 1];
        }
        if j >= 2 {
            right[j] -= bands[j - 2][2] * right[j - 2];
        }
    }
    for j in (0..n).rev() {
        right[j] /= bands[j][0];
        if j + 1 < n {
            right[j] -= bands[j][1] * right[j + 1];
        }
        if j + 2 < n {
            right[j] -= bands[j][2] * right[j + 2];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vision::render::SplitMix64;

    fn wave(x: f64) -> f64 {
        5.0 * (x / 60.0).sin()
    }

    #[test]
    fn noise_is_taken_out_and_the_curve_stays() {
        let sigma = 0.01;
        let mut noise = SplitMix64::new(5);
        let x: Vec<f64> = (0..80).map(|i| 4.0 * f64::from(i) + f64::from(i % 3)).collect();
        let y: Vec<[f64; 1]> = x.iter().map(|x| [wave(*x) + sigma * noise.gauss()[0]]).collect();
        let scattered = Scattered {
            x: &x,
            y: &y,
            sigma: &vec![sigma; x.len()],
        };
        let smooth = scattered.smoothed();
        assert!((scattered.misfit(&smooth) - MISFIT).abs() < 1e-6);
        let rms = |points: &[[f64; 1]]| {
            let squares = x.iter().zip(points).map(|(x, y)| (y[0] - wave(*x)).powi(2));
            (squares.sum::<f64>() / x.len() as f64).sqrt()
        };
        assert!(rms(&smooth) < 0.8 * rms(&y), "{} of {}", rms(&smooth), rms(&y));
        // No spline through other points is as smooth and as near: the least of the sum stays the least.
        let straight = Scattered {
            y: &x.iter().map(|x| [2.0 - 0.3 * x]).collect::<Vec<_>>(),
            ..scattered.clone()
        };
        let line = straight.smoothed();
        assert!(
            line.iter()
                .zip(straight.y)
                .all(|(a, b)| (a[0] - b[0]).abs() < 1e-9)
        );
    }

    #[test]
    fn exact_points_stay_as_they_are() {
        let (x, y) = ([0.0, 1.0, 2.5, 4.0], [[1.0], [0.0], [3.0], [1.0]]);
        let exact = Scattered {
            x: &x,
            y: &y,
            sigma: &[0.0; 4],
        };
        assert_eq!(exact.smoothed(), y);
    }
}
