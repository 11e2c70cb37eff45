//! Writes rendered pictures for people to look at, the truth left and the fast renderer's right:
//! `cargo run --release -p seamwright-vision --example look -- FOLDER`.

use std::path::Path;
use std::sync::Arc;
use vision::render::{FastRenderer, Tile, TruthRenderer, random_corner, random_gap};
use vision::{Optics, PhotonTransfer};

fn main() {
    let folder = std::env::args().nth(1).expect("a folder to write to");
    let optics = Optics {
        magnification: 4.0,
        pixel_mm: 0.0138,
        tilt_rad: 45f64.to_radians(),
        aperture: 0.10,
        wavelength_mm: 0.000_55,
        rows: 300,
        columns: 400,
    };
    let noise = PhotonTransfer {
        full_well: 10_000.0,
        read_noise: 10.0,
    };
    let mut renderer = TruthRenderer::new(optics, noise, 3).expect("a camera");
    for seed in 0..6 {
        for (kind, scene) in [
            ("gap", random_gap(seed, &optics)),
            ("corner", random_corner(seed, &optics)),
        ] {
            let truth = renderer.render(&scene, seed);
            let walls = scene.truth(&optics).expect("a surface the camera sees").walls;
            let tile =
                |slope| Arc::new(Tile::new(scene.texture, optics, slope, scene.smear_mm).expect("a camera"));
            let mut fast = FastRenderer::new(walls.map(tile), noise).expect("tiles of one camera");
            let fast = fast.render(&scene, seed).expect("the tile's texture");
            let path = Path::new(&folder).join(format!("{kind}-{seed}.png"));
            let rows = truth
                .chunks_exact(optics.columns)
                .zip(fast.chunks_exact(optics.columns));
            write(
                &path,
                &rows
                    .flat_map(|(left, right)| [left, right].concat())
                    .collect::<Vec<u8>>(),
                &optics,
            );
            println!(
                "{}: {:?} {:?}",
                path.display(),
                scene.texture.finish,
                scene.truth(&optics)
            );
        }
    }
}

fn write(path: &Path, pixels: &[u8], optics: &Optics) {
    let file = std::fs::File::create(path).expect("a file to write");
    let mut encoder = png::Encoder::new(file, 2 * optics.columns as u32, optics.rows as u32);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(pixels).expect("a picture");
}
