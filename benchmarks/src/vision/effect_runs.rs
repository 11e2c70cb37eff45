//! Sequences of pictures with an effect that comes and goes: whether what is wrong is believed, and how soon the seam is
//! found again.

use super::NOISE;
use super::camera;
use super::effects::{Options, compared, effects_of, renderer, shown};
use super::figures::{micrometres, quantile};
use super::seeds::of_seeds;
use anyhow::Result;
use vision::render::{Effect, EffectRun, Shown, SplitMix64};
use vision::{Detector, Image, Joint, Observer, ObserverConfig, Optics, Profile};

/// Pictures of a sequence, and those that have the effects.
const PICTURES: usize = 40;
const LASTING: std::ops::Range<usize> = 14..26;

/// Sequences that share the texture of their plates.
const SHARE: u64 = 16;

/// More than this nothing may be off that is believed \[mm\].
const WRONG_MM: f64 = 0.05;

/// After so many pictures without the effects the seam has to be believed again.
const SOON: usize = 5;

/// What became of a sequence.
struct Taken {
    group: usize,
    seed: u64,
    effects: Vec<Effect>,
    /// Errors of the centres and heights that were believed \[mm\].
    centres: Vec<f64>,
    heights: Vec<f64>,
    /// Pictures with a seam before and after the effects, and those of them that were believed; the same with effects.
    plain: [usize; 2],
    affected: [usize; 2],
    /// Pictures that were believed and wrong, or had no joint in sight.
    wrong: InARow,
    /// Pictures that were believed at the joint where it is closed, so that there is nothing to be seen of it.
    closed: InARow,
    /// Pictures after the effects until the first that is believed.
    found_after: usize,
}

/// How often something happened in a row: now, and at most.
#[derive(Clone, Copy, Default)]
struct InARow {
    now: usize,
    most: usize,
}

impl InARow {
    fn count(&mut self, happens: bool) {
        self.now = if happens { self.now + 1 } else { 0 };
        self.most = self.most.max(self.now);
    }
}

/// Renders and observes sequences, and prints a table.
pub fn run(options: &Options) -> Result<()> {
    let optics = Optics {
        magnification: options.magnification,
        ..camera(400)
    };
    let groups = options.groups();
    let share = SHARE.min(options.pictures.max(1));
    let taken = of_seeds("textures", options.pictures.div_ceil(share), |number| {
        let number = options.first + number;
        let mut random = SplitMix64::new(!number);
        let mut smear_mm = random.between(0.004, 0.0075);
        let smears = |effects: &[Effect]| effects.contains(&Effect::Smear);
        let sequences: Vec<(u64, usize, Vec<Effect>)> = (0..share)
            .map(|k| {
                let group = ((number * share + k) % groups.len() as u64) as usize;
                (
                    number * 1_000_000 + k,
                    group,
                    effects_of(&groups[group], &mut random),
                )
            })
            .collect();
        let mut all = Vec::new();
        for smeared in [false, true] {
            let mut these = sequences
                .iter()
                .filter(|(_, _, effects)| smears(effects) == smeared)
                .peekable();
            if these.peek().is_none() {
                continue;
            }
            if smeared {
                smear_mm = random.between(0.015, 0.04);
            }
            let (mut renderer, textures) = renderer(optics, number, smear_mm)?;
            for (seed, group, effects) in these {
                let detector = Detector::new(optics, NOISE, Profile::expected(&optics))?;
                let mut observer = Observer::new(detector, ObserverConfig::default(), Joint::Gap);
                let mut taken = Taken {
                    group: *group,
                    seed: *seed,
                    effects: effects.clone(),
                    centres: Vec::new(),
                    heights: Vec::new(),
                    plain: [0; 2],
                    affected: [0; 2],
                    wrong: InARow::default(),
                    closed: InARow::default(),
                    found_after: PICTURES - LASTING.end,
                };
                let mut found = false;
                let pictures = EffectRun::new(effects, LASTING, &optics, NOISE, *seed);
                for (k, (mut scene, moved)) in pictures.take(PICTURES).enumerate() {
                    (scene.texture, scene.right_texture) = (textures[0], Some(textures[1]));
                    let pixels = renderer.render(&scene, seed * 100 + k as u64)?;
                    let image = Image::new(pixels, optics.rows, optics.columns)?;
                    let seen = observer.observe(&image, moved)?;
                    let believed = seen.seam.and(seen.report.measured.as_ref());
                    let there = shown(&scene, &optics);
                    let errors = believed.and_then(|seen| compared(&scene, &optics, seen));
                    let truth = scene.truth(&optics).map(|truth| truth.shown);
                    let is_closed = there == Some(false) && truth == Some(Shown::NoGap);
                    let is_off = |(errors, _): ([f64; 5], _)| errors[0].abs() > WRONG_MM;
                    let wrong =
                        errors.is_some_and(|errors| is_off(errors) || (there == Some(false) && !is_closed));
                    taken.wrong.count(wrong);
                    taken.closed.count(is_closed && believed.is_some() && !wrong);
                    taken.centres.extend(errors.map(|(errors, _)| errors[0]));
                    taken.heights.extend(errors.map(|(errors, _)| errors[1]));
                    if there == Some(true) {
                        let count = if LASTING.contains(&k) {
                            &mut taken.affected
                        } else {
                            &mut taken.plain
                        };
                        count[0] += 1;
                        count[1] += usize::from(believed.is_some());
                    }
                    if k >= LASTING.end && !found && believed.is_some() && !wrong {
                        found = true;
                        taken.found_after = k - LASTING.end;
                    }
                }
                all.push(taken);
            }
        }
        Ok(all)
    })?;
    println!(
        "{PICTURES} pictures each, of them {} with effects; centres and heights in µm.\n",
        LASTING.len()
    );
    println!(
        "| effect | sequences | believed before and after % | with effects % | centre 99 % | worst | height 99 % | worst | wrong twice running | most running | found again after 95 % | at most | closed and believed twice running |"
    );
    println!("|---{}|", "|--:".repeat(12));
    for (k, (name, _)) in groups.iter().enumerate() {
        let group: Vec<&Taken> = taken.iter().filter(|taken| taken.group == k).collect();
        println!("{}", line(name, &group));
    }
    println!("{}\n", line("all", &taken.iter().collect::<Vec<_>>()));
    for taken in taken.iter().filter(|taken| taken.wrong.most > 1) {
        let Taken {
            seed, effects, wrong, ..
        } = taken;
        println!("wrong: {effects:?}, seed {seed}: {} pictures running", wrong.most);
    }
    for taken in taken.iter().filter(|taken| taken.found_after > SOON) {
        let Taken {
            seed,
            effects,
            found_after,
            ..
        } = taken;
        println!("late: {effects:?}, seed {seed}: {found_after} pictures");
    }
    Ok(())
}

fn line(name: &str, group: &[&Taken]) -> String {
    let centres: Vec<f64> = group.iter().flat_map(|taken| taken.centres.clone()).collect();
    let heights: Vec<f64> = group.iter().flat_map(|taken| taken.heights.clone()).collect();
    let share = |counts: fn(&Taken) -> [usize; 2]| {
        let sum = |k: usize| group.iter().map(|taken| counts(taken)[k]).sum::<usize>() as f64;
        format!("{:.1}", 100.0 * sum(1) / sum(0))
    };
    let found: Vec<f64> = group.iter().map(|taken| taken.found_after as f64).collect();
    let most = group.iter().map(|taken| taken.wrong.most).max().unwrap_or(0);
    let twice = |of: fn(&Taken) -> InARow| {
        group
            .iter()
            .filter(|taken| of(taken).most > 1)
            .count()
            .to_string()
    };
    let cells = [
        name.to_owned(),
        group.len().to_string(),
        share(|taken| taken.plain),
        share(|taken| taken.affected),
        micrometres(quantile(&centres, 0.99)),
        micrometres(quantile(&centres, 1.0)),
        micrometres(quantile(&heights, 0.99)),
        micrometres(quantile(&heights, 1.0)),
        twice(|taken| taken.wrong),
        most.to_string(),
        format!("{:.0}", quantile(&found, 0.95)),
        format!("{:.0}", quantile(&found, 1.0)),
        twice(|taken| taken.closed),
    ];
    format!("| {} |", cells.join(" | "))
}
