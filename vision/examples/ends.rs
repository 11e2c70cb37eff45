//! Looks for ends of the gap in random pictures, and prints how many are found, how far off they are, and how many are none.
//!
//! `cargo run --release -p seamwright-vision --features render --example ends -- [PICTURES] [FIRST SEED] [MAGNIFICATION]`

use vision::render::{Effect, Joint as Work, Scene, SplitMix64, Tack, TruthRenderer, random_joint};
use vision::{Detector, EndKind, Image, Joint, Optics, PhotonTransfer, Prior, Profile};

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

/// What is seen nearer to a true end than this is that end \[mm\].
const SAME_MM: f64 = 0.25;
/// What of an end has to be in the picture beyond it: of plates, of tacks \[mm\].
const BEYOND_MM: [f64; 2] = [0.35, 0.6];

/// What ends the gap of a plain joint, up to the border of the picture.
#[derive(Clone, Copy, Debug)]
enum Ended {
    BothPlates,
    OnePlate,
    Tack,
}

/// What a group of pictures shows.
#[derive(Clone, Copy, Debug)]
enum Group {
    Ended(Ended),
    Effect(Effect),
    /// One of the three, with a random effect.
    Mixed,
}

impl Ended {
    const ALL: [Self; 3] = [Self::BothPlates, Self::OnePlate, Self::Tack];

    /// Ends the gap anywhere up to `view` mm from the band, before it or behind it.
    fn give(self, scene: &mut Scene, view: f64, random: &mut SplitMix64) {
        let Work::Gap(gap) = scene.joint else { return };
        let band = scene.position_mm[0] + gap.plate.height_mm + gap.plate.roll * gap.plate.lateral_mm;
        let way = random.between(0.12, view - 0.1);
        let (there, gone) = if random.chance(0.5) {
            ([f64::NEG_INFINITY, band + way], [band + way, band + way + 4.0])
        } else {
            ([band - way, f64::INFINITY], [band - way - 4.0, band - way])
        };
        match self {
            Self::BothPlates => scene.sides.iter_mut().for_each(|side| side.reaches_mm = there),
            Self::OnePlate => scene.sides[usize::from(random.chance(0.5))].reaches_mm = there,
            Self::Tack => scene.tacks.push(Tack {
                reaches_mm: gone,
                width_mm: gap.plate.width_mm + random.between(0.05, 0.3),
                brightness: random.log_between(0.4, 1.6),
            }),
        }
    }
}

impl Group {
    fn scene(self, optics: &Optics, view: f64, seed: u64) -> Scene {
        let mut random = SplitMix64::new(seed ^ 0xe0d5);
        let mut any = |count: usize| (random.uniform() * count as f64) as usize;
        let (effect, ended) = match self {
            Self::Ended(ended) => (Effect::Plain, Some(ended)),
            Self::Effect(effect) => (effect, None),
            Self::Mixed => (Effect::ALL[any(Effect::ALL.len())], Some(Ended::ALL[any(3)])),
        };
        let mut scene = random_joint(&[effect], optics, NOISE, seed);
        if let Some(ended) = ended {
            ended.give(&mut scene, view, &mut random);
        }
        scene
    }
}

/// Ends of the gap on the work: the nearest behind a place along travel, and ahead of it \[mm\].
fn ends(scene: &Scene, place: f64) -> [Option<(EndKind, f64)>; 2] {
    let plates = scene.sides.iter().flat_map(|side| side.reaches_mm);
    let tacks = scene.tacks.iter().flat_map(|tack| tack.reaches_mm);
    let plates = plates.map(|end| (EndKind::Plate, end));
    let all: Vec<_> = plates.chain(tacks.map(|end| (EndKind::Closed, end))).collect();
    [false, true].map(|ahead| {
        let there = all
            .iter()
            .filter(|(_, end)| end.is_finite() && (*end > place) == ahead);
        let far = |end: &f64| (end - place).abs();
        there.min_by(|a, b| far(&a.1).total_cmp(&far(&b.1))).copied()
    })
}

#[derive(Default)]
struct Tally {
    pictures: usize,
    expected: usize,
    found: usize,
    other_kind: usize,
    none: usize,
    errors_um: Vec<f64>,
    ratios: Vec<f64>,
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len().saturating_sub(1) as f64 * share).round() as usize;
    sorted.get(place).copied().unwrap_or(0.0)
}

fn main() {
    let mut arguments = std::env::args()
        .skip(1)
        .map(|text| text.parse::<f64>().expect("a number"));
    let (count, first) = (
        arguments.next().unwrap_or(20.0) as u64,
        arguments.next().unwrap_or(1.0) as u64,
    );
    let optics = Optics {
        magnification: arguments.next().unwrap_or(2.0),
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
    println!("{count} pictures of each from seed {first}; errors in µm; error over its standard deviation");
    println!("| group | seams | ends | found | other kind | no end | rms | p95 | worst | ratio, p95 |");
    let groups = Ended::ALL.into_iter().map(Group::Ended);
    let groups = groups.chain(Effect::ALL.into_iter().map(Group::Effect));
    for group in groups.chain([Group::Mixed]) {
        let mut tally = Tally::default();
        for seed in first..first + count {
            let scene = group.scene(&optics, view, seed);
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
            let begin = scene.position_mm[0];
            let truth = ends(&scene, begin + measured.travel_mm);
            for (k, seen) in detector.gap_ends(measured).into_iter().enumerate() {
                let sign = if k == 0 { -1.0 } else { 1.0 };
                let is_in_view = |(kind, end): &(EndKind, f64)| {
                    let beyond = view - sign * (end - begin + measured.height_mm);
                    beyond > BEYOND_MM[usize::from(*kind == EndKind::Closed)]
                };
                let expected = truth[k].filter(is_in_view).is_some();
                tally.expected += usize::from(expected);
                let Some(seen) = seen else { continue };
                let off = |(_, end): &&(EndKind, f64)| seen.travel_mm - (end - begin);
                let Some(end) = truth.iter().flatten().find(|end| off(end).abs() < SAME_MM) else {
                    tally.none += 1;
                    continue;
                };
                tally.found += usize::from(expected);
                tally.other_kind += usize::from(end.0 != seen.kind);
                tally.errors_um.push(1e3 * off(&end));
                tally.ratios.push(off(&end) / seen.sigma_mm);
            }
        }
        let squares: f64 = tally.errors_um.iter().map(|error| error * error).sum();
        println!(
            "| {group:?} | {} | {} | {} | {} | {} | {:.1} | {:.1} | {:.1} | {:.1} |",
            tally.pictures,
            tally.expected,
            tally.found,
            tally.other_kind,
            tally.none,
            (squares / tally.errors_um.len().max(1) as f64).sqrt(),
            quantile(&tally.errors_um, 0.95),
            quantile(&tally.errors_um, 1.0),
            quantile(&tally.ratios, 0.95)
        );
    }
}
