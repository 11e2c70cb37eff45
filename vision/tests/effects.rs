//! What real joints have looks the same by the fast renderer as by the truth renderer.

use std::sync::Arc;
use vision::render::{
    Dirt, Effect, FastRenderer, Film, Finish, Gap, Joint, Light, Scene, Sensor, Shown, Tack, Texture, Tile,
    TruthRenderer, random_joint,
};
use vision::{Optics, PhotonTransfer, PlateSeam};

/// Hardly any noise but that of 8 bits.
const QUIET: PhotonTransfer = PhotonTransfer {
    full_well: 1e9,
    read_noise: 0.0,
};

const ROWS: usize = 150;
const COLUMNS: usize = 200;
const SMEAR_MM: f64 = 0.006;

fn camera() -> Optics {
    Optics {
        magnification: 4.0,
        pixel_mm: 0.0276,
        tilt_rad: 45f64.to_radians(),
        aperture: 0.10,
        wavelength_mm: 0.000_55,
        rows: ROWS,
        columns: COLUMNS,
    }
}

/// The same scene by both renderers, the fast one's first.
fn both(fast: &mut FastRenderer, scene: &Scene) -> [Vec<u8>; 2] {
    let fast = fast.render(scene, 1).unwrap().to_vec();
    [
        fast,
        TruthRenderer::new(camera(), QUIET, 3).unwrap().render(scene, 2),
    ]
}

fn renderer(textures: [Texture; 2]) -> FastRenderer {
    let tiles = textures.map(|texture| Arc::new(Tile::new(texture, camera(), 0.0, SMEAR_MM).unwrap()));
    FastRenderer::new(tiles, QUIET).unwrap()
}

/// Surfaces without contrast: what is left is that of the effects.
#[test]
fn every_effect_looks_as_in_truth() {
    let blank = Texture {
        contrast: 0.0,
        ..Texture::new(Finish::Plain, 1)
    };
    let mut fast = renderer([blank; 2]);
    for effect in Effect::ALL {
        for seed in 0..3 {
            let mut scene = random_joint(&[effect], &camera(), QUIET, seed);
            (scene.texture, scene.right_texture) = (blank, None);
            (scene.smear_mm, scene.sensor) = (SMEAR_MM, Sensor::default());
            if let Joint::Gap(gap) = &mut scene.joint {
                // Where an edge is rough it is as rough, but not the same in each place.
                gap.roughness_mm = 0.0;
            }
            let [fast, truth] = both(&mut fast, &scene);
            let off = || fast.iter().zip(&truth).map(|(&f, &t)| f64::from(f.abs_diff(t)));
            let mean = off().sum::<f64>() / off().count() as f64;
            let most = off().fold(0.0, f64::max);
            // At a high step one side's blur ends where the other's begins; many marks are many soft edges.
            let limits = match effect {
                Effect::HighStep => [0.3, 24.0],
                Effect::Grooves | Effect::GroovesAcross | Effect::ClosedGrooved => [1.0, 16.0],
                _ => [0.3, 20.0],
            };
            assert!(
                mean < limits[0] && most < limits[1],
                "{effect:?} {seed}: {mean} on the mean, {most} at most of 255"
            );
        }
    }
}

/// Rims, shadows and walls that are wider than the blur are as bright as they should be, on the right side.
#[test]
fn a_side_has_its_own_looks() {
    let blank = Texture {
        contrast: 0.0,
        ..Texture::new(Finish::Plain, 1)
    };
    let mut fast = renderer([blank; 2]);
    let plate = PlateSeam {
        height_mm: 0.0,
        pitch: 0.0,
        roll: 0.15,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.2,
    };
    let mut scene = Scene {
        light: Light::even(100.0 / 255.0),
        smear_mm: SMEAR_MM,
        ..Scene::new(Joint::Gap(Gap::new(plate)), blank)
    };
    scene.sides[0].brightness = 0.5;
    scene.sides[0].shadow = [0.1, 0.2];
    // A plate that falls to the left shows its left wall.
    scene.sides[0].wall_brightness = 2.0;
    scene.sides[1].wall_brightness = 2.0;
    scene.sides[1].rim = [0.06, 2.0];
    for picture in both(&mut fast, &scene) {
        let at = |mm: f64| picture[75 * COLUMNS + (99.5 + mm / 0.0069).round() as usize];
        let close = |seen: u8, wanted: u8| assert!(seen.abs_diff(wanted) <= 4, "{seen} for {wanted}");
        close(at(-0.4), 50);
        close(at(-0.15), 10);
        close(at(0.06), 3);
        close(at(0.13), 200);
        close(at(0.3), 100);
        let walls = [-0.089, 0.089].map(at);
        assert!(walls[0] > 60 && walls[1] < 20, "{walls:?}");
    }
}

#[test]
fn plates_end_and_tacks_close_the_gap_where_they_are_said_to() {
    let blank = Texture {
        contrast: 0.0,
        ..Texture::new(Finish::Plain, 1)
    };
    let mut fast = renderer([blank; 2]);
    let plate = PlateSeam {
        height_mm: 0.0,
        pitch: 0.0,
        roll: 0.0,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.1,
    };
    let mut scene = Scene {
        position_mm: [20.0, 0.0],
        light: Light::even(200.0 / 255.0),
        smear_mm: SMEAR_MM,
        ..Scene::new(Joint::Gap(Gap::new(plate)), blank)
    };
    scene.sides[1].reaches_mm = [f64::NEG_INFINITY, 20.1];
    scene.tacks.push(Tack {
        reaches_mm: [19.5, 19.9],
        width_mm: 0.2,
        brightness: 0.5,
    });
    // Rows go along travel at 45°.
    let row = |place: f64| (74.5 + (place - 20.0) * 45f64.to_radians().cos() / 0.0069).round() as usize;
    for picture in both(&mut fast, &scene) {
        let at = |place: f64, mm: f64| picture[row(place) * COLUMNS + (99.5 + mm / 0.0069).round() as usize];
        let close = |seen: u8, wanted: u8| assert!(seen.abs_diff(wanted) <= 8, "{seen} for {wanted}");
        close(at(20.0, 0.4), 200);
        close(at(20.2, 0.4), 6);
        close(at(20.2, -0.4), 200);
        close(at(20.0, 0.0), 6);
        close(at(19.8, 0.0), 100);
    }
    let shown = |place: f64| {
        let mut scene = scene.clone();
        scene.position_mm[0] = place;
        scene.truth(&camera()).unwrap().shown
    };
    assert_eq!(
        [19.8, 20.0, 20.2].map(shown),
        [Shown::NoGap, Shown::Seam, Shown::NoPlate]
    );
}

#[test]
fn film_and_sensor_change_light_and_noise() {
    let blank = Texture {
        contrast: 0.0,
        ..Texture::new(Finish::Plain, 1)
    };
    let closed = PlateSeam {
        height_mm: 0.0,
        pitch: 0.0,
        roll: 0.0,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.0,
    };
    let mut fast = renderer([blank; 2]);
    let mut truth = TruthRenderer::new(camera(), QUIET, 1).unwrap();
    let mut scene = Scene {
        light: Light::even(0.4),
        smear_mm: SMEAR_MM,
        ..Scene::new(Joint::Gap(Gap::new(closed)), blank)
    };
    let mut pictures = |scene: &Scene, seed: u64| {
        let fast = fast.render(scene, seed).unwrap().to_vec();
        [fast, truth.render(scene, seed)]
    };
    scene.film.veil = 0.1;
    scene.film.dirt.push(Dirt {
        middle: [0.5, 0.0],
        radius: 0.1,
        factor: 0.5,
    });
    for picture in pictures(&scene, 1) {
        let [clean, dirty] = [50, 149].map(|column| picture[75 * COLUMNS + column]);
        assert!(
            clean.abs_diff(128) <= 1 && dirty.abs_diff(77) <= 1,
            "{clean} {dirty}"
        );
    }
    let deviation = |a: &[u8], b: &[u8]| {
        let pairs = a
            .iter()
            .zip(b)
            .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2));
        (pairs.sum::<f64>() / a.len() as f64).sqrt()
    };
    scene.film = Film::default();
    let even = pictures(&scene, 1);
    // Twice the variance of a sensor with half the electrons, from picture to picture.
    let noise = PhotonTransfer {
        full_well: 5_000.0,
        read_noise: 12.0,
    };
    scene.sensor.noise = Some(noise);
    let [first, second] = [1, 2].map(|seed| pictures(&scene, seed));
    for (a, b) in first.iter().zip(&second) {
        let wanted = (2.0 * noise.variance(102.0)).sqrt();
        let seen = deviation(a, b);
        assert!((seen / wanted - 1.0).abs() < 0.05, "{seen} for {wanted}");
    }
    // A pattern is the same in all pictures.
    scene.sensor = Sensor {
        noise: None,
        pattern: 0.05,
        seed: 3,
    };
    let [first, second] = [1, 2].map(|seed| pictures(&scene, seed));
    for ((a, b), even) in first.iter().zip(&second).zip(&even) {
        assert!(deviation(a, b) < 0.5, "{}", deviation(a, b));
        let seen = deviation(a, even);
        assert!((seen / (0.05 * 102.0) - 1.0).abs() < 0.05, "{seen}");
    }
}

/// The band bends as the field does.
#[test]
fn a_curved_field_focuses_nearer_in_the_corners() {
    let texture = Texture::new(Finish::Plain, 3);
    let plate = PlateSeam {
        height_mm: 0.0,
        pitch: 0.0,
        roll: 0.0,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.0,
    };
    let mut scene = Scene {
        smear_mm: SMEAR_MM,
        curvature_mm: 0.2,
        ..Scene::new(Joint::Gap(Gap::new(plate)), texture)
    };
    let mut fast = renderer([texture; 2]);
    // Rows in which neighbours differ, by the sum of squares; in mm of depth, which at 45° is that along the rows.
    let mut sums = [[[0.0; 2]; 2]; 2];
    for place in 0..8 {
        scene.position_mm = [1.1 * f64::from(place), 0.57 * f64::from(place)];
        for (sums, picture) in sums.iter_mut().zip(both(&mut fast, &scene)) {
            for (k, columns) in [80..120, 160..200].into_iter().enumerate() {
                for row in 0..ROWS {
                    let line = &picture[row * COLUMNS..][columns.clone()];
                    let energy: f64 = line
                        .windows(3)
                        .map(|v| (f64::from(v[2]) - f64::from(v[0])).powi(4))
                        .sum();
                    sums[k][0] += energy;
                    sums[k][1] += energy * (row as f64 - 74.5) * 0.0069;
                }
            }
        }
    }
    for sums in sums {
        let [middle, border] = sums.map(|[energy, moment]| moment / energy);
        // Half of the curvature at four fifths of the way to the border, squared.
        let wanted = -0.1 * 0.8f64.powi(2);
        assert!((border - middle - wanted).abs() < 0.02, "{middle} {border}");
    }
}
