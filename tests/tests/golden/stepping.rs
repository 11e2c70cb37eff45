//! Steps of equal chord along a curve, and other published rules (mathematics 3.2, 3.5). The machines go along
//! curves over their arc length instead.

use curves::nurbs::Curve;
use nalgebra::Vector3;
use shared::geometry::Moving;

/// Newton steps where time does not matter.
const ITERATIONS: usize = 60;

/// |chord² − ds²| at which a step counts as exact, of ds².
const EXACT: f64 = 2e-10;

/// Chord up to which the end of the curve is one step away, of ds.
const END: f64 = 1.0 + 1e-9;

/// u + ds/|C′|.
pub fn taylor_1<C: Curve>(curve: &C, u: f64, ds: f64) -> f64 {
    u + ds / curve.at(u).first.norm()
}

/// u + ds/|C′| − ds²·(C′·C″)/(2|C′|⁴).
pub fn taylor_2<C: Curve>(curve: &C, u: f64, ds: f64) -> f64 {
    second_order(&curve.at(u), u, ds)
}

fn second_order(at: &Moving, u: f64, ds: f64) -> f64 {
    let speed = at.first.norm();
    let part = ds / speed;
    u + part - part * part * (at.first.dot(&at.second) / (2.0 * speed * speed))
}

/// The next parameter whose chord from `u` is `ds`, or the end if it is nearer: Taylor-2 with Newton steps on
/// |C(u) − C(u₀)|² = ds² after it, halving where Newton leaves the bracket between u₀ and the end.
pub fn newton_step<C: Curve>(curve: &C, u: f64, ds: f64) -> f64 {
    let [_, end] = curve.domain();
    let start = curve.at(u);
    let straight = u + ds / start.first.norm();
    // The chord alone would end a closed curve at its start.
    if straight >= end && (curve.point(end) - start.value).norm() <= ds * END {
        return end;
    }
    let (mut low, mut high) = (u, end);
    let predicted = second_order(&start, u, ds);
    let mut x = if predicted > u { predicted } else { straight };
    if !(low < x && x < high) {
        x = (low + high) / 2.0;
    }
    for _ in 0..ITERATIONS {
        let at = curve.at(x);
        let chord = at.value - start.value;
        let (f, slope) = (chord.norm_squared() - ds * ds, 2.0 * chord.dot(&at.first));
        if f.abs() <= EXACT * ds * ds {
            break;
        }
        if f > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let next = x - f / slope;
        x = if low < next && next < high {
            next
        } else {
            (low + high) / 2.0
        };
    }
    x
}

/// The parameters of a walk along a curve by [`newton_step`], from its start to its end, both included; the last step
/// is what is left.
pub fn walk<C: Curve>(curve: &C, ds: f64) -> Vec<f64> {
    let [first, end] = curve.domain();
    let mut walk = vec![first];
    let mut u = first;
    while u < end {
        let next = newton_step(curve, u, ds);
        assert!(next > u, "no way ahead at parameter {u}");
        u = next.min(end);
        walk.push(u);
    }
    walk
}

/// Radius \[mm\] of the circle through three points on the curve, by the height of the middle one above the
/// chord of the others; infinite if they lie on a line.
pub fn chord_height_radius(points: [Vector3<f64>; 3]) -> f64 {
    let chord = points[2] - points[0];
    let to_middle = points[1] - points[0];
    let length = chord.norm();
    let height = (to_middle - chord * (to_middle.dot(&chord) / (length * length))).norm();
    if height < 1e-15 * length {
        f64::INFINITY
    } else {
        length * length / (8.0 * height) + height / 2.0
    }
}

/// Nodes above 0 and weights of the 8-point Gauss–Legendre rule on [−1, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// Arc length \[mm\] of all of `curve` by 8 evaluations in each of the `parts` that every smooth stretch is cut into.
pub fn length_in_parts<C: Curve>(curve: &C, parts: u32) -> f64 {
    let [mut from, end] = curve.domain();
    let mut sum = 0.0;
    while from < end {
        let to = curve.next_break(from).min(end);
        let half = (to - from) / f64::from(parts) / 2.0;
        for i in 0..parts {
            let middle = from + half * f64::from(2 * i + 1);
            let speed = |x: f64| curve.at(middle + half * x).first.norm();
            let rule = GAUSS.iter().map(|&(x, w)| w * (speed(x) + speed(-x)));
            sum += rule.sum::<f64>() * half;
        }
        from = to;
    }
    sum
}
