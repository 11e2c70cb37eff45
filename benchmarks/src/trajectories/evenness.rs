//! How evenly a curve is gone along where the speed is constant.

use super::TICK;
use super::contour::Contour;
use super::run::Sample;
use super::way::{Move, Way};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use shared::trajectory::Element;

/// Steps of path length that differ less from the one asked for, as a part of it, are of constant speed, ...
const CONSTANT: f64 = 1e-7;
/// ... if those of so many ticks before and after are too.
const AROUND: usize = 20;

/// Largest deviations of the speed along a curve from the one asked for, as parts of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evenness {
    /// Of the interpolator: the elements, a tick after the other at the feed, over all of the curve.
    pub interpolator: f64,
    /// Of the outputs, which are filtered, where the feed is kept: of the way along the curve.
    pub output: f64,
    /// Of the true tip: of the distance from one of those outputs to the next, on whatever way it is.
    pub tip: f64,
    /// How many outputs those are.
    pub outputs: usize,
}

/// Of the one curve in `moves`, which `elements` are of, gone along as `samples` say.
pub fn evenness(moves: &[Move], elements: &[Element], samples: &[Sample]) -> Option<Evenness> {
    let [
        Move {
            feed,
            way: Way::FreeForm(_),
            ..
        },
    ] = moves
    else {
        return None;
    };
    let step = feed * TICK;
    let contour = Contour::new(moves);
    let deviation = |(from, s): (Vector3<f64>, f64), to: Vector3<f64>| {
        let at = |point, s| contour.nearest(&point, s, step).s;
        ((at(to, s + step) - at(from, s)) / step - 1.0).abs()
    };
    let points: Vec<_> = at_intervals(elements, step).collect();
    let interpolator = points
        .windows(2)
        .map(|two| deviation(two[0], two[1].0))
        .fold(0.0, f64::max);
    let constant = |i: &usize| {
        let around = i - AROUND..i + AROUND;
        around
            .map(|i| samples.get(i..i + 2))
            .all(|two| two.is_some_and(|two| ((two[1].s - two[0].s) / step - 1.0).abs() < CONSTANT))
    };
    let point = |sample: &Sample| Vector3::from_row_slice(&sample.axes[..3]);
    let mut even = Evenness {
        interpolator,
        output: 0.0,
        tip: 0.0,
        outputs: 0,
    };
    for i in (AROUND..samples.len()).filter(constant) {
        let [from, to] = [point(&samples[i]), point(&samples[i + 1])];
        even.outputs += 1;
        even.output = even.output.max(deviation((from, samples[i].s), to));
        even.tip = even.tip.max(((to - from).norm() / step - 1.0).abs());
    }
    Some(even)
}

/// Points of `elements` at multiples of `step` \[mm\], and these.
fn at_intervals(elements: &[Element], step: f64) -> impl Iterator<Item = (Vector3<f64>, f64)> + '_ {
    let mut begin = 0.0;
    let mut count = 0.0;
    elements.iter().flat_map(move |element| {
        let mut points = Vec::new();
        while count * step < begin + element.length {
            let value = element.at(count * step - begin).value;
            points.push((Vector3::new(value[0], value[1], value[2]), count * step));
            count += 1.0;
        }
        begin += element.length;
        points
    })
}

#[cfg(test)]
mod tests {
    use super::super::{elements::elements, free_form};
    use super::*;
    use shared::io::AXES;

    const CURVE: &str = r#"{"degree": 3, "control_points": [[0, 0, 0], [10, 30, 0], [30, -10, 5], [40, 10, 0], [60, 0, 0]],
        "weights": [1, 2, 1, 3, 1], "knots": [0, 0, 0, 0, 0.3, 1, 1, 1, 1]}"#;

    #[test]
    fn a_curve_gone_along_by_its_length_is_even_and_an_offset_is_not() {
        let moves = free_form::read(CURVE, 50.0).expect("a curve");
        let elements = elements(&moves).expect("elements");
        let on_curve = |off: f64| -> Vec<Sample> {
            at_intervals(&elements, 0.05)
                .map(|(point, s)| {
                    let mut axes = [0.0; AXES];
                    axes[..3].copy_from_slice((point + Vector3::y() * off).as_slice());
                    Sample { axes, s, pushed: 0 }
                })
                .collect()
        };
        let evenness = |samples: &[Sample]| super::evenness(&moves, &elements, samples).expect("a curve");
        let samples = on_curve(0.0);
        let even = evenness(&samples);
        assert!(even.interpolator > 0.0 && even.interpolator < 1e-6, "{even:?}");
        assert!(even.output < 1e-6, "{even:?}");
        // A chord is shorter than its arc: of 0.05 mm on a radius of 2.3 mm, the sharpest, by 2e-5.
        assert!(even.tip > 1e-5 && even.tip < 3e-5, "{even:?}");
        assert_eq!(even.outputs, samples.len() - 2 * AROUND);
        let off = evenness(&on_curve(0.1));
        assert!(
            off.output > 1e-3 && off.interpolator == even.interpolator,
            "{off:?}"
        );
        // On a way that is shorter by a thousandth.
        let slower: Vec<Sample> = samples
            .iter()
            .map(|sample| Sample {
                axes: sample.axes.map(|axis| 0.999 * axis),
                ..*sample
            })
            .collect();
        let tip = evenness(&slower).tip;
        assert!((tip - 1e-3).abs() < 3e-5, "{tip}");
    }
}
