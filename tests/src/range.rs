//! Seams at the edges of what the shipped machine follows by pictures, and beyond them.

use crate::pictures::{SEED, through_pictures};
use crate::{NoOperator, SeamShape, run, seam};
use config::machine::JointForm;
use host_link::boards::Boards;
use job::Job;
use report::Ended;
use shared::io::SLIDES;
use std::f64::consts::TAU;
use world::SceneFile;

/// Seams that are followed, with the largest deviation of a spot \[mm\].
pub const FOLLOWED: [(&str, SeamShape, f64); 6] = [
    ("as planned", |_| [0.0; SLIDES], 0.03),
    ("sines of 1 mm, 0.3 mm of height, over 100 mm", wide_sines, 0.03),
    ("sines of 1.5 mm over 100 mm", wider_sines, 0.03),
    ("sines of 0.6 mm of height over 100 mm", high_sines, 0.03),
    ("slopes of 5 % across, 2 % of height", long_slopes, 0.03),
    ("kinks of 2 %", sharp_kinks, 0.05),
];

/// Seams that begin beside and above or below their plan, as far as is looked: every corner on either side.
pub const BESIDE: [(&str, SeamShape); 5] = [
    ("2 mm beside, 1.3 mm high or low", |_| [2.0, -1.3, -2.0, 1.3]),
    ("3 mm beside, 2 mm high or low (1)", |_| [3.0, 2.0, 3.0, -2.0]),
    ("3 mm beside, 2 mm high or low (2)", |_| [-3.0, -2.0, -3.0, 2.0]),
    ("3 mm beside, 2 mm high or low (3)", |_| [3.0, -2.0, -3.0, -2.0]),
    ("3 mm beside, 2 mm high or low (4)", |_| [-3.0, 2.0, 3.0, 2.0]),
];

/// Seams that cannot be followed: beams have to be off before a spot is 0.1 mm beside one.
pub const LEFT: [(&str, SeamShape); 8] = [
    ("jump of 0.15 mm", |s| [jump(s, 0.15), 0.0, 0.0, 0.0]),
    ("jump of 0.3 mm", |s| [jump(s, 0.3), 0.0, 0.0, 0.0]),
    ("jump of 0.6 mm", |s| [jump(s, 0.6), 0.0, 0.0, 0.0]),
    ("jump of 2 mm", |s| [jump(s, 2.0), 0.0, 0.0, 0.0]),
    ("jump of 0.2 mm in height", |s| [0.0, jump(s, 0.2), 0.0, 0.0]),
    ("jump of 0.4 mm in height", |s| [0.0, jump(s, 0.4), 0.0, 0.0]),
    ("sines of 3 mm over 100 mm", |s| {
        [
            3.0 * (TAU * s / 100.0).sin(),
            0.0,
            3.0 * (TAU * s / 100.0 + 2.0).sin(),
            0.0,
        ]
    }),
    ("slopes of 10 %", |s| {
        let u = turning(s, 0.1, 110.0) - 2.0;
        [u, 0.0, -u, 0.0]
    }),
];

fn jump(s: f64, mm: f64) -> f64 {
    if s < 200.0 { 0.0 } else { mm }
}

fn wide_sines(s: f64) -> [f64; SLIDES] {
    let wave = |phase: f64| (TAU * s / 100.0 + phase).sin();
    [wave(0.0), 0.3 * wave(1.0), wave(2.0), 0.3 * wave(3.0)]
}

fn wider_sines(s: f64) -> [f64; SLIDES] {
    let wave = |phase: f64| 1.5 * (TAU * s / 100.0 + phase).sin();
    [wave(0.0), 0.0, wave(2.0), 0.0]
}

fn high_sines(s: f64) -> [f64; SLIDES] {
    let wave = |phase: f64| 0.6 * (TAU * s / 100.0 + phase).sin();
    [0.0, wave(0.0), 0.0, wave(1.0)]
}

/// Up by `slope`, and down from `top` on, in a bend of 40 mm \[mm\].
fn turning(s: f64, slope: f64, top: f64) -> f64 {
    let x = (s - (top - 20.0)).max(0.0);
    let bent = if x <= 40.0 { x * x / 40.0 } else { 2.0 * x - 40.0 };
    slope * (s - bent)
}

fn long_slopes(s: f64) -> [f64; SLIDES] {
    let u = turning(s, 0.05, 200.0) - 2.0;
    let v = 0.02 * s - 1.5;
    [u, v, -u, -v]
}

fn sharp_kinks(s: f64) -> [f64; SLIDES] {
    crate::kinks(s)
}

/// Welds the shipped program by pictures along a seam of that shape. The path may be held on the way, until a seam is found.
pub fn weld_by_pictures(boards: &mut dyn Boards, shape: SeamShape, speed_m_per_min: f64) -> Ended {
    let weld = |job: &Job| run(boards, job, &mut NoOperator).unwrap_or_else(|error| panic!("{error}"));
    through_pictures(
        JointForm::Gap,
        SceneFile::default(),
        seam(shape),
        speed_m_per_min,
        SEED,
        weld,
    )
}

/// Largest deviation of U1, V1, U2, V2 with the beam of their side on \[mm\].
pub fn with_beam_on(ended: &Ended) -> [f64; SLIDES] {
    let mut worst = [0.0f64; SLIDES];
    for tick in ended.evaluation.ticks.iter() {
        for (slide, worst) in worst.iter_mut().enumerate() {
            if let (true, Some(mm)) = (tick.beams[slide / 2], tick.deviation_mm[slide]) {
                *worst = worst.max(mm.abs());
            }
        }
    }
    worst
}
