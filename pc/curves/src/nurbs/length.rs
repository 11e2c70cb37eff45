//! Arc length, and the parameter at a length (mathematics 3.5), by adaptive Gauss–Legendre quadrature.

use super::curve::{Curve, spans};
use heapless::Vec;

/// Nodes above 0 and weights of the 8-point rule on [−1, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// Halvings of a span. At a point without tangent, the worst there is, 20 reach the tolerance.
const DEPTH: usize = 40;

/// Error allowed in an interval, of its own length and of the whole. That of the halves is far smaller.
const RELATIVE: f64 = 1e-10;
const OF_WHOLE: f64 = 1e-12;

/// What halving an interval divides the error of the 8-point rule by, at most: its order is 16.
///
/// Two values of an integrand that the points do not resolve yet can agree by chance; then the error of the interval
/// around it is larger than this times what is allowed.
const GAIN_OF_HALVING: f64 = 65536.0;

/// Rounding of a length, of the coordinates: where control points coincide there is nothing else.
const ROUNDING: f64 = 1e-13;

/// Intervals of a span. A point without tangent takes 100; the rest is for numbers out of all proportion.
const INTERVALS: usize = 5000;

/// Newton steps towards a length; halving alone would take as many.
const ITERATIONS: usize = 60;

/// ∫|C′|du of one interval by one rule.
fn gauss<C: Curve>(curve: &C, from: f64, to: f64) -> f64 {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    let speed = |x: f64| curve.at(middle + half * x).first.norm();
    let sum: f64 = GAUSS.iter().map(|&(x, w)| w * (speed(x) + speed(-x))).sum();
    sum * half
}

/// As [`length_between`], within one smooth stretch.
fn span_length<C: Curve>(curve: &C, from: f64, to: f64) -> f64 {
    let whole = gauss(curve, from, to);
    let rounding = ROUNDING * (curve.point(from).norm() + curve.point(to).norm());
    let (mut sum, mut intervals) = (0.0, 0);
    // An interval, its length by one rule, the error of the interval that it is half of, and how often that was halved.
    let mut stack: Vec<(f64, f64, f64, f64, usize), { DEPTH + 1 }> = Vec::new();
    let mut next = Some((from, to, whole, f64::INFINITY, 0));
    while let Some((from, to, coarse, error_before, depth)) = next {
        let middle = (from + to) / 2.0;
        let halves = [gauss(curve, from, middle), gauss(curve, middle, to)];
        let fine = halves[0] + halves[1];
        let allowed = RELATIVE * fine + OF_WHOLE * whole + rounding;
        intervals += 1;
        let error = libm::fabs(fine - coarse);
        let settled = error <= allowed && error_before <= GAIN_OF_HALVING * allowed;
        let split = !settled && depth < DEPTH && intervals < INTERVALS;
        // The stack has a place for each depth, so this always finds one.
        if split && stack.push((middle, to, halves[1], error, depth + 1)).is_ok() {
            next = Some((from, middle, halves[0], error, depth + 1));
        } else {
            sum += fine;
            next = stack.pop();
        }
    }
    sum
}

/// Arc length \[mm\] between two parameters, which are clamped to the domain; to 1e-9 of itself. Zero if `to`
/// is not after `from`.
pub fn length_between<C: Curve>(curve: &C, from: f64, to: f64) -> f64 {
    spans(curve, from, to)
        .map(|[a, b]| span_length(curve, a, b))
        .sum()
}

/// Arc length \[mm\] of all of `curve`; to 1e-9 of itself.
pub fn length<C: Curve>(curve: &C) -> f64 {
    let [from, to] = curve.domain();
    length_between(curve, from, to)
}

/// The parameter a `distance` \[mm\] of arc length after the parameter `from`, to 1e-10 of the length of the
/// span it lies in. Not before `from`, and not beyond the end of the domain.
pub fn parameter_at_length<C: Curve>(curve: &C, from: f64, distance: f64) -> f64 {
    let mut left = distance;
    for [begin, end] in spans(curve, from, f64::INFINITY) {
        let span = span_length(curve, begin, end);
        if left < span {
            return within(curve, [begin, end], span, libm::fmax(left, 0.0));
        }
        left -= span;
    }
    let [first, last] = curve.domain();
    if distance > 0.0 {
        last
    } else {
        libm::fmin(libm::fmax(from, first), last)
    }
}

/// The parameter a `distance` below `length` after the start of one smooth stretch of that length: Newton,
/// and the middle of the bracket wherever Newton leaves it.
fn within<C: Curve>(curve: &C, [begin, end]: [f64; 2], length: f64, distance: f64) -> f64 {
    // Everything is measured from `low`, which `behind` is the length up to: the rest gets short and cheap.
    let (mut low, mut high, mut behind) = (begin, end, 0.0);
    let mut u = begin + (end - begin) * (distance / length);
    for _ in 0..ITERATIONS {
        let reached = behind + span_length(curve, low, u);
        let error = reached - distance;
        if libm::fabs(error) <= 1e-10 * length {
            break;
        }
        if error < 0.0 {
            (low, behind) = (u, reached);
        } else {
            high = u;
        }
        let newton = u - error / curve.at(u).first.norm();
        u = if low < newton && newton < high {
            newton
        } else {
            (low + high) / 2.0
        };
    }
    u
}
