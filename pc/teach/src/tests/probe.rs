//! Readings of the probe, and normals from them.

use super::*;
use config::probe::{Probe, ProbeConfig, RangingError, Reading, Refused};

fn probe() -> Probe {
    ProbeConfig::default().build().expect("a probe")
}

/// A good reading at a distance \[mm\].
fn at(distance_mm: f64) -> Reading {
    Reading {
        volts: probe().volts(distance_mm),
        valid: true,
        near: false,
        far: false,
    }
}

#[test]
fn the_published_range_is_60_to_100_mm_at_plus_minus_5_v() {
    for (volts, distance) in [(-5.0, 60.0), (0.0, 80.0), (5.0, 100.0)] {
        assert_eq!(probe().distance_mm(&Reading { volts, ..at(80.0) }), Ok(distance));
        assert_eq!(probe().volts(distance), volts);
    }
}

#[test]
fn a_reading_that_is_no_distance_is_refused_with_its_reason() {
    let refused = |reading| probe().distance_mm(&reading).unwrap_err();
    let good = at(80.0);
    assert_eq!(refused(Reading { valid: false, ..good }), Refused::NotValid);
    assert_eq!(refused(Reading { near: true, ..good }), Refused::Near);
    assert_eq!(refused(Reading { far: true, ..good }), Refused::Far);
    // A surface out of range sends no light back: the remedy that helps more is reported.
    let nothing = Reading {
        valid: false,
        far: true,
        ..good
    };
    assert_eq!(refused(nothing), Refused::Far);
    let (volts, max) = (5.001, 5.0);
    assert_eq!(refused(Reading { volts, ..good }), Refused::Volts { volts, max });
    let broken = Reading {
        volts: f64::NAN,
        ..good
    };
    assert!(matches!(refused(broken), Refused::Volts { .. }));
}

#[test]
fn outliers_and_refused_readings_do_not_move_the_mean() {
    let mut readings = [79.98, 80.01, 80.0, 79.99, 80.02, 80.0, 83.0].map(at).to_vec();
    readings.push(Reading {
        valid: false,
        ..at(70.0)
    });
    let seen = probe().range(&readings).expect("a distance");
    near(seen.distance_mm, 80.0, 1e-12);
    assert_eq!((seen.used, seen.outliers, seen.refused), (6, 1, 1));
    // Squares of deviation: (4 + 1 + 0 + 1 + 4 + 0)·1e-4 over 5.
    near(seen.scatter_mm, (1e-3f64 / 5.0).sqrt(), 1e-12);
}

#[test]
fn too_few_readings_are_no_distance() {
    let mut readings = vec![at(80.0); 4];
    readings.push(Reading {
        far: true,
        ..at(80.0)
    });
    let error = probe().range(&readings).unwrap_err();
    assert_eq!(
        error.to_string(),
        "4 of 5 readings can be used, 5 are needed; the surface is too far: move the probe nearer"
    );
    let error = probe().range(&[]).unwrap_err();
    assert_eq!(error.to_string(), "0 of 0 readings can be used, 5 are needed");
    readings.push(at(80.0));
    assert!(probe().range(&readings).is_ok());
}

#[test]
fn nine_readings_suffice_and_few_of_them_are_lost() {
    let mut random = SplitMix64::new(11);
    let (mut used, mut said) = (0, 0.0);
    let seen = rms(5000, || {
        let readings = [(); 9].map(|()| at(80.0 + 0.02 * random.gauss()[0]));
        let ranging = probe().range(&readings).expect("a distance");
        used += ranging.used;
        said += ranging.scatter_mm.powi(2) / 5000.0;
        ranging.distance_mm - 80.0
    });
    println!(
        "mean of {} readings, {seen} mm, said {}",
        used as f64 / 5000.0,
        said.sqrt()
    );
    assert!(seen < 0.0085, "{seen}");
    assert!(used > 5000 * 8, "{used}");
    assert!((0.015..0.018).contains(&said.sqrt()), "{}", said.sqrt());
}

#[test]
fn a_probe_that_makes_no_sense_is_refused_by_its_key() {
    let good = ProbeConfig::default();
    let refused = |config: ProbeConfig| config.build().unwrap_err().to_string();
    assert_eq!(
        refused(ProbeConfig {
            mm_per_volt: 0.0,
            ..good
        }),
        "mm_per_volt is 0, but must be other than 0"
    );
    assert_eq!(
        refused(ProbeConfig {
            distance_at_0v_mm: 15.0,
            ..good
        }),
        "distance_at_0v_mm is 15, but must be large enough that every voltage is a distance above 0"
    );
    assert_eq!(
        refused(ProbeConfig {
            least_readings: 2,
            ..good
        }),
        "least_readings is 2, but must be 3 or more"
    );
    assert!(
        ProbeConfig {
            max_volts: f64::NAN,
            ..good
        }
        .build()
        .is_err()
    );
    assert!(
        ProbeConfig {
            outlier_mad: 0.5,
            ..good
        }
        .build()
        .is_err()
    );
}

/// Nine readings of everything with 0.02 mm of noise, one in thirty a millimetre off, on surfaces inclined by up to
/// 45°: the whole way from voltages to a normal.
#[test]
fn normals_from_noisy_readings_are_within_half_a_degree_up_to_45_degrees() {
    let mut random = SplitMix64::new(12);
    let config = HalvingConfig {
        noise_mm: 0.008,
        ..HalvingConfig::default()
    };
    let halving = config.build().expect("a loop");
    let (mut worst, mut squares, mut rings, mut count) = (0f64, 0.0, 0, 0.0);
    for step in 0..=45 {
        let (tilt, azimuth) = (f64::from(step), f64::from(step) * 37.0);
        let (surface, truth) = (cylinder(150.0, azimuth, tilt), cylinder_normal(azimuth, tilt));
        for _ in 0..20 {
            let mut range = |height: f64| {
                let readings = [(); 9].map(|()| {
                    let wild = if random.gauss()[0] > 1.83 { 1.0 } else { 0.0 };
                    at(80.0 - height + 0.02 * random.gauss()[0] + wild)
                });
                Ok(probe().range(&readings)?.distance_mm)
            };
            let taught = halving.run(|radius| {
                let centre = range(0.0)?;
                let mut heights = [0.0; NEIGHBOURS];
                for (height, [cos, sin]) in heights.iter_mut().zip(DIRECTIONS) {
                    *height = centre - range(surface(radius * cos, radius * sin))?;
                }
                Ok::<_, RangingError>(heights)
            });
            let taught = taught.expect("a normal");
            let error = angle(&taught.ring.normal(), &truth).to_degrees();
            worst = worst.max(error);
            squares += error * error;
            rings += taught.rings;
            count += 1.0;
            assert!(taught.ok, "{taught:?}");
        }
    }
    println!(
        "worst {worst}°, rms {}°, {} rings",
        (squares / count).sqrt(),
        rings as f64 / count
    );
    assert!(worst < 0.5, "{worst}");
}
