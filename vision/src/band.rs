//! The engine of both joint forms: a robust maximum-likelihood fit of the sharp band.
//!
//! A surface gives every cell a depth z, the depth an expected energy P = A·T(z) + noise. Cells count by the
//! log-logistic likelihood ln P − 2 ln(P + E), whose score ψ = (E − P)/(E + P) no glint or scratch can pull far.

use crate::height_field::HeightField;
use crate::level::{Level, Sums};
use nalgebra::{SMatrix, SVector};

/// Curvature of a cell's likelihood over the square of dlnP.
const CURVATURE: f64 = 0.45;

/// Width of the bins whose scores count as independent \[mm\].
const BIN_MM: f64 = 0.0552;

/// Passes for the amplitudes alone, before the first iteration on a picture.
const WARM_UP: usize = 4;

/// Gaussian knowledge of parameters, independent of each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knowledge<const N: usize> {
    pub mean: [f64; N],
    pub sigma: [f64; N],
}

/// Gain from which there is a band.
pub(crate) const SMALLEST_GAIN: f64 = 0.003;

/// How well a fit holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fitness<const N: usize> {
    /// Covariance of the parameters as the scores scatter.
    pub covariance: SMatrix<f64, N, N>,
    /// Covariance as the likelihood is curved, what was known before included.
    pub curved: SMatrix<f64, N, N>,
    /// How much likelier it is a cell than a picture that is equally sharp everywhere, as a logarithm.
    pub gain: f64,
    /// Largest amplitude of the texture over the noise.
    pub contrast: f64,
}

/// The engine: two resolutions of the picture, the finer first.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    pub levels: [Level; 2],
}

impl Band {
    /// Finds the amplitudes of a new picture, from the band where it is thought to be.
    pub fn start<const N: usize>(&mut self, surface: &impl HeightField<N>, at: &[f64; N]) {
        for level in 0..self.levels.len() {
            self.start_level(level, surface, at);
        }
    }

    /// The same on one level.
    pub fn start_level<const N: usize>(
        &mut self,
        level: usize,
        surface: &impl HeightField<N>,
        at: &[f64; N],
    ) {
        let level = &mut self.levels[level];
        level.reset();
        for _ in 0..WARM_UP {
            level.pass(surface, at);
        }
    }

    /// Runs `iterations` of Fisher scoring on the levels from `finest` up. False if the picture says nothing.
    pub fn fit<const N: usize, S: HeightField<N>>(
        &mut self,
        surface: &S,
        at: &mut [f64; N],
        prior: &Knowledge<N>,
        finest: usize,
        iterations: usize,
    ) -> bool {
        for _ in 0..iterations {
            let (score, information) = self.score(surface, at, prior, finest);
            let Some(factors) = information.cholesky() else {
                return false;
            };
            let step = factors.solve(&score);
            if !step.iter().all(|step| step.is_finite()) {
                return false;
            }
            for k in 0..N {
                at[k] += step[k].clamp(-S::STEP[k], S::STEP[k]);
            }
        }
        true
    }

    /// How likely a fit is against no band at all, as a logarithm; what is known before counts too.
    pub fn evidence<const N: usize, S: HeightField<N>>(
        &self,
        surface: &S,
        at: &[f64; N],
        prior: &Knowledge<N>,
    ) -> f64 {
        let cells = |level: &Level| (level.cells.columns * level.cells.rows) as f64;
        let gained: f64 = self
            .levels
            .iter()
            .map(|level| cells(level) * level.gain(surface, at))
            .sum();
        let off = (0..N).map(|k| ((at[k] - prior.mean[k]) / prior.sigma[k]).powi(2));
        S::TEMPER * gained - off.sum::<f64>() / 2.0
    }

    /// How sure the fit is, and how much better than no band at all.
    pub fn fitness<const N: usize, S: HeightField<N>>(
        &mut self,
        surface: &S,
        at: &[f64; N],
        prior: &Knowledge<N>,
    ) -> Option<Fitness<N>> {
        let (_, information) = self.score(surface, at, prior, 0);
        let inverse = information.cholesky()?.inverse();
        let mut scatter = SMatrix::<f64, N, N>::zeros();
        let view = self.levels[0].cells.columns as f64 * f64::from(self.levels[0].cells.pitch_mm);
        let bins = (view / BIN_MM).ceil() as usize;
        for bin in 0..bins {
            // Both levels see the same texture: their scores of a bin belong together.
            let mut score = SVector::<f64, N>::zeros();
            for (level, weight) in self.levels.iter().zip([1.0, S::COARSER]) {
                let count = level.cells.columns;
                for column in bin * count / bins..(bin + 1) * count / bins {
                    score += weight * parameters(level, column, surface, at).0;
                }
            }
            score *= S::TEMPER;
            scatter += score * score.transpose();
        }
        for k in 0..N {
            scatter[(k, k)] += prior.sigma[k].powi(-2);
        }
        let coarse = &mut self.levels[1];
        Some(Fitness {
            covariance: inverse * scatter * inverse,
            curved: inverse,
            gain: coarse.gain(surface, at),
            contrast: coarse.contrast(),
        })
    }

    /// Score and information of the parameters, priors included.
    fn score<const N: usize, S: HeightField<N>>(
        &mut self,
        surface: &S,
        at: &[f64; N],
        prior: &Knowledge<N>,
        finest: usize,
    ) -> (SVector<f64, N>, SMatrix<f64, N, N>) {
        let mut score = SVector::<f64, N>::zeros();
        let mut information = SMatrix::<f64, N, N>::zeros();
        for (level, weight) in self.levels[finest..].iter_mut().zip([1.0, S::COARSER]) {
            level.pass(surface, at);
            for column in 0..level.cells.columns {
                let (own_score, own_information) = parameters(level, column, surface, at);
                score += weight * own_score;
                information += weight * own_information;
            }
        }
        score *= S::TEMPER;
        information *= S::TEMPER * CURVATURE;
        for k in 0..N {
            let weight = prior.sigma[k].powi(-2);
            score[k] -= weight * (at[k] - prior.mean[k]);
            information[(k, k)] += weight;
        }
        (score, information)
    }
}

/// Score and information of the parameters in a column, by the chain rule from dlnP/dx.
fn parameters<const N: usize>(
    level: &Level,
    column: usize,
    surface: &impl HeightField<N>,
    at: &[f64; N],
) -> (SVector<f64, N>, SMatrix<f64, N, N>) {
    let Sums {
        score, information, ..
    } = level.sums[column];
    let [psi_g, psi_gx] = score.map(f64::from);
    let [gg, ggx, ggxx] = information.map(f64::from);
    let derivatives = surface.height(at, f64::from(level.cells.lateral(column))).1;
    let per_height = level.per_height(at[N - 1]);
    // dx of a cell: by the height, and −x by l.
    let height = SVector::from(derivatives) * per_height;
    let mut focus = SVector::<f64, N>::zeros();
    focus[N - 1] = -1.0;
    let own_score = height * psi_g + focus * psi_gx;
    let cross = height * focus.transpose() * ggx;
    let own = height * height.transpose() * gg + cross + cross.transpose() + focus * focus.transpose() * ggxx;
    (own_score, own)
}
