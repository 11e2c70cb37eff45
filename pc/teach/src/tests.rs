//! Rings on known surfaces, with and without noise (figures of mathematics 2.3, 2.4).

mod loops;
mod probe;
mod rings;

use super::*;
use crate::ring::{DIRECTIONS, NEIGHBOURS};
use nalgebra::Vector3;
use shared::geometry::angle;
use vision::render::SplitMix64;

/// A surface through the origin: height \[mm\] over x and y.
type Surface<'a> = &'a dyn Fn(f64, f64) -> f64;

/// Heights of a ring on `surface`, each with noise of standard deviation `noise` \[mm\].
fn heights(surface: Surface, radius: f64, noise: f64, random: &mut SplitMix64) -> [f64; NEIGHBOURS] {
    DIRECTIONS.map(|[cos, sin]| surface(radius * cos, radius * sin) + noise * random.gauss()[0])
}

fn noisy(surface: Surface, radius: f64, noise: f64, random: &mut SplitMix64) -> Ring {
    Ring::new(radius, heights(surface, radius, noise, random)).expect("a ring")
}

fn ring(surface: Surface, radius: f64) -> Ring {
    noisy(surface, radius, 0.0, &mut SplitMix64::new(0))
}

/// A convex cylinder of radius `r`, its axis level and across `azimuth`, touched where it is inclined by `tilt`
/// \[deg\].
fn cylinder(r: f64, azimuth: f64, tilt: f64) -> impl Fn(f64, f64) -> f64 {
    let (azimuth, tilt) = (azimuth.to_radians(), tilt.to_radians());
    move |x, y| {
        let across = x * azimuth.cos() + y * azimuth.sin() + r * tilt.sin();
        (r * r - across * across).sqrt() - r * tilt.cos()
    }
}

/// Its normal there.
fn cylinder_normal(azimuth: f64, tilt: f64) -> Vector3<f64> {
    let (azimuth, tilt) = (azimuth.to_radians(), tilt.to_radians());
    Vector3::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), tilt.cos())
}

/// A sphere of radius `r`, touched where it is inclined by `tilt` \[deg\] towards x.
fn sphere(r: f64, tilt: f64) -> impl Fn(f64, f64) -> f64 {
    let tilt = tilt.to_radians();
    move |x, y| {
        let x = x + r * tilt.sin();
        (r * r - x * x - y * y).sqrt() - r * tilt.cos()
    }
}

/// Root mean square of `count` values.
fn rms(count: u32, mut value: impl FnMut() -> f64) -> f64 {
    ((0..count).map(|_| value().powi(2)).sum::<f64>() / f64::from(count)).sqrt()
}

#[track_caller]
fn near(seen: f64, wanted: f64, tolerance: f64) {
    assert!((seen - wanted).abs() <= tolerance, "{seen}, not {wanted}");
}
