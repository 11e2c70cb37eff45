//! The vision's own renderer shows joints as rays do, but for what it says that it leaves out.

use raytracer::{Camera, Effect, Exposure, Subject, Work, subject};
use vision::render::{
    Blob, Film, Finish, Gap, Glare, Joint, Light, Mark, Scene, Side, Texture, TruthRenderer,
};
use vision::{Optics, PhotonTransfer, PlateSeam};

const ROWS: usize = 150;
const COLUMNS: usize = 200;

/// The field of view of machines/dual-beam-gantry.toml in pixels twice as large.
const OPTICS: Optics = Optics {
    magnification: 4.0,
    pixel_mm: 0.0276,
    tilt_rad: std::f64::consts::FRAC_PI_4,
    aperture: 0.10,
    wavelength_mm: 0.000_53,
    rows: ROWS,
    columns: COLUMNS,
};

/// Hardly any noise but that of 8 bits.
const QUIET: PhotonTransfer = PhotonTransfer {
    full_well: 1e9,
    read_noise: 0.0,
};

/// The scene that shows the same work.
fn scene(work: &Work, exposure: &Exposure) -> Scene {
    // There a step goes along the plate's normal, here along the camera's n.
    let roll = work.roll;
    let gap = Gap {
        step_mm: work.step_mm * roll.hypot(1.0),
        brightness: 0.01,
        ..Gap::new(PlateSeam {
            height_mm: work.height_mm,
            pitch: 0.0,
            roll,
            lateral_mm: work.lateral_mm,
            yaw_rad: work.yaw_rad,
            width_mm: work.width_mm
                - if work.width_mm > 0.0 {
                    work.step_mm * roll
                } else {
                    0.0
                },
        })
    };
    let side = |k: usize| {
        let side = &work.sides[k];
        let shadow = work.shadows.iter().find(|shadow| shadow.side == k);
        Side {
            brightness: side.brightness,
            chamfer_mm: side.chamfer_mm,
            rounding_mm: side.rounding_mm,
            burr_mm: side.burr_mm,
            edge_factor: if side.chamfer_mm > 0.0 {
                side.chamfer_brightness
            } else {
                1.0
            },
            wall_brightness: side.wall_brightness,
            rim: side.rim,
            shadow: shadow.map_or([0.0, 1.0], |shadow| [shadow.width_mm, shadow.factor]),
            reaches_mm: [f64::NEG_INFINITY, side.ends_mm],
        }
    };
    let mark = |mark: &raytracer::Mark| Mark {
        at_mm: work.along_mm,
        slope: mark.slope,
        ..Mark::along(mark.offset_mm, mark.width_mm, mark.factor)
    };
    let blob = |blob: &raytracer::Blob| {
        let [a, across] = blob.middle_mm;
        // Seen past spatter that lies 10 µm above the plate, at 45°.
        let a = a + 0.01;
        Blob {
            middle_mm: [
                work.along_mm + a,
                work.lateral_mm + a * work.yaw_rad.tan() + across,
            ],
            radius_mm: blob.radius_mm,
            brightness: blob.brightness,
        }
    };
    let texture = Texture {
        contrast: 0.0,
        ..Texture::new(Finish::Plain, 1)
    };
    Scene {
        position_mm: [work.along_mm, 0.0],
        sides: [side(0), side(1)],
        marks: work.marks.iter().map(mark).collect(),
        blobs: work.blobs.iter().map(blob).collect(),
        light: Light {
            shading: [work.shading[0], work.shading[1], 0.0],
            ..Light::even(work.level)
        },
        film: Film {
            veil: work.veil,
            glares: work
                .glare
                .iter()
                .map(|glare| Glare {
                    middle: glare.middle,
                    radius: glare.radius,
                    level: glare.level,
                })
                .collect(),
            dirt: Vec::new(),
        },
        smear_mm: exposure.smear_mm,
        ..Scene::new(Joint::Gap(gap), texture)
    }
}

/// Work with that effect whose surface has no contrast of its own and whose edges are straight.
fn blank(effect: Effect, seed: u64) -> Subject {
    let mut subject = subject(&[effect], &OPTICS, QUIET, seed);
    subject.work.textures = [0, 1].map(|seed| raytracer::Texture::new(&[], false, seed));
    subject.work.roughness_mm = 0.0;
    subject.exposure.noise = QUIET;
    subject
}

/// Means of blocks of 5 × 5 pixels: in single ones rays are few.
fn means(picture: &[u8]) -> Vec<f64> {
    let block = |row: usize, column: usize| {
        let rows = picture.chunks_exact(COLUMNS).skip(row).take(5);
        let sum: f64 = rows
            .flat_map(|row| &row[column..column + 5])
            .map(|&x| f64::from(x))
            .sum();
        sum / 25.0
    };
    (0..ROWS / 5 * (COLUMNS / 5))
        .map(|k| block(k / (COLUMNS / 5) * 5, k % (COLUMNS / 5) * 5))
        .collect()
}

#[test]
fn joints_look_as_rays_see_them() {
    let camera = Camera::new(OPTICS, 32);
    let mut renderer = TruthRenderer::new(OPTICS, QUIET, 3).unwrap();
    for (effect, seed) in Effect::ALL.into_iter().zip([1, 2, 3].into_iter().cycle()) {
        let subject = blank(effect, seed);
        let rays = camera.picture(&subject.work, &subject.exposure);
        let own = renderer.render(&scene(&subject.work, &subject.exposure), 1);
        let [own, rays] = [&own, &rays].map(|picture| means(picture));
        let off = || own.iter().zip(&rays).map(|(own, rays)| (own - rays).abs());
        let mean = off().sum::<f64>() / off().count() as f64;
        let most = off().fold(0.0, f64::max);
        // In pictures full of marks and along bright lines a pixel is the mean of few different rays; at high steps and rolled
        // edges the cone of rays through the lens sees more of the wall than the ray in its middle.
        let limits = match effect {
            Effect::BrightEdges | Effect::BrightEdgesScratch => [0.6, 13.0],
            Effect::Grooves | Effect::ClosedGrooved => [0.8, 6.0],
            Effect::HighStep | Effect::RolledEdge => [0.4, 10.0],
            _ => [0.4, 6.0],
        };
        assert!(
            mean < limits[0] && most < limits[1],
            "{effect:?} {seed}: {mean} on the mean, {most} at most of 255"
        );
    }
}
