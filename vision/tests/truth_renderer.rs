//! The pictures of the truth renderer hold what mathematics 0.12 says.

use proptest::prelude::*;
use vision::render::{Finish, Gap, Joint, Light, Root, Scene, Shown, Stripe, Texture, TruthRenderer};
use vision::render::{random_corner, random_gap};
use vision::{Corner, Optics, PhotonTransfer, PlateSeam};

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 10_000.0,
    read_noise: 10.0,
};

fn camera(rows: usize, columns: usize) -> Optics {
    Optics {
        magnification: 4.0,
        pixel_mm: 0.0138,
        tilt_rad: 45f64.to_radians(),
        aperture: 0.10,
        wavelength_mm: 0.000_55,
        rows,
        columns,
    }
}

fn plate(height_mm: f64) -> PlateSeam {
    PlateSeam {
        height_mm,
        pitch: 0.0,
        roll: 0.0,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.0,
    }
}

/// A scene whose surface has no contrast of its own.
fn blank(joint: Joint) -> Scene {
    let texture = Texture {
        finish: Finish::Plain,
        contrast: 0.0,
        seed: 1,
    };
    Scene::new(joint, texture)
}

fn light(optics: Optics, scene: &Scene) -> Vec<f32> {
    TruthRenderer::new(optics, NOISE, 3).unwrap().light(scene)
}

/// What a dark line takes from a row: sum, middle and variance over the columns.
fn deficit(row: &[f32], plain: f64) -> (f64, f64, f64) {
    let taken: Vec<f64> = row.iter().map(|&x| 1.0 - f64::from(x) / plain).collect();
    let sum: f64 = taken.iter().sum();
    let mean = taken.iter().enumerate().map(|(c, d)| d * c as f64).sum::<f64>() / sum;
    let variance = taken
        .iter()
        .enumerate()
        .map(|(c, d)| d * (c as f64 - mean).powi(2))
        .sum::<f64>()
        / sum;
    (sum, mean, variance)
}

/// Middle of the rows in which lateral contrast is strong.
fn band_row(picture: &[f32], columns: usize, within: std::ops::Range<usize>) -> f64 {
    let energy: Vec<f64> = picture
        .chunks_exact(columns)
        .map(|row| {
            row[within.clone()]
                .windows(3)
                .map(|v| f64::from(v[2] - v[0]).powi(2))
                .sum()
        })
        .collect();
    let half = energy.iter().fold(0.0f64, |m, &e| m.max(e)) / 2.0;
    let above = |&(_, e): &(usize, &f64)| *e > half;
    let (sum, moment) = energy
        .iter()
        .enumerate()
        .filter(above)
        .fold((0.0, 0.0), |(s, m), (row, e)| (s + e, m + e * row as f64));
    moment / sum
}

#[test]
fn the_band_lies_in_the_row_of_the_formula() {
    let optics = camera(300, 400);
    for (seed, height, roll) in [(1, 0.0, 0.0), (2, 0.12, 0.0), (3, -0.15, 0.1), (4, 0.05, -0.17)] {
        let seam = PlateSeam {
            roll,
            ..plate(height)
        };
        let scene = Scene::new(Joint::Gap(Gap::new(seam)), Texture::new(Finish::Plain, seed));
        let picture = light(optics, &scene);
        let features = seam.features(&optics).unwrap();
        for left in [0, 100, 200, 300] {
            let seen = band_row(&picture, 400, left..left + 100);
            let wanted = features.band_row + features.band_slope * (left as f64 + 49.5 - 199.5);
            assert!(
                (seen - wanted).abs() < 8.0,
                "{seed} at {left}: {seen}, not {wanted}"
            );
        }
    }
}

#[test]
fn the_band_of_a_corner_follows_its_walls() {
    let optics = camera(300, 400);
    let corner = Corner {
        height_mm: -0.1,
        lateral_mm: 0.05,
        walls: [-0.7, 0.85],
    };
    let scene = Scene::new(Joint::Corner(Root::new(corner)), Texture::new(Finish::Plain, 5));
    let picture = light(optics, &scene);
    let features = corner.features(&optics);
    for left in [120, 150, 250, 280] {
        let from_vertex = left as f64 + 14.5 - features.vertex[1];
        let wanted = features.vertex[0] + features.band_slopes[usize::from(from_vertex > 0.0)] * from_vertex;
        let seen = band_row(&picture, 400, left..left + 30);
        assert!((seen - wanted).abs() < 14.0, "at {left}: {seen}, not {wanted}");
    }
}

#[test]
fn a_line_is_blurred_by_its_depth() {
    let optics = camera(200, 120);
    let mut scene = blank(Joint::Gap(Gap::new(plate(0.0))));
    scene.stripes.push(Stripe {
        offset_mm: 0.0,
        width_mm: 0.0046,
        factor: 0.2,
    });
    let picture = light(optics, &scene);
    let g = optics.object_pixel_mm();
    let spread = optics.aperture.asin().tan();
    let sharp = (0.0046f64.powi(2) + g * g) / 12.0 + (0.21 * optics.wavelength_mm / optics.aperture).powi(2);
    for row in [0, 25, 60, 99, 140, 199] {
        let depth = (row as f64 - optics.centre()[0]) * g;
        let wanted = ((depth * spread / 2.0).powi(2) + sharp).sqrt() / g;
        let (sum, middle, variance) = deficit(&picture[row * 120..][..120], 0.5);
        assert!((sum * g - 0.8 * 0.0046).abs() < 1e-4, "row {row}: {sum}");
        assert!((middle - 59.5).abs() < 0.02, "row {row}: {middle}");
        assert!(
            (variance.sqrt() / wanted - 1.0).abs() < 0.06,
            "row {row}: {} {wanted}",
            variance.sqrt()
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_gap_lies_where_the_truth_says(
        height_mm in -0.06..0.06, roll in -0.17..0.17, lateral_mm in -0.04..0.04,
        yaw_rad in -0.06..0.06, width_mm in 0.02..0.08, pitch in -0.05..0.05,
    ) {
        let optics = camera(90, 120);
        let seam = PlateSeam { height_mm, pitch, roll, lateral_mm, yaw_rad, width_mm };
        let scene = blank(Joint::Gap(Gap { brightness: 0.0, ..Gap::new(seam) }));
        let truth = scene.truth(&optics).unwrap();
        prop_assert_eq!(truth.shown, Shown::Seam);
        let features = seam.features(&optics).unwrap();
        let row = truth.seam[0].round();
        let picture = light(optics, &scene);
        let (sum, middle, _) = deficit(&picture[row as usize * 120..][..120], 0.5);
        let wanted = truth.seam[1] + features.edge_slope * (row - truth.seam[0]);
        prop_assert!((middle - wanted).abs() < 0.1, "{} {}", middle, wanted);
        let width = features.edges[1] - features.edges[0];
        // Along a row instead of along the band, the gap is wider by its yaw on the slope of the band.
        let along_row = width * (1.0 - features.edge_slope * features.band_slope);
        prop_assert!((sum - along_row).abs() < 0.1, "{} {}", sum, along_row);
    }
}

#[test]
fn noise_is_that_of_the_photons() {
    let optics = camera(120, 120);
    let mut renderer = TruthRenderer::new(optics, NOISE, 1).unwrap();
    for level in [0.1, 0.5, 0.8] {
        let mut scene = blank(Joint::Gap(Gap::new(plate(0.0))));
        scene.light = Light::even(level);
        let pixels = renderer.render(&scene, 11);
        let mean = pixels.iter().map(|&p| f64::from(p)).sum::<f64>() / pixels.len() as f64;
        let variance =
            pixels.iter().map(|&p| (f64::from(p) - mean).powi(2)).sum::<f64>() / pixels.len() as f64;
        assert!((mean - 255.0 * level).abs() < 0.1, "{mean}");
        assert!(
            (variance / NOISE.variance(mean) - 1.0).abs() < 0.06,
            "{level}: {variance}"
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_picture() {
    let optics = camera(60, 80);
    let mut first = TruthRenderer::new(optics, NOISE, 1).unwrap();
    let scene = random_gap(4, &optics);
    let picture = first.render(&scene, 9);
    // Other pictures in between leave no trace.
    let other = first.render(&random_corner(5, &optics), 10);
    assert_ne!(picture, other);
    assert_eq!(picture, first.render(&scene, 9));
    assert_eq!(
        picture,
        TruthRenderer::new(optics, NOISE, 1).unwrap().render(&scene, 9)
    );
    assert_ne!(picture, first.render(&scene, 10));
}

#[test]
fn the_texture_moves_with_the_work() {
    let optics = camera(120, 160);
    let g = optics.object_pixel_mm();
    let mut scene = Scene::new(Joint::Gap(Gap::new(plate(0.0))), Texture::new(Finish::Plain, 3));
    let before = light(optics, &scene);
    scene.position_mm[1] += 5.0 * g;
    let aside = light(optics, &scene);
    let differ = |row: usize| {
        let pairs = before[row * 160..][10..150]
            .iter()
            .zip(&aside[row * 160..][5..145]);
        pairs.map(|(b, a)| (b - a).abs()).fold(0.0f32, f32::max)
    };
    assert!(
        (0..120).all(|row| differ(row) < 1e-3),
        "shifted across by five columns"
    );

    scene.position_mm = [6.0 * g / optics.tilt_rad.cos(), 0.0];
    let ahead = light(optics, &scene);
    let (row, mut products) = (60, [0.0f64; 3]);
    for column in 0..160 {
        let x = f64::from(before[(row + 3) * 160 + column]) - 0.5;
        let y = f64::from(ahead[(row - 3) * 160 + column]) - 0.5;
        products = [products[0] + x * y, products[1] + x * x, products[2] + y * y];
    }
    let likeness = products[0] / (products[1] * products[2]).sqrt();
    assert!(likeness > 0.95, "six rows of travel: likeness {likeness}");
}

#[test]
fn travel_smears_as_the_mean_of_the_places_passed() {
    let optics = camera(60, 80);
    let smear_mm = 4.0 * optics.object_pixel_mm() / optics.tilt_rad.cos();
    let still = Scene::new(Joint::Gap(Gap::new(plate(0.0))), Texture::new(Finish::Plain, 3));
    let mut mean = vec![0.0; 60 * 80];
    for k in 0..8 {
        let position_mm = [smear_mm * ((f64::from(k) + 0.5) / 8.0 - 0.5), 0.0];
        let passed = Scene {
            position_mm,
            ..still.clone()
        };
        mean.iter_mut()
            .zip(light(optics, &passed))
            .for_each(|(mean, x)| *mean += x / 8.0);
    }
    let smeared = light(optics, &Scene { smear_mm, ..still });
    let furthest = mean
        .iter()
        .zip(&smeared)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max);
    assert!(furthest < 0.01, "{furthest} of full scale apart");
}

#[test]
fn random_gaps_are_mixed_as_the_protocol_says() {
    let optics = camera(300, 400);
    let shown: Vec<Shown> = (0..4000)
        .map(|seed| random_gap(seed, &optics).truth(&optics).unwrap().shown)
        .collect();
    let share = |wanted: Shown| shown.iter().filter(|&&s| s == wanted).count() as f64 / 4000.0;
    let beyond = share(Shown::TooHigh) + share(Shown::TooLow);
    for (seen, wanted) in [
        (beyond, 0.04),
        (share(Shown::Dark), 0.01),
        (share(Shown::NoGap), 0.03),
    ] {
        assert!((seen - wanted).abs() < 0.01, "{seen} instead of {wanted}");
    }
    assert!(share(Shown::TooHigh) > 0.01 && share(Shown::TooLow) > 0.01);
}
