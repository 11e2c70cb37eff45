//! What measuring and rendering a picture costs.

use super::{NOISE, camera};
use crate::meter::Meter;
use crate::record::{Checksum, NOTHING, Record};
use anyhow::Result;
use std::hint::black_box;
use std::sync::Arc;
use vision::render::{FastRenderer, Scene, Tile, TruthRenderer, random_corner, random_gap};
use vision::{Detector, Image, Joint, Optics, Prior, Profile, Track, Walls};

/// Pixels a row of the cameras.
const COLUMNS: [usize; 3] = [200, 400, 800];

/// The widest whose pictures are rendered fast.
const RENDERED: usize = 400;

/// Pictures of each kind.
const PICTURES: usize = 3;

/// Measures pictures of all sizes in all modes, and prints what each call costs by `meter`.
pub fn run(meter: &mut impl Meter) -> Result<()> {
    let mut sum = Checksum::new();
    for columns in COLUMNS {
        let optics = camera(columns);
        let size = format!("{columns}×{}", optics.rows);
        let print = |function: &str, instructions: u32| {
            let subject = &size;
            println!(
                "{}",
                Record::Call {
                    subject,
                    function,
                    instructions
                }
            );
        };
        print(NOTHING, meter.count(&mut || {}));
        let mut detector = Detector::new(optics, NOISE, Profile::expected(&optics))?;
        let mut measure = |mode: &str, image: &Image, joint: Joint, track: Option<Track>| -> Result<()> {
            let prior = Prior {
                joint,
                track,
                focus: 0.0,
            };
            let mut report = None;
            let cost = meter.count(&mut || report = Some(detector.measure(image, &prior)));
            print(&mode.replace(' ', "_"), cost);
            let measured = report.transpose()?.and_then(|report| report.measured);
            sum.add(measured.map_or(0.0, |seen| seen.lateral_mm));
            Ok(())
        };
        for (scene, pixels) in pictures(optics, random_gap)? {
            let (track, walls) = known(&scene, &optics);
            let image = Image::new(&pixels, optics.rows, optics.columns)?;
            measure("gap, acquiring", &image, Joint::Gap, None)?;
            measure("gap, tracking", &image, Joint::Gap, Some(track))?;
            measure("either, tracking", &image, Joint::GapOrCorner(walls), Some(track))?;
        }
        for (scene, pixels) in pictures(optics, random_corner)? {
            let (track, walls) = known(&scene, &optics);
            let image = Image::new(&pixels, optics.rows, optics.columns)?;
            measure("corner, acquiring", &image, Joint::Corner(walls), None)?;
            measure("corner, tracking", &image, Joint::Corner(walls), Some(track))?;
            measure(
                "either, of a corner",
                &image,
                Joint::GapOrCorner(walls),
                Some(track),
            )?;
        }
        if columns <= RENDERED {
            let mut scenes = scenes(optics, random_gap);
            let texture = scenes[0].texture;
            let tile = Arc::new(Tile::new(texture, optics, 0.0, scenes[0].smear_mm)?);
            let mut renderer = FastRenderer::new([tile.clone(), tile], NOISE)?;
            for scene in &mut scenes {
                scene.texture = texture;
                let mut rendered = Ok(());
                let cost = meter.count(&mut || {
                    rendered = renderer.render(scene, 1).map(|pixels| {
                        black_box(pixels);
                    });
                });
                rendered?;
                print("rendering_fast", cost);
            }
        }
    }
    println!("{}", Record::Checksum(sum.sum()));
    Ok(())
}

/// The first scenes that show a seam.
fn scenes(optics: Optics, random: fn(u64, &Optics) -> Scene) -> Vec<Scene> {
    let all = (0..).map(|seed| random(seed, &optics));
    let shown = |scene: &Scene| {
        let truth = scene.truth(&optics);
        truth.is_some_and(|truth| truth.shown == vision::render::Shown::Seam)
    };
    all.filter(shown).take(PICTURES).collect()
}

/// Those scenes and their pictures.
fn pictures(optics: Optics, random: fn(u64, &Optics) -> Scene) -> Result<Vec<(Scene, Vec<u8>)>> {
    let mut renderer = TruthRenderer::new(optics, NOISE, 1)?;
    let scenes = scenes(optics, random).into_iter().enumerate();
    Ok(scenes
        .map(|(k, scene)| {
            let pixels = renderer.render(&scene, k as u64);
            (scene, pixels)
        })
        .collect())
}

/// What tracking knows of a scene.
fn known(scene: &Scene, optics: &Optics) -> (Track, Walls) {
    let truth = scene.truth(optics);
    let of = |figure: fn(&vision::render::Truth) -> f64| truth.as_ref().map_or(0.0, figure);
    let track = Track {
        lateral_mm: of(|truth| truth.centre_mm) + 0.01,
        height_mm: of(|truth| truth.height_mm + truth.roll * truth.centre_mm) - 0.01,
        roll: of(|truth| truth.roll),
        width_mm: of(|truth| truth.width_mm),
    };
    let walls = Walls {
        slopes: [of(|truth| truth.walls[0]), of(|truth| truth.walls[1])],
        sigma: 0.01,
    };
    (track, walls)
}
