//! Looks for ends of the gap in random pictures, and prints how many are found, how far off, and how many are none.
//!
//! `cargo run --release -p seamwright-vision --features render --example ends -- [PICTURES] [FIRST SEED] [MAGNIFICATION]`

use vision::render::{Effect, Scene, SplitMix64, Tack, TruthRenderer, random_joint};
use vision::{Detector, EndKind, Image, Joint, Optics, PhotonTransfer, Prior, Profile};

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

/// Ends of the gap on the work \[mm\], each with its kind: the nearest behind a place, and ahead of it.
fn ends(scene: &Scene, place: f64) -> [Option<(EndKind, f64)>; 2] {
    let mut all = Vec::new();
    for side in &scene.sides {
        all.extend(side.reaches_mm.map(|end| (EndKind::Plate, end)));
    }
    for tack in &scene.tacks {
        all.extend(tack.reaches_mm.map(|end| (EndKind::Closed, end)));
    }
    let near = |ahead: bool| {
        let beyond = all
            .iter()
            .filter(|(_, end)| end.is_finite() && (*end > place) == ahead);
        beyond
            .min_by(|a, b| (a.1 - place).abs().total_cmp(&(b.1 - place).abs()))
            .copied()
    };
    [near(false), near(true)]
}

#[derive(Default)]
struct Tally {
    pictures: usize,
    expected: usize,
    found: usize,
    wrong_kind: usize,
    false_alarms: Vec<(u64, f64)>,
    errors: Vec<f64>,
    ratios: Vec<f64>,
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        0.0
    } else {
        sorted[((sorted.len() - 1) as f64 * share).round() as usize]
    }
}

fn main() {
    let arguments: Vec<f64> = std::env::args()
        .skip(1)
        .map(|text| text.parse().expect("a number"))
        .collect();
    let number = |k: usize, default: f64| arguments.get(k).copied().unwrap_or(default);
    let (count, first) = (number(0, 20.0) as u64, number(1, 1.0) as u64);
    let optics = Optics {
        magnification: number(2, 2.0),
        pixel_mm: 0.0138,
        tilt_rad: std::f64::consts::FRAC_PI_4,
        aperture: 0.10,
        wavelength_mm: 0.000_53,
        rows: 300,
        columns: 400,
    };
    let view = optics.rows as f64 * optics.object_pixel_mm() / optics.tilt_rad.cos() / 2.0;
    let mut detector = Detector::new(optics, NOISE, Profile::expected(&optics)).expect("a camera");
    let mut renderer = TruthRenderer::new(optics, NOISE, 1).expect("a renderer");
    println!(
        "{:<20} {:>4} {:>4} {:>5} {:>5} {:>5} {:>7} {:>7} {:>7} {:>6}",
        "effect", "seam", "ends", "found", "kind", "false", "rms", "p95", "max um", "ratio"
    );
    let mut groups: Vec<(String, usize)> = ["both plates", "one plate", "tack"]
        .iter()
        .enumerate()
        .map(|(k, x)| ((*x).to_owned(), k))
        .collect();
    groups.extend(
        Effect::ALL
            .iter()
            .enumerate()
            .map(|(k, effect)| (format!("{effect:?}"), 3 + k)),
    );
    groups.push(("ends + effect".to_owned(), 3 + Effect::ALL.len()));
    let only = std::env::var("ONLY").ok();
    for (name, group) in groups {
        if only.as_ref().is_some_and(|only| !name.contains(only.as_str())) {
            continue;
        }
        let mut tally = Tally::default();
        for seed in first..first + count {
            let mut random = SplitMix64::new(seed ^ 0xe0d5);
            let mixed = group == 3 + Effect::ALL.len();
            let effect = if mixed {
                Effect::ALL[(random.uniform() * Effect::ALL.len() as f64) as usize]
            } else if group >= 3 {
                Effect::ALL[group - 3]
            } else {
                Effect::Plain
            };
            let mut scene = random_joint(&[effect], &optics, NOISE, seed);
            let vision::render::Joint::Gap(gap) = scene.joint else {
                continue;
            };
            let band = scene.position_mm[0] + gap.plate.height_mm + gap.plate.roll * gap.plate.lateral_mm;
            let what = if mixed {
                (random.uniform() * 3.0) as usize
            } else {
                group
            };
            let way = random.between(0.12, view - 0.1);
            let ahead = random.chance(0.5);
            let reaches = if ahead {
                [f64::NEG_INFINITY, band + way]
            } else {
                [band - way, f64::INFINITY]
            };
            match what {
                0 => scene.sides.iter_mut().for_each(|side| side.reaches_mm = reaches),
                1 => scene.sides[usize::from(random.chance(0.5))].reaches_mm = reaches,
                2 => scene.tacks.push(Tack {
                    reaches_mm: if ahead {
                        [band + way, band + way + 4.0]
                    } else {
                        [band - way - 4.0, band - way]
                    },
                    width_mm: gap.plate.width_mm + random.between(0.05, 0.3),
                    brightness: random.log_between(0.4, 1.6),
                }),
                _ => {}
            }
            let pixels = renderer.render(&scene, seed);
            let image = Image::new(&pixels, optics.rows, optics.columns).expect("its size");
            let prior = Prior {
                joint: Joint::Gap,
                track: None,
                focus: 0.0,
            };
            let report = detector.measure(&image, &prior).expect("a picture");
            let Some(measured) = report.seam() else { continue };
            tally.pictures += 1;
            let place = scene.position_mm[0] + measured.travel_mm;
            let truth = ends(&scene, place);
            let seen = detector.gap_ends(measured);
            // How far the picture reaches at the seam.
            for k in 0..2 {
                let sign = if k == 0 { -1.0 } else { 1.0 };
                let border = view - sign * 0.0 * measured.travel_mm;
                let expected = truth[k].filter(|(kind, end)| {
                    let beyond = border - sign * (end - scene.position_mm[0]) - measured.height_mm * sign;
                    beyond > if *kind == EndKind::Plate { 0.35 } else { 0.6 }
                });
                tally.expected += usize::from(expected.is_some());
                let Some(end) = seen[k] else { continue };
                let near = truth
                    .iter()
                    .flatten()
                    .copied()
                    .find(|(_, at)| (at - scene.position_mm[0] - end.travel_mm).abs() < 0.25);
                match near {
                    Some((kind, at)) => {
                        let off = end.travel_mm - (at - scene.position_mm[0]);
                        tally.found += usize::from(expected.is_some());
                        tally.wrong_kind += usize::from(kind != end.kind);
                        if std::env::var("ERR").is_ok() {
                            println!(
                                "  {seed} {:?} at {:.3} off {off:.4} sigma {:.4} height {:.4} truth {:.4} yaw {:.3} q {:.2}",
                                end.kind,
                                end.travel_mm - measured.travel_mm,
                                end.sigma_mm,
                                measured.height_mm,
                                gap.plate.height_mm + gap.plate.roll * measured.lateral_mm,
                                gap.plate.yaw_rad,
                                measured.quality
                            );
                        }
                        tally.errors.push(1e3 * off);
                        tally.ratios.push(off / end.sigma_mm);
                    }
                    _ => tally
                        .false_alarms
                        .push((seed, end.travel_mm - measured.travel_mm)),
                }
            }
        }
        let rms = (tally.errors.iter().map(|x| x * x).sum::<f64>() / tally.errors.len().max(1) as f64).sqrt();
        println!(
            "{:<20} {:>4} {:>4} {:>5} {:>5} {:>5} {:>7.1} {:>7.1} {:>7.1} {:>6.1}  {}",
            name,
            tally.pictures,
            tally.expected,
            tally.found,
            tally.wrong_kind,
            tally.false_alarms.len(),
            rms,
            quantile(&tally.errors, 0.95),
            quantile(&tally.errors, 1.0),
            quantile(&tally.ratios, 0.95),
            tally
                .false_alarms
                .iter()
                .take(4)
                .map(|(seed, at)| format!("{seed}@{at:.2}"))
                .collect::<Vec<_>>()
                .join(" ")
        );
    }
}
