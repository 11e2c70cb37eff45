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
    use shared::trajectory::Knot;
    use shared::trajectory::{CHANNELS, Path};

    /// A rising bend of radius 500 mm, with its place and direction at s.
    fn bend() -> (Course, impl Fn(f64) -> [Vector3<f64>; 2]) {
        let at = |s: f64| {
            let (sin, cos) = (s / 500.0).sin_cos();
            [
                Vector3::new(500.0 * sin, -500.0 * cos, 0.1 * s),
                Vector3::new(cos, sin, 0.1),
            ]
        };
        let mut path = Box::new(Path::new());
        for k in 0..=100 {
            let s_mm = 5.0 * f64::from(k);
            let [place, direction] = at(s_mm);
            let channels = |xyz: Vector3<f64>| {
                let mut channels = [0.0; CHANNELS];
                channels[..3].copy_from_slice(xyz.as_slice());
                channels
            };
            let (value, slope) = (channels(place), channels(direction));
            path.push(Knot { s_mm, value, slope }).unwrap();
        }
        (Course::Knots(path), at)
    }

    #[test]
    fn contour_error_is_the_distance_from_the_nearest_place_of_the_path() {
        let (path, at) = bend();
        let [place, along] = at(200.0);
        let across = along.cross(&Vector3::z()).normalize();
        let tip = place + across * 0.03 + along.normalize().cross(&across) * 0.04;
        let error = nearest(&path, &tip, 203.0).unwrap().distance_mm;
        assert!((error - 0.05).abs() < 1e-6, "{error}");
        let [end, along] = at(500.0);
        let error = nearest(&path, &(end + along.normalize() * 0.07), 500.0).unwrap();
        assert!((error.distance_mm - 0.07).abs() < 1e-6, "{error:?}");
    }
}
