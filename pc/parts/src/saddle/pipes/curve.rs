//! The closed seam over its length.

use super::closed::{Closed, ROUND};
use super::{Intersection, PipePair, SaddleError, SeamFrame, SeamPoint, Sheet};
use nalgebra::Vector3;
use shared::geometry::Moving;

/// Parts of the round of equal parameter whose lengths are kept. A multiple of 4, so that the corners of
/// tangent pipes, at quarters of the round, lie between parts.
const PARTS: usize = 64;

/// How often a part may be halved to get its length: enough for the sharpest bend of pipes that are almost
/// tangent, to 1e-9 of R.
const HALVINGS: u32 = 24;

/// Steps to find the place of a length.
const STEPS: usize = 60;

/// Part of a length that counts as none.
const FINE: f64 = 1e-14;

/// A closed seam of two pipes over its length s \[mm\], along NB×NA (the plus sheet forward in θ, then the minus
/// sheet backward, where they join). s may be any number: the seam goes round and round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaddleCurve {
    pub(super) pair: PipePair,
    closed: Closed,
    /// Length from the start of the round to the start of every part, and to the end.
    lengths: [f64; PARTS + 1],
}

/// A point of the seam, by its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Place and normals of the walls.
    pub point: SeamPoint,
    /// The groove.
    pub frame: SeamFrame,
    /// Derivative of the tangent over the length \[1/mm\], in M: towards the centre of curvature.
    pub curvature: Vector3<f64>,
}

impl CurvePoint {
    /// Position in M and its derivatives over the length.
    pub fn position(&self) -> Moving {
        Moving {
            value: self.point.main,
            first: self.frame.tangent,
            second: self.curvature,
        }
    }
}

impl PipePair {
    /// A closed seam of this pair. A full meeting has one a sheet, the first at θ = 0. Otherwise the sheets
    /// join, and the seam starts on the plus sheet at its smallest θ; there is a single one, the same for both
    /// values of `sheet`, unless the main pipe passes all through the branch: then [`Sheet::Plus`] is the one
    /// with y_S > 0, [`Sheet::Minus`] the other.
    pub fn curve(&self, sheet: Sheet) -> Result<SaddleCurve, SaddleError> {
        if self.meeting == Intersection::None {
            return Err(SaddleError::Apart {
                offset: libm::fabs(self.offset),
                reach: self.main_radius + self.branch_radius,
            });
        }
        let closed = Closed::of(self, sheet);
        let mut lengths = [0.0; PARTS + 1];
        for i in 0..PARTS {
            lengths[i + 1] = lengths[i] + length_between(self, closed, start_of(i), start_of(i + 1));
        }
        Ok(SaddleCurve {
            pair: *self,
            closed,
            lengths,
        })
    }
}

impl SaddleCurve {
    /// The pipes.
    pub fn pair(&self) -> &PipePair {
        &self.pair
    }

    /// Length of the whole round \[mm\].
    pub fn length(&self) -> f64 {
        self.lengths[PARTS]
    }

    /// The seam at the length `s` \[mm\]. Fails only where the walls touch without crossing.
    pub fn at(&self, s: f64) -> Result<CurvePoint, SaddleError> {
        let [x, w, y] = self.closed.place(&self.pair, self.parameter(s));
        let point = self.pair.seam_point(x, w, y);
        let frame = point.frame()?;
        Ok(CurvePoint {
            point,
            frame,
            curvature: self.pair.curvature(&point, &frame),
        })
    }

    /// u at the length `s`: Newton steps, kept within the part by halving.
    fn parameter(&self, s: f64) -> f64 {
        let whole = self.length();
        let s = s - libm::floor(s / whole) * whole;
        let part = self.lengths[1..PARTS].partition_point(|&length| length <= s);
        let (mut low, mut high) = (start_of(part), start_of(part + 1));
        // Length is kept from `known` on, so that the steps get short with what is left.
        let (mut known, mut left) = (low, s - self.lengths[part]);
        let mut u = low + (high - low) * left / (self.lengths[part + 1] - self.lengths[part]);
        for _ in 0..STEPS {
            left -= length_between(&self.pair, self.closed, known, u);
            known = u;
            if libm::fabs(left) <= FINE * whole {
                break;
            }
            if left > 0.0 {
                low = u;
            } else {
                high = u;
            }
            u += left / self.speed(u);
            if !(low < u && u < high) {
                u = (low + high) / 2.0;
            }
        }
        known
    }

    /// Length from the start of the round to `u` in `0..=ROUND` \[mm\].
    pub(super) fn length_to(&self, u: f64) -> f64 {
        let part = ((u / ROUND * PARTS as f64) as usize).min(PARTS - 1);
        self.lengths[part] + length_between(&self.pair, self.closed, start_of(part), u)
    }

    /// Point in M and its derivative over the parameter.
    pub(super) fn at_parameter(&self, u: f64) -> [Vector3<f64>; 2] {
        self.closed.at(&self.pair, u)
    }

    /// Length of the longest of the parts kept \[mm\].
    pub(super) fn longest_part(&self) -> f64 {
        let parts = self.lengths.windows(2).map(|ends| ends[1] - ends[0]);
        parts.fold(0.0, f64::max)
    }

    fn speed(&self, u: f64) -> f64 {
        self.at_parameter(u)[1].norm()
    }
}

/// Start of part `i` of the round.
fn start_of(i: usize) -> f64 {
    i as f64 * (ROUND / PARTS as f64)
}

/// Length from parameter `a` to `b`, negative if b < a: Gauss–Legendre, halved until it agrees with itself.
fn length_between(pair: &PipePair, closed: Closed, a: f64, b: f64) -> f64 {
    let speed = |u: f64| closed.at(pair, u)[1].norm();
    let none = FINE * (pair.main_radius + pair.branch_radius);
    halved(&speed, [a, b], gauss(&speed, a, b), none, HALVINGS)
}

fn halved(speed: &impl Fn(f64) -> f64, [a, b]: [f64; 2], whole: f64, none: f64, halvings: u32) -> f64 {
    let middle = (a + b) / 2.0;
    let (left, right) = (gauss(speed, a, middle), gauss(speed, middle, b));
    let sum = left + right;
    if halvings == 0 || libm::fabs(sum - whole) <= none {
        return sum;
    }
    halved(speed, [a, middle], left, none, halvings - 1)
        + halved(speed, [middle, b], right, none, halvings - 1)
}

/// Gauss–Legendre rule of 8 points.
fn gauss(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    const RULE: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_361_96),
        (0.525_532_409_916_329, 0.313_706_645_877_887_27),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
    let sum: f64 = RULE
        .iter()
        .map(|(x, weight)| weight * (f(middle - half * x) + f(middle + half * x)))
        .sum();
    sum * half
}
