//! The fast renderer shows what the truth renderer shows.

use std::sync::Arc;
use vision::render::{FastRenderer, Finish, Gap, Joint, Root, Scene, Stripe, Texture, Tile, TruthRenderer};
use vision::render::{RenderError, random_corner, random_gap};
use vision::{Corner, Detector, Image, Optics, PhotonTransfer, PlateSeam, Prior, Profile};

/// Hardly any noise but that of 8 bits.
const QUIET: PhotonTransfer = PhotonTransfer {
    full_well: 1e9,
    read_noise: 0.0,
};

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 10_000.0,
    read_noise: 10.0,
};

const ROWS: usize = 150;
const COLUMNS: usize = 200;

/// Travel during an exposure \[mm\].
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

/// A fast renderer of surfaces with these slopes left and right.
fn renderer(texture: Texture, noise: PhotonTransfer, slopes: [f64; 2]) -> FastRenderer {
    let tiles = slopes.map(|slope| Arc::new(Tile::new(texture, camera(), slope, SMEAR_MM).unwrap()));
    FastRenderer::new(tiles, noise).unwrap()
}

/// The same scene by both renderers, the fast one's first.
fn both(fast: &mut FastRenderer, scene: &Scene) -> [Vec<u8>; 2] {
    let fast = fast.render(scene, 1).unwrap().to_vec();
    [
        fast,
        TruthRenderer::new(camera(), QUIET, 3).unwrap().render(scene, 2),
    ]
}

fn scene(joint: Joint, texture: Texture) -> Scene {
    Scene {
        smear_mm: SMEAR_MM,
        ..Scene::new(joint, texture)
    }
}

fn closed(height_mm: f64, roll: f64) -> PlateSeam {
    PlateSeam {
        height_mm,
        pitch: 0.0,
        roll,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.0,
    }
}

fn v_joint() -> Corner {
    Corner {
        height_mm: -0.12,
        lateral_mm: 0.06,
        walls: [-0.65, 0.85],
    }
}

/// Lateral contrast by depth: mean square of the lateral difference over the mean square, in steps of 0.05 mm along the
/// rows from the band.
fn contrast(picture: &[u8], band: impl Fn(usize) -> f64, used: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut sums = [[0.0; 2]; 9];
    for row in 0..ROWS {
        for column in (2..COLUMNS - 2).filter(|&column| used(column)) {
            let bin = ((row as f64 - band(column)).abs() * 0.0069 / 0.05) as usize;
            if let Some(sum) = sums.get_mut(bin) {
                let v = |c: usize| f64::from(picture[row * COLUMNS + c]);
                sum[0] += (v(column + 1) - v(column - 1)).powi(2) - 2.0 / 12.0;
                sum[1] += v(column).powi(2);
            }
        }
    }
    sums.iter().map(|[energy, square]| energy / square).collect()
}

/// The mean of `contrast` over places on the work, by both renderers.
fn contrasts(
    scene: &Scene,
    band: impl Fn(usize) -> f64 + Copy,
    used: impl Fn(usize) -> bool + Copy,
) -> [Vec<f64>; 2] {
    let mut fast = renderer(scene.texture, QUIET, scene.truth(&camera()).unwrap().walls);
    let mut sums = [vec![0.0; 9], vec![0.0; 9]];
    for place in 0..6 {
        let scene = Scene {
            position_mm: [1.1 * place as f64, 0.57 * place as f64],
            ..scene.clone()
        };
        for (sum, picture) in sums.iter_mut().zip(both(&mut fast, &scene)) {
            let energies = contrast(&picture, band, used);
            sum.iter_mut().zip(energies).for_each(|(s, e)| *s += e / 6.0);
        }
    }
    sums
}

#[test]
fn contrast_falls_with_depth_as_in_truth() {
    for (finish, roll) in [
        (Finish::Plain, 0.0),
        (Finish::Rolled, 0.1),
        (Finish::Specular, -0.15),
    ] {
        let plate = closed(0.04, roll);
        let scene = scene(Joint::Gap(Gap::new(plate)), Texture::new(finish, 5));
        let features = plate.features(&camera()).unwrap();
        let band = |column: usize| features.band_row + features.band_slope * (column as f64 - 99.5);
        let [fast, truth] = contrasts(&scene, band, |_| true);
        for (bin, (fast, truth)) in fast.iter().zip(&truth).enumerate() {
            let tolerance = if bin < 6 { 0.15 } else { 0.3 };
            assert!(
                (fast / truth - 1.0).abs() < tolerance,
                "{finish:?} bin {bin}: {fast:.2e}, truth {truth:.2e}"
            );
        }
    }
}

#[test]
fn contrast_of_a_corner_falls_along_its_walls_as_in_truth() {
    let corner = v_joint();
    let scene = scene(Joint::Corner(Root::new(corner)), Texture::new(Finish::Plain, 8));
    let features = corner.features(&camera());
    let [vertex, root] = features.vertex;
    let band = |column: usize| {
        let from = column as f64 - root;
        vertex + features.band_slopes[usize::from(from > 0.0)] * from
    };
    let [fast, truth] = contrasts(&scene, band, |column| (column as f64 - root).abs() > 10.0);
    for (bin, (fast, truth)) in fast.iter().zip(&truth).enumerate() {
        let tolerance = if bin < 6 { 0.2 } else { 0.35 };
        assert!(
            (fast / truth - 1.0).abs() < tolerance,
            "bin {bin}: {fast:.2e}, truth {truth:.2e}"
        );
    }
}

#[test]
fn the_same_texture_is_at_the_same_place_as_in_truth() {
    let optics = camera();
    let texture = Texture::new(Finish::Coarse, 6);
    let plate = closed(0.03, 0.0);
    let band = plate.features(&optics).unwrap().band_row;
    let corner = v_joint();
    let features = corner.features(&optics);
    let [vertex, root] = features.vertex;
    let left = |column: usize| vertex + features.band_slopes[0] * (column as f64 - root);
    let on_plate: (Joint, &dyn Fn(usize) -> f64) = (Joint::Gap(Gap::new(plate)), &|_| band);
    let on_wall: (Joint, &dyn Fn(usize) -> f64) = (Joint::Corner(Root::new(corner)), &left);
    for (joint, band) in [on_plate, on_wall] {
        let mut scene = scene(joint, texture);
        let mut fast = renderer(texture, QUIET, scene.truth(&optics).unwrap().walls);
        for position in [[0.0, 0.0], [3.2, -0.45], [-11.3, 5.0]] {
            scene.position_mm = position;
            let [fast, truth] = both(&mut fast, &scene);
            let mut sums = [0.0; 3];
            for column in (40..root as usize - 10)
                .flat_map(|column| [column; 5])
                .enumerate()
            {
                let (row, column) = (band(column.1).round() as usize + column.0 % 5 - 2, column.1);
                let [x, y] =
                    [&fast, &truth].map(|picture| f64::from(picture[row * COLUMNS + column]) - 127.5);
                sums = [sums[0] + x * y, sums[1] + x * x, sums[2] + y * y];
            }
            let likeness = sums[0] / (sums[1] * sums[2]).sqrt();
            assert!(likeness > 0.9, "{joint:?} at {position:?}: likeness {likeness}");
        }
    }
}

/// What a dark line takes from a row: sum and middle over the columns.
fn deficit(row: &[u8]) -> [f64; 2] {
    let taken = row.iter().map(|&x| 1.0 - f64::from(x) / 200.0);
    let (sum, moment) = taken.enumerate().fold((0.0, 0.0), |(sum, moment), (column, x)| {
        (sum + x, moment + x * column as f64)
    });
    [sum, moment / sum]
}

#[test]
fn gaps_and_stripes_lie_where_they_do_in_truth() {
    let texture = Texture {
        contrast: 0.0,
        ..Texture::new(Finish::Plain, 1)
    };
    let mut fast = renderer(texture, QUIET, [0.0; 2]);
    for (u0, yaw, width, roll, step) in [
        (0.0, 0.0, 0.02, 0.0, 0.0),
        (0.2, 0.06, 0.1, 0.15, 0.05),
        (-0.3, -0.05, 0.25, -0.17, -0.03),
    ] {
        let plate = PlateSeam {
            lateral_mm: u0,
            yaw_rad: yaw,
            width_mm: width,
            ..closed(-0.05, roll)
        };
        let gap = Gap {
            step_mm: step,
            ..Gap::new(plate)
        };
        let mut scene = scene(Joint::Gap(gap), texture);
        scene.light.level = 200.0 / 255.0;
        scene.stripes.push(Stripe {
            offset_mm: width,
            width_mm: 0.015,
            factor: 0.5,
        });
        let [fast, truth] = both(&mut fast, &scene);
        for row in (0..ROWS).step_by(7) {
            let [fast, truth] = [&fast, &truth].map(|picture| deficit(&picture[row * COLUMNS..][..COLUMNS]));
            assert!(
                (fast[0] / truth[0] - 1.0).abs() < 0.03,
                "{width} row {row}: {fast:?} {truth:?}"
            );
            assert!(
                (fast[1] - truth[1]).abs() < 0.15,
                "{width} row {row}: {fast:?} {truth:?}"
            );
        }
        let furthest = fast
            .iter()
            .zip(&truth)
            .map(|(&f, &t)| f.abs_diff(t))
            .max()
            .unwrap();
        assert!(furthest <= 12, "{width}: {furthest} of 255 apart");
    }
}

#[test]
fn random_scenes_look_the_same_from_afar() {
    let optics = camera();
    let texture = Texture::new(Finish::Plain, 2);
    let [mut plates, mut walls] = [[0.0, 0.0], [-0.75, 0.75]].map(|slopes| renderer(texture, QUIET, slopes));
    for seed in 0..24 {
        for (kind, fast, mut scene) in [
            ("gap", &mut plates, random_gap(seed, &optics)),
            ("corner", &mut walls, random_corner(seed, &optics)),
        ] {
            scene.texture = texture;
            let [fast, truth] = both(fast, &scene);
            let mean = |picture: &[u8], row: usize, column: usize| {
                let rows = picture.chunks_exact(COLUMNS).skip(row).take(15);
                rows.flat_map(|row| &row[column..column + 20])
                    .map(|&x| f64::from(x))
                    .sum::<f64>()
                    / 300.0
            };
            let mut squares = 0.0;
            for block in 0..100 {
                let (row, column) = (block / 10 * 15, block % 10 * 20);
                squares += (mean(&fast, row, column) - mean(&truth, row, column)).powi(2) / 100.0;
            }
            assert!(
                squares.sqrt() < 5.0,
                "{kind} {seed}: blocks differ by {} of 255",
                squares.sqrt()
            );
        }
    }
}

#[test]
fn a_detector_measures_the_same_in_both() {
    let optics = camera();
    let texture = Texture::new(Finish::Plain, 4);
    let mut fast = renderer(texture, NOISE, [0.0; 2]);
    let mut truth = TruthRenderer::new(optics, NOISE, 3).unwrap();
    let mut detector = Detector::new(optics, NOISE, Profile::expected(&optics)).unwrap();
    let prior = Prior {
        joint: vision::Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let mut errors = [Vec::new(), Vec::new()];
    for seed in 0..60 {
        let mut scene = random_gap(seed, &optics);
        scene.texture = texture;
        let known = scene.truth(&optics).unwrap();
        let pictures = [
            fast.render(&scene, seed).unwrap().to_vec(),
            truth.render(&scene, seed),
        ];
        for (errors, picture) in errors.iter_mut().zip(pictures) {
            let picture = Image::new(&picture, ROWS, COLUMNS).unwrap();
            let report = detector.measure(&picture, &prior).unwrap();
            if let Some(seen) = report.seam() {
                let height = seen.plate_height_mm() - known.height_mm;
                errors.push([
                    seen.lateral_mm - known.centre_mm,
                    height,
                    seen.width_mm - known.width_mm,
                ]);
            }
        }
    }
    let accepted = errors.each_ref().map(Vec::len);
    assert!(
        accepted[0].abs_diff(accepted[1]) <= 4,
        "accepted {accepted:?} of 60"
    );
    for (k, what, limit) in [(0, "centre", 0.004), (1, "height", 0.009), (2, "width", 0.007)] {
        let [fast, truth] = errors.each_ref().map(|errors| {
            (errors.iter().map(|error| error[k].powi(2)).sum::<f64>() / errors.len() as f64).sqrt()
        });
        assert!(fast < limit && truth < limit, "{what}: {fast} and {truth} mm rms");
        assert!(
            (0.6..1.6).contains(&(fast / truth)),
            "{what}: {fast} and {truth} mm rms"
        );
    }
}

#[test]
fn noise_is_that_of_the_photons() {
    let texture = Texture::new(Finish::Plain, 2);
    let mut renderer = renderer(texture, NOISE, [0.0; 2]);
    let mut scene = scene(Joint::Gap(Gap::new(closed(0.0, 0.0))), texture);
    for level in [0.1, 0.6] {
        scene.light.level = level;
        let [a, b] = [1, 2].map(|seed| renderer.render(&scene, seed).unwrap().to_vec());
        let pairs = || a.iter().zip(&b).map(|(&a, &b)| (f64::from(a), f64::from(b)));
        let count = a.len() as f64;
        let mean = pairs().map(|(a, b)| a + b).sum::<f64>() / count / 2.0;
        let variance = pairs().map(|(a, b)| (a - b).powi(2)).sum::<f64>() / count / 2.0;
        assert!(
            (variance / NOISE.variance(mean) - 1.0).abs() < 0.06,
            "{level}: {variance}"
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_picture_and_another_texture_none() {
    let optics = camera();
    let texture = Texture::new(Finish::Blasted, 2);
    let mut renderer = renderer(texture, QUIET, [0.0; 2]);
    let mut first = random_gap(3, &optics);
    assert_eq!(renderer.render(&first, 1), Err(RenderError::Texture));
    first.texture = texture;
    let picture = renderer.render(&first, 1).unwrap().to_vec();
    let mut other = random_corner(4, &optics);
    other.texture = texture;
    assert_ne!(renderer.render(&other, 1).unwrap(), picture);
    assert_eq!(renderer.render(&first, 1).unwrap(), picture);
}

#[test]
fn the_texture_moves_with_the_work() {
    let texture = Texture::new(Finish::Plain, 2);
    let mut renderer = renderer(texture, QUIET, [0.0; 2]);
    let mut scene = scene(Joint::Gap(Gap::new(closed(0.0, 0.0))), texture);
    let g = camera().object_pixel_mm();
    let before = renderer.render(&scene, 1).unwrap().to_vec();
    scene.position_mm = [4.0 * g / camera().tilt_rad.cos(), 3.0 * g];
    let after = renderer.render(&scene, 1).unwrap();
    // Rows as far above the band as below it afterwards are blurred alike.
    let pairs = before[77 * COLUMNS + 3..][..COLUMNS - 3]
        .iter()
        .zip(&after[73 * COLUMNS..]);
    let furthest = pairs.map(|(&b, &a)| b.abs_diff(a)).max().unwrap();
    assert!(furthest <= 14, "{furthest} of 255 apart");
}
