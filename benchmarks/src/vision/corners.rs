//! Closed corners whose walls are learnt.

use super::figures::{mean, micrometres, quantile, rms};
use super::limits::Limit;
use super::seeds::of_seeds;
use super::{NOISE, SAMPLES};
use anyhow::Result;
use vision::render::{Errors, Finish, Texture, TruthRenderer, random_corner};
use vision::{Detector, Image, Joint, Moved, Observer, ObserverConfig, Optics, Profile, Walls};

/// Pictures of a corner in which its walls are learnt, and those that count.
const LEARNING: u64 = 48;
const LEARNT: u64 = 24;

/// Pictures of which means are taken.
const AVERAGED: usize = 8;

/// Way between pictures: 9 m/min at 200 a second \[mm\].
const WAY_MM: f64 = 0.75;

/// What became of the corners of a finish.
pub(super) struct Corners {
    name: String,
    pictures: u64,
    /// Errors of the corners that were accepted, one after the other.
    runs: Vec<Vec<Errors>>,
}

/// Corners of a finish whose calibrated walls are wrong by 0.015 and learnt.
pub(super) fn corner(finish: Finish, optics: Optics, corners: u64) -> Result<Corners> {
    let name = format!("{finish:?}").to_lowercase();
    let runs = of_seeds(&format!("{name} corners"), corners, |seed| {
        let mut renderer = TruthRenderer::new(optics, NOISE, SAMPLES)?;
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
            scene.position_mm[0] += WAY_MM;
            let moved = Moved {
                travel_mm: WAY_MM,
                ..Moved::default()
            };
            let pixels = renderer.render(&scene, 1000 * seed + k);
            let seen = observer.observe(&Image::new(&pixels, optics.rows, optics.columns)?, moved)?;
            errors.extend(scene.errors(&seen, &optics).filter(|_| k >= LEARNING));
        }
        Ok(vec![errors])
    })?;
    Ok(Corners {
        name,
        pictures: corners * LEARNT,
        runs,
    })
}

impl Corners {
    fn every(&self, figure: fn(&Errors) -> f64) -> Vec<f64> {
        self.runs.iter().flatten().map(figure).collect()
    }

    /// Means of pictures in a row that were accepted.
    fn means(&self, figure: fn(&Errors) -> f64) -> Vec<f64> {
        let groups = self.runs.iter().flat_map(|run| run.chunks_exact(AVERAGED));
        groups
            .map(|group| mean(&group.iter().map(figure).collect::<Vec<f64>>()))
            .collect()
    }

    pub fn print(&self) {
        let (lateral, height) = (
            self.every(|errors| errors.lateral_mm),
            self.every(|errors| errors.height_mm),
        );
        let cells = [
            "corner".to_owned(),
            self.name.clone(),
            self.pictures.to_string(),
            format!("{:.1}", 100.0 * lateral.len() as f64 / self.pictures as f64),
            micrometres(rms(&lateral)),
            micrometres(quantile(&lateral, 1.0)),
            micrometres(rms(&self.means(|errors| errors.lateral_mm))),
            micrometres(rms(&height)),
            micrometres(mean(&height)),
            micrometres(rms(&self.means(|errors| errors.height_mm))),
        ];
        println!("{}", cells.join("\t"));
    }

    pub fn limits(&self) -> [Limit; 3] {
        let limit = |what: &str, mm: f64, most: f64| {
            Limit::at_most(
                &format!("{} corner, {what}", self.name),
                "µm",
                1000.0 * mm.abs(),
                most,
            )
        };
        [
            limit("centre rms", rms(&self.every(|errors| errors.lateral_mm)), 6.0),
            limit(
                "centre rms of means of 8",
                rms(&self.means(|errors| errors.lateral_mm)),
                3.0,
            ),
            limit(
                "bias of height",
                mean(&self.every(|errors| errors.height_mm)),
                2.0,
            ),
        ]
    }
}
