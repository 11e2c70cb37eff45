//! How far measured seams are off in pictures of joints with what real ones have, by the fast renderer: one effect at a
//! time, mixed, and coming and going from picture to picture.

use super::figures::{micrometres, quantile, rms};
use super::seeds::of_seeds;
use super::{NOISE, camera};
use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::sync::Arc;
use vision::render::{Effect, FastRenderer, Finish, Scene, Shown, SplitMix64, Texture, Tile, random_joint};
use vision::{Detector, Image, Joint, Measured, Optics, Prior, Profile, Report, Track};

/// Finishes of the plates, one after the other.
const FINISHES: [Finish; 4] = [Finish::Plain, Finish::Rolled, Finish::Blasted, Finish::Specular];

/// Pictures that share the texture of their plates, and how many such textures there are at most and at least: to make
/// one takes as long as to measure some hundred pictures.
const SHARE: u64 = 400;
const TEXTURES: [u64; 2] = [16, 128];

/// Every so many textures are smeared by long exposures.
const SMEARED: u64 = 8;

/// Pictures with several effects, for one with each effect alone.
const MIXED: u64 = 12;

/// Seeds of a texture.
const SEEDS: u64 = 1_000_000;

/// As far ahead and behind there has to be a seam, or none, for a picture to count as one with or without \[mm\].
const CLEAR_MM: f64 = 0.12;

/// More than this nothing may be off that is accepted: centre and height \[mm\].
const WRONG_MM: [f64; 2] = [0.05, 0.06];

/// What is measured of which pictures.
pub struct Options {
    /// About so many pictures.
    pub pictures: u64,
    /// Of the first texture.
    pub first: u64,
    /// Only these effects; all of them and mixtures if there is none.
    pub only: Vec<Effect>,
    /// Magnification of the lens.
    pub magnification: f64,
    /// Whether the detector knows from the picture before where the seam is.
    pub tracked: bool,
}

/// What is in the pictures of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One effect.
    Alone(Effect),
    /// Two to four, and a seam.
    Mixed,
    /// One to four, and no seam.
    Seamless,
}

/// A group of pictures and its name.
pub(super) type Group = (String, Kind);

/// What leaves no seam.
const SEAMLESS: [Effect; 4] = [
    Effect::Closed,
    Effect::ClosedScratched,
    Effect::ClosedGrooved,
    Effect::OnePlate,
];

/// What became of a picture.
struct Taken {
    group: usize,
    seed: u64,
    effects: Vec<Effect>,
    /// Whether there is a seam; none if it begins or ends.
    shown: Option<bool>,
    /// What was accepted: errors, and standard deviations as told, of centre, height, width, step \[mm\] and roll.
    accepted: Option<([f64; 5], [f64; 5])>,
    quality: f64,
    /// Why not, of what was refused.
    refused: Option<String>,
}

impl Options {
    /// Understands `PICTURES [--first SEED] [--magnification M] [--tracked] [EFFECT…]`.
    pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self> {
        let pictures = arguments.next().context("how many pictures?")?;
        let mut options = Self {
            pictures: pictures.parse().context("how many pictures?")?,
            first: 0,
            only: Vec::new(),
            magnification: 4.0,
            tracked: false,
        };
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--tracked" => options.tracked = true,
                "--magnification" => {
                    options.magnification = arguments.next().context("which magnification?")?.parse()?;
                }
                "--first" => options.first = arguments.next().context("which is first?")?.parse()?,
                name => options.only.push(effect(name)?),
            }
        }
        Ok(options)
    }

    /// Groups of pictures: their names, and the effect if it is one alone.
    pub(super) fn groups(&self) -> Vec<Group> {
        let all = if self.only.is_empty() {
            &Effect::ALL[..]
        } else {
            &self.only[..]
        };
        let mut groups: Vec<Group> = all
            .iter()
            .map(|effect| (format!("{effect:?}"), Kind::Alone(*effect)))
            .collect();
        if self.only.is_empty() {
            groups.push(("mixed, 2–4".to_owned(), Kind::Mixed));
            groups.push(("mixed, no seam".to_owned(), Kind::Seamless));
        }
        groups
    }
}

/// The effect of that name.
fn effect(name: &str) -> Result<Effect> {
    let named = |effect: &&Effect| format!("{effect:?}").eq_ignore_ascii_case(name);
    match Effect::ALL.iter().find(named) {
        Some(effect) => Ok(*effect),
        None => bail!("there is no effect {name}; there are {:?}", Effect::ALL),
    }
}

/// A renderer of plates with textures that belong to `number`.
pub(super) fn renderer(optics: Optics, number: u64, smear_mm: f64) -> Result<(FastRenderer, [Texture; 2])> {
    let finish = FINISHES[(number % FINISHES.len() as u64) as usize];
    let mut random = SplitMix64::new(number);
    let textures = [0; 2].map(|_| Texture::new(finish, random.bits()));
    let tile = |texture| Tile::new(texture, optics, 0.0, smear_mm).map(Arc::new);
    let tiles = [tile(textures[0])?, tile(textures[1])?];
    Ok((FastRenderer::new(tiles, NOISE)?, textures))
}

/// Renders and measures them, and prints a table with a line for each group, and the seeds of what is wrong.
pub fn run(options: &Options) -> Result<()> {
    let optics = Optics {
        magnification: options.magnification,
        ..camera(400)
    };
    let groups = options.groups();
    let textures = (options.pictures / SHARE).clamp(TEXTURES[0], TEXTURES[1]);
    let weight = |group: &Group| match group.1 {
        Kind::Alone(_) => 1,
        Kind::Mixed | Kind::Seamless => MIXED,
    };
    let weights: u64 = groups.iter().map(weight).sum();
    let share = (options.pictures as f64 / (textures * weights) as f64)
        .round()
        .max(1.0) as u64;
    let taken = of_seeds("textures", textures, |number| {
        let number = options.first + number;
        let smeared = number % SMEARED == SMEARED - 1;
        let mut random = SplitMix64::new(!number);
        let smear_mm = if smeared {
            random.between(0.015, 0.04)
        } else {
            random.between(0.004, 0.0075)
        };
        let (mut renderer, textures) = renderer(optics, number, smear_mm)?;
        let mut detector = Detector::new(optics, NOISE, Profile::expected(&optics))?;
        let mut all = Vec::new();
        let mut seed = number * SEEDS;
        for (k, group) in groups.iter().enumerate() {
            let count = match group.1 {
                // What is smeared has its own textures.
                Kind::Alone(Effect::Smear) if smeared => share * SMEARED,
                Kind::Alone(Effect::Smear) => 0,
                Kind::Alone(_) if smeared => 0,
                _ => share * weight(group),
            };
            for _ in 0..count {
                seed += 1;
                let effects = mixture(group, &mut random, smeared);
                let mut scene = random_joint(&effects, &optics, NOISE, seed);
                (scene.texture, scene.right_texture) = (textures[0], Some(textures[1]));
                let pixels = renderer.render(&scene, seed)?;
                let prior = Prior {
                    joint: Joint::Gap,
                    track: options.tracked.then(|| track(&scene, &optics, &mut random)),
                    focus: 0.0,
                };
                let image = Image::new(pixels, optics.rows, optics.columns)?;
                let report = detector.measure(&image, &prior)?;
                all.push(Taken {
                    group: k,
                    seed,
                    effects,
                    shown: shown(&scene, &optics),
                    accepted: report.seam().and_then(|seen| compared(&scene, &optics, seen)),
                    quality: report.measured.map_or(0.0, |seen| seen.quality),
                    refused: report.seam().is_none().then(|| reason(&report)),
                });
            }
        }
        Ok(all)
    })?;
    print(&groups, &taken);
    Ok(())
}

/// Effects of a picture of a group.
pub(super) fn effects_of(group: &Group, random: &mut SplitMix64) -> Vec<Effect> {
    match group.1 {
        Kind::Alone(effect) => vec![effect],
        Kind::Mixed => Effect::mixed(random),
        Kind::Seamless => {
            let mut effects = Effect::mixed(random);
            // The last has the last word.
            let last = effects.len() - 1;
            effects[last] = SEAMLESS[(random.uniform() * SEAMLESS.len() as f64) as usize];
            effects
        }
    }
}

/// The same; long exposures have their own textures.
fn mixture(group: &Group, random: &mut SplitMix64, smeared: bool) -> Vec<Effect> {
    loop {
        let effects = effects_of(group, random);
        if effects.contains(&Effect::Smear) == smeared || group.1 == Kind::Seamless {
            return effects;
        }
    }
}

/// Whether a scene shows a seam; none where it begins or ends.
pub(super) fn shown(scene: &Scene, optics: &Optics) -> Option<bool> {
    let mut scene = scene.clone();
    let middle = scene.position_mm[0];
    let mut seam = |off: f64| {
        scene.position_mm[0] = middle + off;
        scene
            .truth(optics)
            .is_some_and(|truth| truth.shown == Shown::Seam)
    };
    let near = [-CLEAR_MM, 0.0, CLEAR_MM].map(&mut seam);
    near.iter().all(|at| *at == near[0]).then_some(near[0])
}

/// Errors and standard deviations of a measurement.
pub(super) fn compared(scene: &Scene, optics: &Optics, seen: &Measured) -> Option<([f64; 5], [f64; 5])> {
    let truth = scene.truth(optics)?;
    let row_mm = (truth.seam[0] - optics.centre()[0]) * optics.object_pixel_mm();
    let step_mm = match &scene.joint {
        vision::render::Joint::Gap(gap) => gap.step_mm,
        vision::render::Joint::Corner(_) => 0.0,
    };
    let errors = [
        seen.lateral_mm - truth.centre_mm,
        seen.height_mm - row_mm * optics.tilt_rad.sin(),
        seen.width_mm - truth.width_mm,
        seen.step_mm - step_mm,
        seen.roll - truth.roll,
    ];
    let told = &seen.sigma;
    let sigma = [
        told.lateral_mm,
        told.height_mm,
        told.width_mm,
        told.step_mm,
        told.roll,
    ];
    Some((errors, sigma))
}

/// What the picture before would have told.
fn track(scene: &Scene, optics: &Optics, random: &mut SplitMix64) -> Track {
    let truth = scene.truth(optics);
    let of = |figure: fn(&vision::render::Truth) -> f64| truth.as_ref().map_or(0.0, figure);
    let [a, b] = random.gauss();
    let [c, d] = random.gauss();
    Track {
        lateral_mm: of(|truth| truth.centre_mm) + 0.01 * a,
        height_mm: of(|truth| truth.height_mm + truth.roll * truth.centre_mm) + 0.01 * b,
        roll: of(|truth| truth.roll) + 0.005 * c,
        width_mm: (of(|truth| truth.width_mm) + 0.005 * d).max(0.0),
    }
}

/// What a picture was refused for: the weakest criterion if a seam was measured at all, otherwise the status.
fn reason(report: &Report) -> String {
    match report.measured.and_then(|seen| seen.weakest) {
        Some(weakest) => format!("{weakest:?}"),
        None => format!("{:?}", report.status),
    }
}

fn is_wrong(taken: &Taken) -> bool {
    taken.accepted.is_some_and(|(errors, _)| {
        taken.shown == Some(false)
            || errors
                .iter()
                .zip(WRONG_MM)
                .any(|(error, most)| error.abs() > most)
    })
}

fn print(groups: &[Group], taken: &[Taken]) {
    println!(
        "Errors in µm, of roll in 1/1000; e/σ: what 95 % do not pass, of centre, height, width, step, roll.\n"
    );
    println!(
        "| effect | pictures | accepted % | centre rms | 99 % | worst | height rms | 99 % | worst | width rms | step rms | roll rms | e/σ u | h | w | t | q | without seam | wrong |"
    );
    println!("|---{}|", "|--:".repeat(18));
    let mut all: Vec<(&str, Vec<&Taken>)> = groups
        .iter()
        .enumerate()
        .map(|(k, (name, _))| {
            (
                name.as_str(),
                taken.iter().filter(|taken| taken.group == k).collect(),
            )
        })
        .collect();
    all.push(("all", taken.iter().collect()));
    for (name, group) in &all {
        println!("{}", line(name, group));
    }
    println!();
    for (name, group) in &all {
        println!("refused: {name}: {}", reasons(group));
    }
    println!();
    for (name, group) in all.iter().take(groups.len()) {
        let mut wrong: Vec<_> = group.iter().filter(|taken| is_wrong(taken)).collect();
        wrong.sort_by(|a, b| b.quality.total_cmp(&a.quality));
        for taken in wrong.iter().take(4) {
            let [centre, height, width, ..] = taken.accepted.unwrap_or_default().0.map(|mm| 1e3 * mm);
            let shown = if taken.shown == Some(false) {
                ", no seam"
            } else {
                ""
            };
            println!(
                "wrong: {name} {:?}, seed {}, quality {:.2}: centre {centre:.0}, height {height:.0}, width {width:.0} µm{shown}",
                taken.effects, taken.seed, taken.quality
            );
        }
    }
}

/// How many pictures with a seam were refused for what, most first.
fn reasons(group: &[&Taken]) -> String {
    let mut counts = BTreeMap::<&str, usize>::new();
    for taken in group.iter().filter(|taken| taken.shown == Some(true)) {
        if let Some(reason) = &taken.refused {
            *counts.entry(reason).or_default() += 1;
        }
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let counts = counts.iter().map(|(reason, count)| format!("{reason} {count}"));
    counts.collect::<Vec<_>>().join(", ")
}

/// A line of the table.
fn line(name: &str, group: &[&Taken]) -> String {
    let seams = group.iter().filter(|taken| taken.shown == Some(true));
    let accepted: Vec<_> = seams.clone().filter_map(|taken| taken.accepted).collect();
    let every = |k: usize| accepted.iter().map(|(errors, _)| errors[k]).collect::<Vec<f64>>();
    let ratio = |k: usize| {
        let ratios = accepted.iter().map(|(errors, sigma)| errors[k] / sigma[k]);
        quantile(&ratios.collect::<Vec<f64>>(), 0.95)
    };
    let without = group
        .iter()
        .filter(|taken| taken.shown == Some(false) && taken.accepted.is_some());
    let (centre, height) = (every(0), every(1));
    let mut cells = vec![
        name.to_owned(),
        group.len().to_string(),
        format!("{:.1}", 100.0 * accepted.len() as f64 / seams.count() as f64),
        micrometres(rms(&centre)),
        micrometres(quantile(&centre, 0.99)),
        micrometres(quantile(&centre, 1.0)),
        micrometres(rms(&height)),
        micrometres(quantile(&height, 0.99)),
        micrometres(quantile(&height, 1.0)),
        micrometres(rms(&every(2))),
        micrometres(rms(&every(3))),
        micrometres(rms(&every(4))),
    ];
    cells.extend((0..5).map(|k| format!("{:.1}", ratio(k))));
    cells.push(without.count().to_string());
    cells.push(group.iter().filter(|taken| is_wrong(taken)).count().to_string());
    format!("| {} |", cells.join(" | "))
}
