//! The closed seams of two pipes over a parameter that continues evenly all around.

use super::{Intersection, PipePair, Sheet, TANGENT};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// The parameter u of a closed seam goes from 0 to this.
pub const ROUND: f64 = TAU;

/// What u means. All three go along NB×NA: on the plus sheet θ grows, on the minus sheet it falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Closed {
    /// The seam goes once around the branch: u is ±θ. With the sign of y_M.
    AroundBranch(f64),
    /// The seam goes once around the main pipe: u is ± the angle about Z_M. With the sign of y_S.
    AroundMain(f64),
    /// The seam goes around neither: both y_M and y_S change sign once in a round. With the sign of x at
    /// the rim of the main pipe, where it starts on the plus sheet.
    Aside(f64),
}

impl Closed {
    /// The closed seam of `pair` on `sheet`; where a partial meeting has two, that with y_S of this sign.
    pub fn of(pair: &PipePair, sheet: Sheet) -> Self {
        let (beside, main, branch) = (libm::fabs(pair.offset), pair.main_radius, pair.branch_radius);
        if pair.meeting == Intersection::Full {
            Self::AroundBranch(sheet.sign())
        } else if branch - beside > main * (1.0 + TANGENT) {
            Self::AroundMain(sheet.sign())
        } else {
            Self::Aside(libm::copysign(1.0, pair.offset))
        }
    }

    /// x_M, y_M and y_S at `u`, and their derivatives over u.
    fn coordinates(self, pair: &PipePair, u: f64) -> [[f64; 3]; 2] {
        let (main, branch, offset) = (pair.main_radius, pair.branch_radius, pair.offset);
        match self {
            Self::AroundBranch(sign) => {
                // With half angles R ± x keep their digits where the rims are near.
                let (sin, cos) = libm::sincos(u / 2.0);
                let (sin_2, cos_2) = (2.0 * branch * sin * sin, 2.0 * branch * cos * cos);
                let (x, x_1) = (offset + (cos_2 - sin_2) / 2.0, -2.0 * branch * sin * cos);
                let w =
                    sign * libm::sqrt((main - offset - branch + sin_2) * (main + offset - branch + cos_2));
                [[x, w, -sign * x_1], [x_1, -x * x_1 / w, sign * (x - offset)]]
            }
            Self::AroundMain(sign) => {
                let (sin, cos) = libm::sincos(u / 2.0);
                let (sin_2, cos_2) = (2.0 * main * sin * sin, 2.0 * main * cos * cos);
                let (x, x_1) = ((cos_2 - sin_2) / 2.0, -2.0 * main * sin * cos);
                let y =
                    sign * libm::sqrt((branch + offset - main + sin_2) * (branch - offset - main + cos_2));
                [[x, -sign * x_1, y], [x_1, sign * x, -(x - offset) * x_1 / y]]
            }
            Self::Aside(side) => {
                // x runs between the rims, y_M² = (R−x)(R+x) and y_S² = (r+x−δ)(r−x+δ). The first factor of
                // each is a square that passes through zero at a rim; its root changes sign there.
                let (sin, cos) = libm::sincos(u);
                let offset = side * offset;
                let span = main + branch - offset;
                let x = main - span * sin * sin;
                let x_1 = -2.0 * span * sin * cos;
                let root = libm::sqrt(span);
                // Below zero by rounding only.
                let far = |square: f64, slope: f64| {
                    let far = libm::sqrt(square.max(0.0));
                    (far, if far > 0.0 { slope / (2.0 * far) } else { 0.0 })
                };
                let (w_far, w_far_1) = far((main - branch + offset) + span * cos * cos, x_1);
                let (y_far, y_far_1) = far((branch + offset - main) + span * sin * sin, -x_1);
                let (w, y) = (root * sin * w_far, root * cos * y_far);
                let w_1 = root * (cos * w_far + sin * w_far_1);
                let y_1 = root * (cos * y_far_1 - sin * y_far);
                [[side * x, w, side * y], [side * x_1, w_1, side * y_1]]
            }
        }
    }

    /// x_M, y_M and y_S at `u`.
    pub fn place(self, pair: &PipePair, u: f64) -> [f64; 3] {
        self.coordinates(pair, u)[0]
    }

    /// The point in M at `u` and its derivative over u.
    pub fn at(self, pair: &PipePair, u: f64) -> [Vector3<f64>; 2] {
        self.coordinates(pair, u)
            .map(|[x, w, y]| pair.main_direction(x, w, y))
    }
}
