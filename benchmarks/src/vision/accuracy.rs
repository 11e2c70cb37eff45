//! How far measured seams are off, against the truth renderer.

use super::{NOISE, camera};
use anyhow::Result;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use vision::render::{
    Errors, Finish, Joint as Work, RandomRun, Scene, Shown, Texture, TruthRenderer, random_corner,
};
use vision::{
    Detector, Doubt, Image, Joint, Moved, Observation, Observer, ObserverConfig, Optics, Profile, Walls,
};

/// Pictures of one seam; the first of them acquire it.
const RUN: u64 = 10;

/// Pictures of a corner in which its walls are learnt, and those that count.
const LEARNING: u64 = 48;
const LEARNT: u64 = 24;

/// Samples a pixel of the truth.
const SAMPLES: usize = 3;

/// Share of the pictures that is taken for each other aperture.
const APERTURES: [f64; 2] = [0.07, 0.13];
const FEWER: u64 = 8;

/// One picture that was observed.
struct Taken {
    scene: Scene,
    seen: Observation,
    errors: Option<Errors>,
}

/// A group of pictures, and whether one belongs to it.
type Group = (&'static str, fn(&Scene) -> bool);

/// The groups of gaps.
const GROUPS: [Group; 18] = [
    ("all", |_| true),
    ("normal textures", |scene| {
        !matches!(scene.texture.finish, Finish::Faint | Finish::Coarse)
    }),
    ("plain", |scene| scene.texture.finish == Finish::Plain),
    ("rolled", |scene| scene.texture.finish == Finish::Rolled),
    ("blasted", |scene| scene.texture.finish == Finish::Blasted),
    ("specular", |scene| scene.texture.finish == Finish::Specular),
    ("faint", |scene| scene.texture.finish == Finish::Faint),
    ("coarse", |scene| scene.texture.finish == Finish::Coarse),
    ("width below 0.05 mm", |scene| width(scene) < 0.05),
    ("width 0.05–0.12 mm", |scene| {
        (0.05..0.12).contains(&width(scene))
    }),
    ("width above 0.12 mm", |scene| width(scene) >= 0.12),
    ("below 7 m/min", |scene| scene.smear_mm < 0.00583),
    ("above 7 m/min", |scene| scene.smear_mm >= 0.00583),
    ("roll below 5°", |scene| roll(scene).abs() < 0.0875),
    ("roll above 5°", |scene| roll(scene).abs() >= 0.0875),
    ("height within ±0.1 mm", |scene| height(scene).abs() < 0.1),
    ("height beyond ±0.1 mm", |scene| height(scene).abs() >= 0.1),
    ("spatter", |scene| !scene.blobs.is_empty()),
];

fn width(scene: &Scene) -> f64 {
    match &scene.joint {
        Work::Gap(gap) => gap.plate.width_mm,
        Work::Corner(_) => 0.0,
    }
}

fn roll(scene: &Scene) -> f64 {
    match &scene.joint {
        Work::Gap(gap) => gap.plate.roll,
        Work::Corner(_) => 0.0,
    }
}

fn height(scene: &Scene) -> f64 {
    match &scene.joint {
        Work::Gap(gap) => gap.plate.height_mm,
        Work::Corner(root) => root.corner.height_mm,
    }
}

/// Renders and observes about that many pictures of gaps, and a part of that of corners; prints a line of cells, parted by
/// tabs, for every group of pictures: first "gap" or "corner".
pub fn run(pictures: u64) -> Result<()> {
    let optics = camera(400);
    let taken = gaps(optics, pictures)?;
    for (name, belongs) in GROUPS {
        print_gaps(name, taken.iter().filter(|taken| belongs(&taken.scene)), &optics);
    }
    for aperture in APERTURES {
        let optics = Optics { aperture, ..optics };
        let taken = gaps(optics, pictures / FEWER)?;
        print_gaps(&format!("aperture {aperture:.2}"), taken.iter(), &optics);
    }
    for finish in Finish::ALL {
        print_corners(finish, optics, pictures.div_ceil(2000) * 4)?;
    }
    Ok(())
}

/// What `task` makes of seeds, on all cores.
fn of_seeds<T: Send>(count: u64, task: impl Fn(u64) -> Result<Vec<T>> + Sync) -> Result<Vec<T>> {
    let next = AtomicU64::new(0);
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let results: Vec<Result<Vec<T>>> = thread::scope(|scope| {
        let worker = || {
            let mut all = Vec::new();
            loop {
                let seed = next.fetch_add(1, Ordering::Relaxed);
                if seed >= count {
                    return Ok(all);
                }
                all.extend(task(seed)?);
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined
            .map(|result| result.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    Ok(results
        .into_iter()
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .flatten()
        .collect())
}

fn gaps(optics: Optics, pictures: u64) -> Result<Vec<Taken>> {
    of_seeds(pictures.div_ceil(RUN), |seed| {
        let mut renderer = TruthRenderer::new(optics, NOISE, SAMPLES)?;
        let detector = Detector::new(optics, NOISE, Profile::expected(&optics))?;
        let mut observer = Observer::new(detector, ObserverConfig::default(), Joint::Gap);
        let run = RandomRun::new(10_000 + seed, &optics).zip(0..RUN);
        run.map(|((scene, moved), k)| {
            let pixels = renderer.render(&scene, seed * RUN + k);
            let seen = observer.observe(&Image::new(&pixels, optics.rows, optics.columns)?, moved)?;
            let errors = scene.errors(&seen, &optics);
            Ok(Taken { scene, seen, errors })
        })
        .collect()
    })
}

fn print_gaps<'a>(name: &str, taken: impl Iterator<Item = &'a Taken>, optics: &Optics) {
    let (mut pictures, mut shown, mut believed, mut wrong) = (0, 0, 0, 0);
    let mut errors = Vec::new();
    for taken in taken {
        pictures += 1;
        let truth = taken.scene.truth(optics);
        if truth.is_none_or(|truth| truth.shown != Shown::Seam) {
            wrong += usize::from(taken.seen.seam.is_some());
        } else if taken.seen.doubt != Some(Doubt::New) {
            shown += 1;
            believed += usize::from(taken.errors.is_some());
            errors.extend(taken.errors);
        }
    }
    let of = |figure: fn(&Errors) -> f64| errors.iter().map(figure).collect::<Vec<f64>>();
    let (lateral, height) = (of(|errors| errors.lateral_mm), of(|errors| errors.height_mm));
    let means: Vec<f64> = errors
        .iter()
        .filter_map(|errors| errors.mean_mm)
        .map(|[_, height]| height)
        .collect();
    let share = 100.0 * f64::from(believed as u32) / f64::from(shown.max(1) as u32);
    let cells = [
        "gap".to_owned(),
        name.to_owned(),
        pictures.to_string(),
        format!("{share:.1}"),
        wrong.to_string(),
        micrometres(rms(&lateral)),
        micrometres(quantile(&lateral, 0.99)),
        micrometres(quantile(&lateral, 1.0)),
        micrometres(rms(&height)),
        micrometres(quantile(&means, 0.99)),
        micrometres(mean(&height)),
        micrometres(rms(&of(|errors| errors.width_mm))),
        format!("{:.3}", rms(&of(|errors| errors.roll))),
    ];
    println!("{}", cells.join("\t"));
}

/// Corners of a finish whose walls are told wrong by 0.015 and learnt.
fn print_corners(finish: Finish, optics: Optics, corners: u64) -> Result<()> {
    let runs: Vec<Vec<Errors>> = of_seeds(corners, |seed| {
        let mut renderer = TruthRenderer::new(optics, NOISE, 1)?;
        let detector = Detector::new(optics, NOISE, Profile::expected(&optics))?;
        let mut scene = random_corner(seed, &optics);
        let walls = scene.truth(&optics).map_or([0.0; 2], |truth| truth.walls);
        let off = [0.015, if seed % 2 == 0 { 0.015 } else { -0.015 }];
        let walls = Walls {
            slopes: [walls[0] + off[0], walls[1] + off[1]],
            sigma: 0.01,
        };
        let mut observer = Observer::new(detector, ObserverConfig::default(), Joint::Corner(walls));
        let mut errors = Vec::new();
        for k in 0..LEARNING + LEARNT {
            // A texture repeats after nine pictures; the next is another piece.
            scene.texture = Texture::new(finish, 100 * seed + k / 9);
            scene.position_mm[0] += 0.75;
            let moved = Moved {
                travel_mm: 0.75,
                ..Moved::default()
            };
            let pixels = renderer.render(&scene, 1000 * seed + k);
            let seen = observer.observe(&Image::new(&pixels, optics.rows, optics.columns)?, moved)?;
            errors.extend(scene.errors(&seen, &optics).filter(|_| k >= LEARNING));
        }
        Ok(vec![errors])
    })?;
    let all: Vec<&Errors> = runs.iter().flatten().collect();
    let eights = |figure: fn(&Errors) -> f64| {
        let chunks = runs.iter().flat_map(|run| run.chunks_exact(8));
        chunks
            .map(|chunk| chunk.iter().map(figure).sum::<f64>() / 8.0)
            .collect::<Vec<f64>>()
    };
    let of = |figure: fn(&Errors) -> f64| all.iter().map(|errors| figure(errors)).collect::<Vec<f64>>();
    let (lateral, height) = (of(|errors| errors.lateral_mm), of(|errors| errors.height_mm));
    let taken = corners * LEARNT;
    let cells = [
        "corner".to_owned(),
        format!("{finish:?}").to_lowercase(),
        taken.to_string(),
        format!("{:.1}", 100.0 * all.len() as f64 / taken as f64),
        micrometres(rms(&lateral)),
        micrometres(quantile(&lateral, 1.0)),
        micrometres(rms(&eights(|errors| errors.lateral_mm))),
        micrometres(rms(&height)),
        micrometres(mean(&height)),
        micrometres(rms(&eights(|errors| errors.height_mm))),
    ];
    println!("{}", cells.join("\t"));
    Ok(())
}

fn micrometres(mm: f64) -> String {
    if mm.is_finite() {
        format!("{:.1}", 1000.0 * mm)
    } else {
        "–".to_owned()
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn rms(values: &[f64]) -> f64 {
    mean(&values.iter().map(|value| value * value).collect::<Vec<f64>>()).sqrt()
}

/// The magnitude that `share` of the values do not pass; not a number of none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    sorted
        .get((last * share).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}
