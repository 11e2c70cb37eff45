//! Normal, curvature and warnings of one ring.

use super::*;

#[test]
fn second_order_does_not_disturb_the_normal_and_its_curvature_is_found() {
    let mut random = SplitMix64::new(1);
    for _ in 0..1000 {
        let [gx, gy, xx, yy, xy] = [(); 5].map(|()| random.gauss()[0]);
        let surface = |x, y| gx * x + gy * y + 0.05 * (xx * x * x / 2.0 + yy * y * y / 2.0 + xy * x * y);
        let ring = ring(&surface, 4.0);
        assert!(angle(&ring.normal(), &Vector3::new(-gx, -gy, 1.0)) < 1e-14);
        let Curvature { xx: a, yy: b, xy: c } = ring.curvature();
        near(
            (a - 0.05 * xx).abs() + (b - 0.05 * yy).abs() + (c - 0.05 * xy).abs(),
            0.0,
            1e-14,
        );
        assert!(ring.noise_seen() < 1e-14 && ring.unsmooth(1e-12, 1e-6).is_none());
    }
}

#[test]
fn errors_of_shape_are_those_of_third_order() {
    let errors = |surface: Surface, truth: Vector3<f64>| {
        [8.0, 4.0, 2.0].map(|radius| {
            let ring = ring(surface, radius);
            [ring.normal(), ring.triples().normal].map(|n| angle(&n, &truth).to_degrees())
        })
    };
    let level = errors(&cylinder(50.0, 30.0, 0.0), Vector3::z());
    for ([least_squares, triples], wanted) in level.into_iter().zip([0.97, 0.48, 0.24]) {
        near(least_squares, 0.0, 1e-12);
        near(triples, wanted, 0.005);
    }
    let inclined = errors(&cylinder(50.0, 0.0, 30.0), cylinder_normal(0.0, 30.0));
    for ([least_squares, _], wanted) in inclined.into_iter().zip([0.44, 0.107, 0.027]) {
        near(least_squares, wanted, 0.003);
    }
    // A slope errs by S²/8·(∂³z/∂x³ + ∂³z/∂x∂y²), and the angle by that times cos² of the inclination.
    let (sin, cos) = 20f64.to_radians().sin_cos();
    let third = (3.0 * sin / cos.powi(3) + sin / cos) / (8.0 * 50.0 * 50.0);
    let on_sphere = errors(&sphere(50.0, 20.0), cylinder_normal(0.0, 20.0));
    for ([least_squares, _], radius) in on_sphere.into_iter().zip([8.0, 4.0, 2.0]) {
        let wanted = (third * radius * radius).to_degrees();
        near(least_squares, wanted, 0.0005 * radius * radius * wanted);
    }
}

#[test]
fn third_order_turns_the_normal_as_said_and_shows_in_the_ring() {
    let (k, radius) = (1e-4, 8.0);
    let ring = ring(&|x, _| k * x * x * x, radius);
    let error = angle(&ring.normal(), &Vector3::z());
    near(error, 0.75 * k * radius * radius, 1e-7);
    let warning = ring.unsmooth(1e-3, error / 2.0).expect("a warning");
    near(warning.normal_error, error, 1e-12);
    assert!(ring.unsmooth(1e-3, error * 1.01).is_none(), "harmless");
    assert!(ring.unsmooth(0.02, error / 2.0).is_none(), "may be noise");
}

#[test]
fn noise_turns_the_normal_by_the_tabulated_amounts() {
    let (noise, radius) = (0.02, 4.0);
    let mut random = SplitMix64::new(2);
    let flat = |_, _| 0.0;
    let (mut spread, mut triples, mut seen) = (0.0, 0.0, 0.0);
    let count = 20_000;
    let normal = rms(count, || {
        let ring = noisy(&flat, radius, noise, &mut random);
        spread += ring.triples().spread / f64::from(count);
        triples += angle(&ring.triples().normal, &Vector3::z()).powi(2) / f64::from(count);
        seen += ring.noise_seen().powi(2) / f64::from(count);
        angle(&ring.normal(), &Vector3::z())
    });
    println!(
        "normal {normal}, triples {}, spread {spread}, noise seen {}",
        triples.sqrt(),
        seen.sqrt()
    );
    near(normal, noise / (2f64.sqrt() * radius), 0.02 * normal);
    near(normal, ring(&flat, radius).normal_noise(noise), 0.02 * normal);
    near(triples.sqrt() / normal, 1.10, 0.02);
    near(spread, 2.0 * noise / radius, 0.05 * spread);
    near(seen.sqrt(), noise, 0.02 * noise);
}

#[test]
fn noise_turns_the_normal_of_an_inclined_surface_less() {
    let (noise, radius) = (0.02, 4.0);
    let mut random = SplitMix64::new(3);
    let inclined = |x: f64, y: f64| 0.8 * x + 0.6 * y;
    let truth = Vector3::new(-0.8, -0.6, 1.0);
    let said = ring(&inclined, radius).normal_noise(noise);
    near(said, noise / (2.0 * radius) * 0.75f64.sqrt(), 1e-12);
    let seen = rms(20_000, || {
        angle(&noisy(&inclined, radius, noise, &mut random).normal(), &truth)
    });
    near(seen, said, 0.02 * said);
}

#[test]
fn noise_alone_rarely_warns_of_an_edge() {
    let mut random = SplitMix64::new(4);
    let curved = cylinder(50.0, 20.0, 0.0);
    let warned = (0..20_000)
        .filter(|_| {
            noisy(&curved, 4.0, 0.02, &mut random)
                .unsmooth(0.02, 0.0)
                .is_some()
        })
        .count();
    println!("{warned} of 20000");
    assert!((5..45).contains(&warned), "{warned} of 20000, 20 are due");
}

#[test]
fn a_step_shows_wherever_it_lies_and_its_harm_is_not_understated() {
    let (noise, radius) = (0.02, 8.0);
    let mut random = SplitMix64::new(5);
    for turn in 0..48 {
        let (sin, cos) = (f64::from(turn) * 7.5).to_radians().sin_cos();
        for offset in [-0.85, -0.6, -0.3, 0.0, 0.3, 0.6, 0.85] {
            let step = |x: f64, y: f64| {
                let behind = x * cos + y * sin > offset * radius;
                if behind { 20.0 * noise } else { 0.0 }
            };
            let quiet = ring(&step, radius);
            let Some(seen) = quiet.unsmooth(1e-6, 0.0) else {
                // No point of the ring, or all of them, are behind the step.
                assert!(angle(&quiet.normal(), &Vector3::z()) < 1e-12);
                continue;
            };
            assert!(angle(&quiet.normal(), &Vector3::z()) <= seen.normal_error);
            let found = (0..20)
                .filter(|_| {
                    let ring = noisy(&step, radius, noise, &mut random);
                    ring.unsmooth(noise, 0.5f64.to_radians()).is_some()
                })
                .count();
            assert!(found >= 19, "{found} of 20 at {turn}, {offset}");
        }
    }
}

#[test]
fn a_crease_through_the_centre_shows_unless_midway_between_the_points() {
    for turn in 0..16 {
        let (sin, cos) = (f64::from(turn) * 11.25).to_radians().sin_cos();
        let roof = |x: f64, y: f64| -0.1 * (x * cos + y * sin).abs();
        let warning = ring(&roof, 8.0).unsmooth(0.02, 0.5f64.to_radians());
        assert_eq!(warning.is_some(), turn % 4 != 2, "{turn}: {warning:?}");
    }
}

#[test]
fn what_is_no_ring_is_refused() {
    assert_eq!(
        Ring::new(0.0, [0.0; 8]).unwrap_err().to_string(),
        "the radius of the ring is 0 mm, but must be above 0"
    );
    let mut heights = [0.0; 8];
    heights[3] = f64::NAN;
    assert_eq!(
        Ring::new(1.0, heights).unwrap_err().to_string(),
        "height 4 of the ring is not finite"
    );
}
