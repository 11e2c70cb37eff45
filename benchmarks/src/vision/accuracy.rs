//! How far measured seams are off, against the truth renderer.

use super::corners::corner;
use super::figures::{mean, micrometres, quantile, rms};
use super::groups::{GROUPS, is_normal};
use super::limits::Limit;
use super::seeds::of_seeds;
use super::{NOISE, SAMPLES, camera};
use anyhow::Result;
use vision::render::{Errors, Finish, RandomRun, Scene, Shown, TruthRenderer};
use vision::{Detector, Doubt, Image, Joint, Observation, Observer, ObserverConfig, Optics, Profile};

/// Pictures of one seam; the first of them acquire it.
const RUN: u64 = 10;

/// Share of the pictures that is taken for each other aperture.
const APERTURES: [f64; 2] = [0.07, 0.13];
const FEWER: u64 = 8;

/// Corners of a finish for 2000 pictures of gaps, and at least.
const CORNERS: u64 = 24;
const FEWEST_CORNERS: u64 = 2;

/// One picture that was observed.
struct Taken {
    scene: Scene,
    seen: Observation,
    errors: Option<Errors>,
}

/// Renders and observes about that many pictures of gaps, and a part of that of corners; prints a line of cells, parted by
/// tabs, for every group of pictures: first "gap", "corner" or, how they keep the limits, "limit".
pub fn run(pictures: u64) -> Result<()> {
    let optics = camera(400);
    let mut limits = Vec::new();
    let taken = gaps("seams", optics, pictures)?;
    for (name, belongs) in GROUPS {
        let group = Gaps::of(taken.iter().filter(|taken| belongs(&taken.scene)), &optics);
        group.print(name);
        match name {
            "all" => limits.extend(group.limits()),
            "normal textures" => limits.push(group.height_limit()),
            _ => {}
        }
    }
    for aperture in APERTURES {
        let optics = Optics { aperture, ..optics };
        let name = format!("aperture {aperture:.2}");
        Gaps::of(gaps(&name, optics, pictures / FEWER)?.iter(), &optics).print(&name);
    }
    let corners = (pictures * CORNERS / 2000).max(FEWEST_CORNERS);
    for finish in Finish::ALL {
        let seen = corner(finish, optics, corners)?;
        seen.print();
        if is_normal(finish) {
            limits.extend(seen.limits());
        }
    }
    for limit in limits {
        println!("{limit}");
    }
    Ok(())
}

fn gaps(what: &str, optics: Optics, pictures: u64) -> Result<Vec<Taken>> {
    of_seeds(what, pictures.div_ceil(RUN), |seed| {
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

/// What became of a group of pictures of gaps.
#[derive(Default)]
struct Gaps {
    pictures: u32,
    /// Those that show the seam.
    shown: u32,
    /// Those of them that say so, whatever the observer makes of it.
    measured: u32,
    /// Those in which the observer still waits for three that agree.
    waiting: u32,
    /// Those that show no seam and in which one was accepted.
    wrong: u32,
    /// Errors of the seams that were accepted.
    errors: Vec<Errors>,
}

impl Gaps {
    fn of<'a>(all: impl Iterator<Item = &'a Taken>, optics: &Optics) -> Self {
        let mut gaps = Self::default();
        for Taken { scene, seen, errors } in all {
            gaps.pictures += 1;
            if scene.truth(optics).is_none_or(|truth| truth.shown != Shown::Seam) {
                gaps.wrong += u32::from(seen.seam.is_some());
                continue;
            }
            gaps.shown += 1;
            gaps.measured += u32::from(seen.report.seam().is_some());
            gaps.waiting += u32::from(seen.doubt == Some(Doubt::New));
            gaps.errors.extend(*errors);
        }
        gaps
    }

    /// Share of the pictures with a seam that say so \[%\].
    fn measured(&self) -> f64 {
        100.0 * f64::from(self.measured) / f64::from(self.shown.max(1))
    }

    /// Share of those in which it is accepted, where the observer does not wait \[%\].
    fn believed(&self) -> f64 {
        let ready = self.shown - self.waiting;
        100.0 * self.errors.len() as f64 / f64::from(ready.max(1))
    }

    fn every(&self, figure: fn(&Errors) -> f64) -> Vec<f64> {
        self.errors.iter().map(figure).collect()
    }

    /// What 99 % of the heights of means of four are off by at most \[mm\].
    fn mean_height_mm(&self) -> f64 {
        let means = self.errors.iter().filter_map(|errors| errors.mean_mm);
        quantile(&means.map(|[_, height]| height).collect::<Vec<f64>>(), 0.99)
    }

    fn print(&self, name: &str) {
        let (lateral, height) = (
            self.every(|errors| errors.lateral_mm),
            self.every(|errors| errors.height_mm),
        );
        let cells = [
            "gap".to_owned(),
            name.to_owned(),
            self.pictures.to_string(),
            self.shown.to_string(),
            format!("{:.1}", self.measured()),
            self.waiting.to_string(),
            format!("{:.1}", self.believed()),
            self.wrong.to_string(),
            micrometres(rms(&lateral)),
            micrometres(quantile(&lateral, 0.99)),
            micrometres(quantile(&lateral, 1.0)),
            micrometres(rms(&height)),
            micrometres(self.mean_height_mm()),
            micrometres(mean(&height)),
            micrometres(rms(&self.every(|errors| errors.width_mm))),
            format!("{:.3}", rms(&self.every(|errors| errors.roll))),
        ];
        println!("{}", cells.join("\t"));
    }

    fn limits(&self) -> [Limit; 5] {
        let lateral = self.every(|errors| errors.lateral_mm);
        [
            Limit::at_least(
                "seams believed, those that wait left out",
                "%",
                self.believed(),
                88.0,
            ),
            Limit::at_least("seams measured, those that wait too", "%", self.measured(), 88.0),
            Limit::at_most("centre, 99 %", "µm", 1000.0 * quantile(&lateral, 0.99), 5.0),
            Limit::at_most("centre, worst", "µm", 1000.0 * quantile(&lateral, 1.0), 50.0),
            Limit::at_most("believed without a seam", "", f64::from(self.wrong), 0.0),
        ]
    }

    fn height_limit(&self) -> Limit {
        let off = 1000.0 * self.mean_height_mm();
        Limit::at_most("height of means of 4, 99 %, normal textures", "µm", off, 12.0)
    }
}
