//! Photon transfer: how the noise of a pixel grows with its level.

use super::least_squares::LeastSquares;
use crate::image::Image;
use crate::noise::PhotonTransfer;
use thiserror::Error;

/// Levels of pixels that count: below, rounding is no noise; above, a pixel may be saturated.
const USABLE: [f64; 2] = [8.0, 245.0];

/// Fewest levels, and how far apart they have to be \[steps of 8 bits\].
const FEWEST_LEVELS: usize = 3;
const APART: f64 = 15.0;

/// How much brighter the brightest level has to be than the darkest.
const SPREAD: f64 = 2.5;

/// Share of the pixels of a picture that has to be usable.
const SHARE: f64 = 0.5;

/// Largest change of the light within a pair, as a share.
const LIGHT: f64 = 0.02;

/// Largest correlation of the differences of neighbouring pixels: noise has none.
const CORRELATION: f64 = 0.03;

/// Differences beyond so many standard deviations are no noise.
const CLIP: f64 = 4.5;

/// Largest deviation of a level's variance from the line, as a share.
const BENT: f64 = 0.05;

/// One level of a photon transfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferLevel {
    /// Mean \[steps of 8 bits\].
    pub mean: f64,
    /// Variance of a pixel, from the differences of two equal pictures \[steps squared\].
    pub variance: f64,
}

/// A photon transfer and how well it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFit {
    /// The photon transfer.
    pub transfer: PhotonTransfer,
    /// The levels it goes through, in the order of the pairs.
    pub levels: Vec<TransferLevel>,
    /// Largest deviation of a level's variance from it, as a share of the variance.
    pub worst: f64,
}

/// Why pictures give no photon transfer. Pairs count from 1.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TransferError {
    /// The two pictures are not of the same size.
    #[error("the pictures of pair {pair} are not of the same size")]
    Size {
        /// Which pair.
        pair: usize,
    },
    /// Too few pixels are neither black nor saturated.
    #[error(
        "pair {pair} is {fault}: only {usable:.0} % of its pixels lie between levels 8 and 245; take it with {remedy}"
    )]
    Light {
        /// Which pair.
        pair: usize,
        /// Dark or saturated.
        fault: &'static str,
        /// Usable pixels \[%\].
        usable: f64,
        /// What to do.
        remedy: &'static str,
    },
    /// The light was not the same in both.
    #[error(
        "the light changed by {percent:.1} % within pair {pair} (may be 2.0 %): take both in the same light"
    )]
    Flicker {
        /// Which pair.
        pair: usize,
        /// By how much \[%\].
        percent: f64,
    },
    /// Something moved.
    #[error(
        "something moved within pair {pair}: neighbouring pixels differ alike (correlation {correlation:.2}, may be 0.03); take both pictures at rest"
    )]
    Moved {
        /// Which pair.
        pair: usize,
        /// Of neighbouring differences.
        correlation: f64,
    },
    /// Not enough different levels.
    #[error(
        "{found} different levels of light, from {darkest:.0} to {brightest:.0}: at least 3 are needed, 15 apart, the brightest 2.5 times the darkest"
    )]
    Levels {
        /// Levels at least 15 apart.
        found: usize,
        /// Lowest mean.
        darkest: f64,
        /// Highest mean.
        brightest: f64,
    },
    /// The variance does not grow with the level as photons make it.
    #[error(
        "the noise does not grow with the light as that of counted photons: at level {mean:.0} its variance is {variance:.3} instead of {expected:.3} (may be off by 5 %); switch gamma, gain control and sharpening of the camera off"
    )]
    Bent {
        /// Level where it is worst.
        mean: f64,
        /// Variance there.
        variance: f64,
        /// What the line has there.
        expected: f64,
    },
}

/// Full well and read noise from pairs of equal pictures at several levels of light: the difference of two pictures has
/// twice the variance of a pixel, whatever they show, and the mean variance is that of the mean level.
pub fn photon_transfer(pairs: &[[Image; 2]]) -> Result<TransferFit, TransferError> {
    let (mut levels, mut pixels) = (Vec::new(), Vec::new());
    for (k, pair) in pairs.iter().enumerate() {
        let (level, count) = level_of(k + 1, pair)?;
        levels.push(level);
        pixels.push(count as f64);
    }
    check_levels(&levels)?;
    let rounding = 1.0 / 12.0;
    let mut line = LeastSquares::<2, 1>::new();
    for (level, pixels) in levels.iter().zip(&pixels) {
        // A variance of n differences scatters by √(2/n) of itself.
        let weight = pixels / (2.0 * level.variance.powi(2));
        line.add([level.mean, 1.0], [level.variance - rounding], weight);
    }
    let bent = |level: &TransferLevel, expected: f64| TransferError::Bent {
        mean: level.mean,
        variance: level.variance,
        expected,
    };
    let found = line.solve().filter(|line| line[0] > 0.0);
    let line = found.ok_or_else(|| bent(&levels[0], 0.0))?;
    let (step, reading) = (line[0], line[1].max(0.0));
    let transfer = PhotonTransfer {
        full_well: 255.0 / step,
        read_noise: reading.sqrt() / step,
    };
    let off = |level: &TransferLevel| (level.variance / transfer.variance(level.mean) - 1.0).abs();
    let worst = levels.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
    let worst = worst.expect("there are levels");
    if off(worst) > BENT {
        return Err(bent(worst, transfer.variance(worst.mean)));
    }
    Ok(TransferFit {
        transfer,
        worst: off(worst),
        levels,
    })
}

/// Mean and variance of a pair, and how many pixels they come from.
fn level_of(pair: usize, [first, second]: &[Image; 2]) -> Result<(TransferLevel, usize), TransferError> {
    let (rows, columns) = (first.rows(), first.columns());
    if (rows, columns) != (second.rows(), second.columns()) {
        return Err(TransferError::Size { pair });
    }
    let usable = |a: u8, b: u8| {
        let level = (f64::from(a) + f64::from(b)) / 2.0;
        (USABLE[0]..USABLE[1]).contains(&level)
    };
    let (mut count, mut sums, mut all) = (0_usize, [0.0; 2], 0.0);
    for row in 0..rows {
        for (&a, &b) in first.row(row).iter().zip(second.row(row)) {
            all += f64::from(a) + f64::from(b);
            if usable(a, b) {
                count += 1;
                sums[0] += f64::from(a);
                sums[1] += f64::from(b);
            }
        }
    }
    let pixels = (rows * columns).max(1) as f64;
    if (count as f64) < SHARE * pixels {
        let dark = all / (2.0 * pixels) < 128.0;
        let (fault, remedy) = if dark {
            ("dark", "more light")
        } else {
            ("saturated", "less light")
        };
        return Err(TransferError::Light {
            pair,
            fault,
            usable: 100.0 * count as f64 / pixels,
            remedy,
        });
    }
    let [a, b] = sums.map(|sum| sum / count as f64);
    let (mean, change) = ((a + b) / 2.0, (a - b) / ((a + b) / 2.0));
    if change.abs() > LIGHT {
        let percent = 100.0 * change.abs();
        return Err(TransferError::Flicker { pair, percent });
    }
    // What is left of a difference when the little more light of one picture is taken away.
    let difference = |a: u8, b: u8| {
        let (a, b) = (f64::from(a), f64::from(b));
        a - b - change * (a + b) / 2.0
    };
    let mut clip = f64::INFINITY;
    let mut level = TransferLevel { mean, variance: 0.0 };
    for _ in 0..4 {
        let (mut squares, mut heard) = (0.0, 0.0);
        let (mut products, mut neighbours) = (0.0, 0.0);
        for row in 0..rows {
            let mut before = None;
            for (&a, &b) in first.row(row).iter().zip(second.row(row)) {
                let d = difference(a, b);
                let here = (usable(a, b) && d.abs() < clip).then_some(d);
                if let Some(d) = here {
                    squares += d * d;
                    heard += 1.0;
                    if let Some(before) = before {
                        products += d * before;
                        neighbours += 1.0;
                    }
                }
                before = here;
            }
        }
        let square: f64 = squares / heard;
        let correlation = products / f64::max(neighbours, 1.0) / square;
        if clip.is_finite() && correlation > CORRELATION {
            return Err(TransferError::Moved { pair, correlation });
        }
        level.variance = square / 2.0;
        clip = CLIP * square.sqrt();
    }
    Ok((level, count))
}

fn check_levels(levels: &[TransferLevel]) -> Result<(), TransferError> {
    let mut means: Vec<f64> = levels.iter().map(|level| level.mean).collect();
    means.sort_by(f64::total_cmp);
    let (mut found, mut last) = (0, f64::NEG_INFINITY);
    for mean in &means {
        if mean - last >= APART {
            found += 1;
            last = *mean;
        }
    }
    let darkest = means.first().copied().unwrap_or_default();
    let brightest = means.last().copied().unwrap_or_default();
    if found < FEWEST_LEVELS || brightest < SPREAD * darkest {
        return Err(TransferError::Levels {
            found,
            darkest,
            brightest,
        });
    }
    Ok(())
}
