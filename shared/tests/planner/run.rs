//! Running programs, with hands on the controls.

use super::bench::Bench;
use super::late::Halves;
use shared::trajectory::{Element, Output, PushError, Unreachable, Way};
use thiserror::Error;

/// What an operator does at the controls, or a disturbance of the link.
#[derive(Clone, Copy, Debug)]
pub enum Act {
    Override(f64),
    Go(Way),
    /// No element comes for so many ticks.
    Starve(u32),
}

/// Something done so many ticks after what was done before.
pub type Acts = Vec<(u32, Act)>;

/// One tick: what was wished, and what came out.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub output: Output,
    pub factor: f64,
    pub way: Way,
    /// Elements came, or something was done, just before.
    pub touched: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Stuck {
    #[error("at tick {0}: {1}")]
    Push(usize, PushError),
    #[error("tick {0}: {1}")]
    Tick(usize, Unreachable),
    #[error("slow: at s = {s} mm of {length} mm after {ticks} ticks")]
    Slow { ticks: usize, s: f64, length: f64 },
    #[error("stands at s = {s} mm of {length} mm, after {ticks} ticks; it says it is at rest: {at_rest}")]
    Stands {
        ticks: usize,
        s: f64,
        length: f64,
        at_rest: bool,
    },
}

/// Longest standstill with nothing in the way, and the time to wait after the last act \[ticks\].
const STANDSTILL: usize = 1000;
const AFTER: usize = 700;

/// Elements that come in a tick at most.
const CREDITS: usize = 8;

/// Runs `elements` from rest at home to their end. All that is done is undone after the last of `acts`: then the
/// machine continues to the end as programmed.
pub fn run(bench: &Bench, elements: &[Element], acts: &Acts) -> Result<Vec<Sample>, Stuck> {
    run_with(bench, elements, acts, CREDITS, &[])
}

/// The same with so many elements a tick at most, and with turns of planning that end `late`: see [`Halves`].
pub fn run_with(
    bench: &Bench,
    elements: &[Element],
    acts: &Acts,
    credits: usize,
    late: &[u32],
) -> Result<Vec<Sample>, Stuck> {
    let mut halves = Halves::new(&bench.kinematics, late);
    halves.player.start(&bench.limits, bench.space, 0.0, &bench.home);
    let length: f64 = elements.iter().map(|element| element.length).sum();
    let mut coming = elements.iter();
    let mut acts = acts.iter().copied();
    let mut next = acts.next();
    let (mut wait, mut starve) = (0, 0);
    let (mut way, mut factor) = (Way::Forward, 1.0);
    let mut samples: Vec<Sample> = Vec::new();
    let (mut last, mut stands, mut undone) = (0, 0, false);
    while samples.len() < last + patience(bench, elements) {
        let mut touched = false;
        while let Some((_, act)) = next.filter(|(pause, _)| *pause == wait) {
            match act {
                Act::Override(to) => factor = to,
                Act::Go(to) => way = to,
                Act::Starve(ticks) => starve = ticks,
            }
            (next, wait, touched) = (acts.next(), 0, true);
        }
        match next {
            Some(_) => (wait, last) = (wait + 1, samples.len()),
            // A while after the last of them.
            None if !undone && samples.len() >= last + AFTER => {
                (way, factor, touched, undone) = (Way::Forward, 1.0, true, true);
            }
            None => {}
        }
        let player = &mut halves.player;
        player.go(way);
        player.set_override(factor);
        if starve > 0 {
            starve -= 1;
        } else {
            for element in coming.by_ref().take(credits.min(player.room())) {
                let result = player.push(element.clone());
                result.map_err(|error| Stuck::Push(samples.len(), error))?;
                touched = true;
            }
        }
        for output in halves.tick() {
            let output = output.map_err(|error| Stuck::Tick(samples.len(), error))?;
            let s = output.along.s;
            let free = next.is_none() && way == Way::Forward && factor > 0.0 && starve == 0;
            let moves = samples.last().is_none_or(|before| before.output.along.s != s);
            stands = if moves || !free { 0 } else { stands + 1 };
            samples.push(Sample {
                output,
                factor,
                way,
                touched,
            });
            let there = (s - length).abs() <= 1e-9 * length.max(1.0);
            if free && coming.len() == 0 && output.at_rest && there {
                return Ok(samples);
            }
        }
        let Some(Sample { output, .. }) = samples.last() else {
            continue;
        };
        let (ticks, s, at_rest) = (samples.len(), output.along.s, output.at_rest);
        if stands > STANDSTILL {
            return Err(Stuck::Stands {
                ticks,
                s,
                length,
                at_rest,
            });
        }
    }
    Err(Stuck::Slow {
        ticks: samples.len(),
        s: samples.last().map_or(0.0, |sample| sample.output.along.s),
        length,
    })
}

/// Ticks that a program may take: far more than stopping after every element would.
fn patience(bench: &Bench, elements: &[Element]) -> usize {
    let slowest = bench
        .limits
        .acceleration
        .iter()
        .take(3)
        .copied()
        .fold(bench.limits.path_acceleration, f64::min);
    let time = |element: &Element| {
        2.0 * element.length / element.feed + 4.0 * (element.length / slowest).sqrt() + 0.5
    };
    let time: f64 = elements.iter().map(time).sum();
    ((3.0 * time + 3.0) / 1e-3) as usize
}
