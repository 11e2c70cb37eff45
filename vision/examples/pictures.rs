//! Writes rendered pictures to try `seamwright measure` on:
//! `cargo run --release -p seamwright-vision --example pictures -- FOLDER`.

use std::path::Path;
use vision::render::{Blob, Finish, Gap, Joint, Light, Root, Scene, Stripe, Texture, TruthRenderer};
use vision::{Corner, Optics, PhotonTransfer, PlateSeam};

fn main() {
    let folder = std::env::args().nth(1).expect("a folder to write to");
    std::fs::create_dir_all(&folder).expect("a folder");
    // The camera of machines/dual-beam-gantry.toml.
    let optics = Optics {
        magnification: 2.0,
        pixel_mm: 0.0138,
        tilt_rad: 45f64.to_radians(),
        aperture: 0.10,
        wavelength_mm: 0.000_53,
        rows: 300,
        columns: 400,
    };
    let noise = PhotonTransfer {
        full_well: 20_000.0,
        read_noise: 15.0,
    };
    let mut renderer = TruthRenderer::new(optics, noise, 3).expect("a camera");
    for (seed, (name, scene)) in scenes().into_iter().enumerate() {
        let pixels = renderer.render(&scene, seed as u64);
        let path = Path::new(&folder).join(format!("{name}.png"));
        write(&path, &pixels, &optics);
        println!("{}: {:?}", path.display(), scene.joint);
    }
}

/// A ground plate with a gap 0.12 mm wide, a little high and rolled; and what may happen to it. A corner, ground too.
fn scenes() -> Vec<(&'static str, Scene)> {
    let plate = PlateSeam {
        height_mm: 0.06,
        pitch: 0.0,
        roll: 3f64.to_radians().tan(),
        lateral_mm: 0.08,
        yaw_rad: 2f64.to_radians(),
        width_mm: 0.12,
    };
    let gap = |plate| {
        Joint::Gap(Gap {
            roughness_mm: 0.003,
            ..Gap::new(plate)
        })
    };
    let ground = Texture::new(Finish::Plain, 5);
    let seam = Scene {
        light: Light {
            shading: [0.1, -0.1, 0.2],
            ..Light::even(0.45)
        },
        smear_mm: 0.0075,
        ..Scene::new(gap(plate), ground)
    };
    let scratch = |offset_mm, width_mm, factor| Stripe {
        offset_mm,
        width_mm,
        factor,
    };
    let root = Root {
        interreflection: 0.2,
        ..Root::new(Corner {
            height_mm: -0.15,
            lateral_mm: 0.05,
            walls: [-1.0, 1.0],
        })
    };
    vec![
        ("seam", seam.clone()),
        (
            "rolled",
            Scene {
                texture: Texture::new(Finish::Rolled, 6),
                ..seam.clone()
            },
        ),
        (
            "scratches",
            Scene {
                stripes: vec![
                    scratch(-0.25, 0.03, 0.4),
                    scratch(0.2, 0.02, 0.5),
                    scratch(0.35, 0.015, 1.6),
                ],
                ..seam.clone()
            },
        ),
        (
            "spatter",
            Scene {
                blobs: vec![Blob {
                    middle_mm: [0.08, 0.12],
                    radius_mm: 0.13,
                    brightness: 0.05,
                }],
                ..seam.clone()
            },
        ),
        (
            "closed",
            Scene {
                joint: gap(PlateSeam {
                    width_mm: 0.0,
                    ..plate
                }),
                ..seam.clone()
            },
        ),
        (
            "out-of-view",
            Scene {
                joint: gap(PlateSeam {
                    height_mm: 0.95,
                    ..plate
                }),
                ..seam.clone()
            },
        ),
        (
            "dark",
            Scene {
                light: Light::even(0.0),
                ..seam.clone()
            },
        ),
        (
            "overexposed",
            Scene {
                light: Light::even(1.6),
                ..seam.clone()
            },
        ),
        (
            "corner",
            Scene {
                joint: Joint::Corner(root),
                stripes: vec![scratch(0.0, 0.02, 0.3)],
                ..seam
            },
        ),
    ]
}

fn write(path: &Path, pixels: &[u8], optics: &Optics) {
    let file = std::fs::File::create(path).expect("a file to write");
    let mut encoder = png::Encoder::new(file, optics.columns as u32, optics.rows as u32);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(pixels).expect("a picture");
}
