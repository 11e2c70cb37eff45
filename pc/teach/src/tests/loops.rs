//! The search for a radius.

use super::*;
use std::convert::Infallible;
use std::io;

/// Error of the taught least-squares normal \[deg\], and what was taught.
fn teach(
    config: HalvingConfig,
    surface: Surface,
    truth: &Vector3<f64>,
    random: &mut SplitMix64,
) -> (f64, Taught) {
    let measure = |radius| Ok::<_, Infallible>(heights(surface, radius, config.noise_mm, random));
    let taught = config.build().expect("a loop").run(measure).expect("a ring");
    (angle(&taught.ring.normal(), truth).to_degrees(), taught)
}

fn noise(noise_mm: f64) -> HalvingConfig {
    HalvingConfig {
        noise_mm,
        ..HalvingConfig::default()
    }
}

#[test]
fn a_ring_is_as_large_as_noise_asks_and_as_small_as_shape_asks() {
    let mut random = SplitMix64::new(6);
    let (_, flat) = teach(noise(0.0), &|x, _| 0.25 * x, &Vector3::z(), &mut random);
    assert_eq!((flat.ring.radius(), flat.rings), (8.0, 2));
    let inclined = cylinder(20.0, 0.0, 30.0);
    let (_, bent) = teach(noise(0.0), &inclined, &Vector3::z(), &mut random);
    assert_eq!((bent.ring.radius(), bent.rings), (1.0, 4));
    let mean_radius = |config, surface: Surface, random: &mut _| {
        let radii = (0..500).map(|_| teach(config, surface, &Vector3::z(), random).1.ring.radius());
        radii.sum::<f64>() / 500.0
    };
    let bent = [0.005, 0.02].map(|sigma| mean_radius(noise(sigma), &inclined, &mut random));
    assert!(bent[0] < 0.75 * bent[1] && bent[1] < 3.0, "{bent:?}");
    let flat = mean_radius(noise(0.02), &|_, _| 0.0, &mut random);
    assert!(flat > 6.5, "{flat}");
}

#[test]
fn the_expected_error_is_about_the_true_one() {
    let mut random = SplitMix64::new(7);
    for sigma in [0.005, 0.01, 0.02] {
        for (r, tilt) in [
            (50.0, 0.0),
            (50.0, 15.0),
            (50.0, 30.0),
            (50.0, 45.0),
            (20.0, 30.0),
            (1e4, 45.0),
        ] {
            let (surface, truth) = (cylinder(r, 25.0, tilt), cylinder_normal(25.0, tilt));
            let mut said = 0.0;
            let seen = rms(1000, || {
                let (error, taught) = teach(noise(sigma), &surface, &truth, &mut random);
                said += taught.error.to_degrees().powi(2) / 1000.0;
                error
            });
            let ratio = seen / said.sqrt();
            assert!(
                (0.8..1.5).contains(&ratio),
                "σ {sigma}, R {r}, {tilt}°: {seen} against {}",
                said.sqrt()
            );
        }
    }
}

#[test]
fn balance_succeeds_where_the_published_rule_cannot() {
    let mut random = SplitMix64::new(8);
    let (surface, truth) = (cylinder(50.0, 25.0, 30.0), cylinder_normal(25.0, 30.0));
    let limit_deg = 1.0;
    let balance = HalvingConfig {
        limit_deg,
        ..noise(0.02)
    };
    let published = HalvingConfig {
        rule: StopRule::Spread,
        ..balance
    };
    let (mut ok, mut rings) = ([0; 2], [0; 2]);
    let ours = rms(500, || {
        let (error, taught) = teach(balance, &surface, &truth, &mut random);
        ok[0] += usize::from(taught.ok);
        rings[0] += taught.rings;
        error
    });
    let theirs = rms(500, || {
        let (_, taught) = teach(published, &surface, &truth, &mut random);
        ok[1] += usize::from(taught.ok);
        rings[1] += taught.rings;
        angle(&taught.ring.triples().normal, &truth).to_degrees()
    });
    println!("{ours:.3}° against {theirs:.3}°, {ok:?} of 500 ok, {rings:?} rings");
    assert!(ours < 0.25 && theirs > 2.0 * ours, "{ours} against {theirs}");
    assert!(ok[0] == 500 && ok[1] < 250, "{ok:?}");
    assert!(rings[0] < rings[1], "{rings:?}");
}

#[test]
fn no_ring_is_smaller_than_the_floor_and_a_poor_one_is_not_ok() {
    let mut random = SplitMix64::new(9);
    for rule in [StopRule::Balance, StopRule::Spread] {
        let config = HalvingConfig {
            smallest_radius_mm: 3.0,
            limit_deg: 0.01,
            rule,
            ..noise(0.0)
        };
        let bent = cylinder(20.0, 10.0, 30.0);
        let (_, taught) = teach(config, &bent, &Vector3::z(), &mut random);
        assert_eq!((taught.ring.radius(), taught.rings, taught.ok), (4.0, 2, false));
        assert!(taught.error > config.limit_deg.to_radians());
    }
}

#[test]
fn an_edge_beside_the_point_is_left_out_or_warned_of() {
    let mut random = SplitMix64::new(10);
    let step = |beside: f64| move |x: f64, _| if x > beside { -2.0 } else { 0.0 };
    let (error, taught) = teach(noise(0.01), &step(3.0), &Vector3::z(), &mut random);
    assert!(
        taught.ring.radius() < 3.0 && taught.ok && taught.unsmooth.is_none(),
        "{taught:?}"
    );
    assert!(error < 1.0, "{error}");
    let (_, taught) = teach(noise(0.01), &step(0.5), &Vector3::z(), &mut random);
    let warning = taught.unsmooth.expect("a warning").to_string();
    assert!(warning.contains("is there an edge? measure closer"), "{warning}");
    assert!(!taught.ok);
}

#[test]
fn a_ring_that_cannot_be_measured_ends_the_search_and_is_named() {
    let halving = HalvingConfig::default().build().expect("a loop");
    let error = halving.run(|radius| {
        if radius > 5.0 {
            Ok(cylinder_heights(radius))
        } else {
            Err(io::Error::other("no light"))
        }
    });
    assert_eq!(error.unwrap_err().to_string(), "ring of 4 mm: no light");
    let error = halving.run(|_| Ok::<_, Infallible>([f64::INFINITY; 8]));
    assert_eq!(
        error.unwrap_err().to_string(),
        "height 1 of the ring is not finite"
    );
}

fn cylinder_heights(radius: f64) -> [f64; NEIGHBOURS] {
    heights(&cylinder(50.0, 0.0, 30.0), radius, 0.0, &mut SplitMix64::new(0))
}

#[test]
fn a_search_that_makes_no_sense_is_refused_by_its_key() {
    let good = HalvingConfig::default();
    let refused = |config: HalvingConfig| config.build().unwrap_err().to_string();
    let start_radius_mm = 1.5;
    assert_eq!(
        refused(HalvingConfig {
            start_radius_mm,
            ..good
        }),
        "start_radius_mm is 1.5, but must be at least twice the smallest radius: two rings are compared"
    );
    let rule = StopRule::Spread;
    assert!(
        HalvingConfig {
            start_radius_mm,
            rule,
            ..good
        }
        .build()
        .is_ok()
    );
    assert_eq!(
        refused(HalvingConfig {
            smallest_radius_mm: 0.0,
            ..good
        }),
        "smallest_radius_mm is 0, but must be above 0"
    );
    assert_eq!(
        refused(HalvingConfig {
            limit_deg: f64::NAN,
            ..good
        }),
        "limit_deg is NaN, but must be above 0"
    );
    assert_eq!(
        refused(HalvingConfig {
            noise_mm: -0.1,
            ..good
        }),
        "noise_mm is -0.1, but must be 0 or more"
    );
}
