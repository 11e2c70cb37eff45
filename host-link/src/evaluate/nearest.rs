//! The place of a path nearest to the tip.

use cam::path::Course;
use nalgebra::Vector3;

/// The place nearest to the tip is known this well \[mm\].
const NEAREST: f64 = 1e-9;
/// Steps of the search for it.
const STEPS: usize = 50;

/// A place of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) s_mm: f64,
    pub(super) distance_mm: f64,
}

/// The place of `path` nearest to `tip`, searched from path position `s` on \[mm\]. Beyond its ends a path has no
/// points.
pub(super) fn nearest(path: &Course, tip: &Vector3<f64>, s: f64) -> Option<Nearest> {
    let (start, end) = (path.start_s()?, path.end_s()?);
    let mut s = s.clamp(start, end);
    // Outside of a corner the search goes to and fro between its sides.
    let (mut damped, mut last) = (1.0, 0.0);
    let mut nearest = Nearest {
        s_mm: s,
        distance_mm: f64::INFINITY,
    };
    for _ in 0..STEPS {
        let point = path.at(s)?;
        let place = |channels: &[f64]| Vector3::from_column_slice(&channels[..3]);
        let (apart, slope) = (tip - place(&point.value), place(&point.first));
        let here = Nearest {
            s_mm: s,
            distance_mm: apart.norm(),
        };
        if here.distance_mm < nearest.distance_mm {
            nearest = here;
        }
        let mut step = damped * apart.dot(&slope) / slope.norm_squared();
        if step * last < 0.0 {
            damped *= 0.5;
            step *= 0.5;
        }
        last = step;
        let next = (s + step).clamp(start, end);
        if next.is_nan() || (next - s).abs() < NEAREST {
            return Some(here);
        }
        s = next;
    }
    (damped < 1.0).then_some(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::seams::tests::{bent_path, wavy_seam};

    #[test]
    fn contour_error_is_the_distance_from_the_nearest_place_of_the_path() {
        let (path, seam) = (Course::Knots(bent_path()), wavy_seam());
        let (pose, _) = seam.planned(200.0).unwrap();
        let slope = path.at(200.0).unwrap().first;
        let along = Vector3::new(slope[0], slope[1], slope[2]).normalize();
        let across = along.cross(&Vector3::z()).normalize();
        let tip = pose.position + across * 0.03 + along.cross(&across) * 0.04;
        let error = nearest(&path, &tip, 203.0).unwrap().distance_mm;
        assert!((error - 0.05).abs() < 1e-6, "{error}");
        let (end, _) = seam.planned(500.0).unwrap();
        let slope = path.at(500.0).unwrap().first;
        let beyond = end.position + Vector3::new(slope[0], slope[1], slope[2]).normalize() * 0.07;
        let error = nearest(&path, &beyond, 500.0).unwrap().distance_mm;
        assert!((error - 0.07).abs() < 1e-6, "{error}");
    }
}
