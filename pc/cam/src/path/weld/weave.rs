//! A swing across a seam, over its length.

use config::weld_data::{Weave, WeaveForm};
use std::f64::consts::PI;

/// A stretch of the seam on which the tip goes from one side to the other, or along one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// From and to this place of the seam \[mm\].
    pub(super) seam: [f64; 2],
    /// From and to so far to the left \[mm\].
    pub(super) aside: [f64; 2],
    form: WeaveForm,
}

impl Stretch {
    /// Along the seam, nowhere aside.
    pub(super) fn along(from: f64, to: f64) -> Self {
        Self {
            seam: [from, to],
            aside: [0.0; 2],
            form: WeaveForm::Triangle,
        }
    }

    /// How far to the left at `s` \[mm\], and its slope.
    pub(super) fn at(&self, s: f64) -> [f64; 2] {
        let [from, to] = self.seam;
        let [start, end] = self.aside;
        let part = (s - from) / (to - from);
        let (height, length) = (end - start, to - from);
        match self.form {
            WeaveForm::Triangle => [start + height * part, height / length],
            WeaveForm::Sine => [
                start + height * (1.0 - libm::cos(PI * part)) / 2.0,
                height / length * PI / 2.0 * libm::sin(PI * part),
            ],
        }
    }
}

/// The stretches of a `weave` along a seam of `length` \[mm\] that is gone at `speed` \[mm/s\]: from its middle to the left first,
/// back to the middle at the end. Its period is stretched or shortened a little so that whole halves of it fit; `None` where not
/// even one does.
pub(super) fn stretches(weave: &Weave, length: f64, speed: f64) -> Option<Vec<Stretch>> {
    let half = speed / weave.frequency_hz / 2.0;
    let count = (length / half).round();
    if count < 1.0 {
        return None;
    }
    let fitted = length / count;
    let dwell = speed * weave.dwell_s * fitted / half;
    let crossing = fitted - dwell;
    let mut stretches = Vec::with_capacity(2 * count as usize + 1);
    let (mut s, mut aside) = (0.0, 0.0);
    let mut add = |long: f64, to: f64| {
        if long > 0.0 {
            stretches.push(Stretch {
                seam: [s, s + long],
                aside: [aside, to],
                form: weave.form,
            });
        }
        (s, aside) = (s + long, to);
    };
    let mut side = weave.amplitude_mm;
    add(crossing / 2.0, side);
    add(dwell, side);
    for _ in 1..count as usize {
        side = -side;
        add(crossing, side);
        add(dwell, side);
    }
    add(crossing / 2.0, 0.0);
    Some(stretches)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weave(form: WeaveForm, dwell_s: f64) -> Weave {
        Weave {
            form,
            amplitude_mm: 2.0,
            frequency_hz: 1.0,
            dwell_s,
        }
    }

    #[test]
    fn whole_halves_fit_the_seam_and_it_begins_and_ends_in_the_middle() {
        for (form, dwell_s) in [
            (WeaveForm::Sine, 0.0),
            (WeaveForm::Triangle, 0.1),
            (WeaveForm::Sine, 0.2),
        ] {
            for length in [10.0, 47.3, 100.0] {
                let stretches = stretches(&weave(form, dwell_s), length, 8.0).unwrap();
                let (first, last) = (stretches[0], stretches[stretches.len() - 1]);
                assert_eq!((first.seam[0], first.aside[0], last.aside[1]), (0.0, 0.0, 0.0));
                assert!((last.seam[1] - length).abs() < 1e-9);
                for pair in stretches.windows(2) {
                    assert_eq!(
                        (pair[0].seam[1], pair[0].aside[1]),
                        (pair[1].seam[0], pair[1].aside[0])
                    );
                }
                let sides = stretches.iter().filter(|stretch| stretch.aside[1].abs() == 2.0);
                let along: f64 = stretches
                    .iter()
                    .filter(|stretch| stretch.aside[0] == stretch.aside[1])
                    .map(|stretch| stretch.seam[1] - stretch.seam[0])
                    .sum();
                // 4 mm to half a period, give or take the fit.
                assert!(
                    ((along / length) - 2.0 * dwell_s).abs() < 0.01,
                    "{along} of {length}"
                );
                assert!(sides.count() >= (length / 4.0) as usize);
            }
        }
    }

    #[test]
    fn slopes_are_those_of_the_places_and_a_sine_has_none_at_its_sides() {
        for form in [WeaveForm::Sine, WeaveForm::Triangle] {
            for stretch in stretches(&weave(form, 0.1), 20.0, 8.0).unwrap() {
                let [from, to] = stretch.seam;
                for part in [0.2, 0.5, 0.7] {
                    let s = from + (to - from) * part;
                    let [[left, _], [right, _]] = [s - 1e-5, s + 1e-5].map(|s| stretch.at(s));
                    assert!((stretch.at(s)[1] - (right - left) / 2e-5).abs() < 1e-6);
                }
                if form == WeaveForm::Sine {
                    assert!(stretch.at(from)[1].abs() < 1e-12 && stretch.at(to)[1].abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_seam_shorter_than_half_a_period_is_none() {
        assert_eq!(stretches(&weave(WeaveForm::Sine, 0.0), 1.5, 8.0), None);
    }
}
