//! A circle that two axes make, judged as in a circular test (ISO 230-4).

use nalgebra::{Matrix3, Vector3};
use std::ops::RangeInclusive;

/// Where axes turn round on a circle, from the first axis to the second \[°\].
pub const REVERSALS_DEG: [f64; 4] = [0.0, 90.0, 180.0, 270.0];
/// Way after a reversal in which its spike is looked for, and ways before and behind it between which it stands \[°\].
const SPIKE_DEG: RangeInclusive<f64> = -2.0..=10.0;
const BEFORE_DEG: RangeInclusive<f64> = -10.0..=-2.0;
const BEHIND_DEG: RangeInclusive<f64> = 10.0..=18.0;
/// Steps of the search for the centre.
const STEPS: usize = 4;

/// One whole turn in one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turn {
    /// Programmed radius \[mm\].
    pub radius_mm: f64,
    /// The way it goes round: from the first axis to the second, or back.
    pub backwards: bool,
    /// Places of the tool from the programmed centre, in their order \[mm\].
    pub places: Vec<[f64; 2]>,
}

/// What a turn shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnFigures {
    /// Farthest from the programmed circle \[mm\].
    pub contour_mm: f64,
    /// Circular deviation G: between the largest and the smallest distance from the least-squares centre \[mm\].
    pub circular_mm: f64,
    /// Mean distance from that centre, less the programmed radius \[mm\].
    pub radius_mm: f64,
    /// At each of [`REVERSALS_DEG`]: farthest behind the reversal from the straight line between what is before and what comes
    /// later, outwards positive \[mm\].
    pub spikes_mm: [f64; 4],
}

impl Turn {
    /// Angle from the first axis towards the second \[°\], 0…360, and distance from the programmed circle \[mm\].
    pub fn course(&self) -> impl Iterator<Item = (f64, f64)> {
        self.places.iter().map(|[x, y]| {
            let angle = y.atan2(*x).to_degrees().rem_euclid(360.0);
            (angle, x.hypot(*y) - self.radius_mm)
        })
    }

    /// Its figures; `None` if it has a gap.
    pub fn figures(&self) -> Option<TurnFigures> {
        let centre = centre(&self.places);
        let distances = distances(&self.places, centre);
        let mut spikes_mm = [0.0; 4];
        for (spike, at) in spikes_mm.iter_mut().zip(REVERSALS_DEG) {
            *spike = self.spike(at)?;
        }
        Some(TurnFigures {
            contour_mm: self.course().map(|(_, off)| off.abs()).fold(0.0, f64::max),
            circular_mm: range(distances.iter().copied()),
            radius_mm: distances.iter().sum::<f64>() / distances.len() as f64 - self.radius_mm,
            spikes_mm,
        })
    }

    /// The spike behind a reversal at this angle.
    fn spike(&self, at_deg: f64) -> Option<f64> {
        let around = self.course().map(|(angle, off)| {
            let behind = (angle - at_deg + 540.0).rem_euclid(360.0) - 180.0;
            (if self.backwards { -behind } else { behind }, off)
        });
        let around: Vec<_> = around.collect();
        let within = |way: &RangeInclusive<f64>| {
            let way = way.clone();
            around.iter().filter(move |(behind, _)| way.contains(behind))
        };
        let mean = |way: &RangeInclusive<f64>| {
            let count = within(way).count() as f64;
            let sum = within(way).fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x, sum.1 + y));
            (count > 0.0).then_some((sum.0 / count, sum.1 / count))
        };
        let (from, to) = (mean(&BEFORE_DEG)?, mean(&BEHIND_DEG)?);
        let slope = (to.1 - from.1) / (to.0 - from.0);
        let off = within(&SPIKE_DEG).map(|(x, y)| y - from.1 - slope * (x - from.0));
        off.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}

/// Circular deviation G(b) of turns in both directions, about the centre of all of them \[mm\].
pub fn bidirectional_mm(turns: &[Turn; 2]) -> f64 {
    let all: Vec<_> = turns
        .iter()
        .flat_map(|turn| turn.places.iter().copied())
        .collect();
    range(distances(&all, centre(&all)).into_iter())
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
        (least.min(value), most.max(value))
    });
    most - least
}

fn distances(places: &[[f64; 2]], centre: [f64; 2]) -> Vec<f64> {
    let from = |place: &[f64; 2]| (place[0] - centre[0]).hypot(place[1] - centre[1]);
    places.iter().map(from).collect()
}

/// Of the circle with the least squares of the distances from it.
fn centre(places: &[[f64; 2]]) -> [f64; 2] {
    let mut centre = [0.0; 2];
    for _ in 0..STEPS {
        // A centre that is off by e, and a radius by r, make the distance at the angle φ longer by r + e·(cos φ, sin φ).
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for [x, y] in places {
            let [x, y] = [x - centre[0], y - centre[1]];
            let distance = x.hypot(y);
            let row = Vector3::new(1.0, x / distance, y / distance);
            normal += row * row.transpose();
            right += row * distance;
        }
        let Some(found) = normal.lu().solve(&right) else {
            break;
        };
        centre = [centre[0] + found.y, centre[1] + found.z];
    }
    centre
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A turn whose distance from a centre is the radius and `off` at each angle [°].
    fn turn(backwards: bool, centre: [f64; 2], off: impl Fn(f64) -> f64) -> Turn {
        let place = |k: i32| {
            let part = f64::from(k) / 3600.0;
            let angle = TAU * if backwards { 1.0 - part } else { part };
            let distance = 100.0 + off(angle.to_degrees());
            [
                centre[0] + distance * angle.cos(),
                centre[1] + distance * angle.sin(),
            ]
        };
        Turn {
            radius_mm: 100.0,
            backwards,
            // It is not quite closed.
            places: (0..3590).map(place).collect(),
        }
    }

    #[test]
    fn a_circle_beside_its_place_is_round_and_one_that_is_too_small_is_told() {
        let beside = turn(false, [0.03, -0.04], |_| -0.01);
        let figures = beside.figures().expect("a whole turn");
        assert!(figures.circular_mm < 1e-6, "{figures:?}");
        assert!((figures.radius_mm + 0.01).abs() < 1e-5, "{figures:?}");
        assert!((figures.contour_mm - 0.06).abs() < 1e-4, "{figures:?}");
        assert!(
            figures.spikes_mm.iter().all(|spike| spike.abs() < 0.002),
            "{figures:?}"
        );
    }

    #[test]
    fn a_spike_is_found_behind_its_reversal_in_either_direction() {
        for backwards in [false, true] {
            // Behind 90°, wherever that is.
            let spike = move |angle: f64| {
                let behind = if backwards { 90.0 - angle } else { angle - 90.0 };
                if (0.0..4.0).contains(&behind) { 0.007 } else { 0.0 }
            };
            let seen = turn(backwards, [0.0; 2], spike);
            let figures = seen.figures().expect("a whole turn");
            println!("{figures:?}");
            for (k, found) in figures.spikes_mm.iter().enumerate() {
                let truth = if k == 1 { 0.007 } else { 0.0 };
                assert!((found - truth).abs() < 1e-5, "{figures:?}");
            }
            assert!((figures.circular_mm - 0.007).abs() < 2e-4, "{figures:?}");
        }
    }

    #[test]
    fn play_shows_between_both_directions() {
        let turns = [turn(false, [0.0; 2], |_| 0.004), turn(true, [0.0; 2], |_| -0.002)];
        assert!((bidirectional_mm(&turns) - 0.006).abs() < 1e-6);
    }

    #[test]
    fn a_turn_with_a_gap_has_no_figures() {
        let mut seen = turn(false, [0.0; 2], |_| 0.0);
        seen.places.truncate(2600);
        assert_eq!(seen.figures(), None);
    }
}
