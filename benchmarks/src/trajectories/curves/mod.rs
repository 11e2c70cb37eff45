//! Curves in short lines, at feeds below and above what they can be gone along with, on machines that come to their
//! acceleration slowly. What a plan takes is compared with the best constant speed, which needs no planner.

mod shape;

use super::elements::elements;
use super::limits::HEAVY;
use super::metrics::Figures;
use super::run;
use crate::meter::Meter;
use ::curves::smoothing::smooth;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use shape::{Curve, LENGTH};
use shared::io::AXES;
use shared::kinematics::Kinematics;

/// Feeds, as multiples of the best constant speed.
pub const FEEDS: [f64; 7] = [0.6, 0.9, 1.1, 1.4, 2.0, 3.0, 5.0];

/// First word of the line of a curve.
const WORD: &str = "curve ";

/// A curve at each of the [`FEEDS`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feeds {
    /// What it is called.
    pub name: String,
    /// The best constant speed \[mm/s\].
    pub speed: f64,
    /// The figures, or why the program did not come to its end.
    pub runs: Vec<std::result::Result<Figures, String>>,
}

impl Feeds {
    /// Runs a curve at each of the [`FEEDS`].
    fn of(curve: &Curve, kinematics: &Kinematics, meter: &mut impl Meter) -> Self {
        let speed = curve.constant_speed(&HEAVY);
        let run =
            |feed: f64| figures(curve, feed * speed, kinematics, meter).map_err(|error| error.to_string());
        Self {
            name: curve.name.clone(),
            speed,
            runs: FEEDS.map(run).to_vec(),
        }
    }

    /// Time of each run over that at the feed, or at the best constant speed where the feed is higher.
    pub fn shares(&self) -> Vec<Option<f64>> {
        let time = |feed: f64| {
            let speed = self.speed * feed.min(1.0);
            LENGTH / speed + HEAVY.start_and_stop(speed)
        };
        let runs = self.runs.iter().zip(FEEDS);
        runs.map(|(run, feed)| Some(run.as_ref().ok()?.time / time(feed)))
            .collect()
    }

    /// The line that [`Feeds::parse`] reads.
    fn line(&self) -> Result<String> {
        Ok(format!("{WORD}{}", serde_json::to_string(self)?))
    }

    /// The curves among the lines that a program has printed.
    pub fn parse(text: &str) -> Result<Vec<Self>> {
        text.lines()
            .filter_map(|line| line.strip_prefix(WORD))
            .map(|line| serde_json::from_str(line).context("a curve cannot be read"))
            .collect()
    }
}

/// Runs curves of each kind and `random` others, from a `seed` on, and prints a line for each.
pub fn print(random: u64, seed: u64, kinematics: &Kinematics, meter: &mut impl Meter) -> Result<()> {
    for curve in Curve::all(random, seed) {
        println!("{}", Feeds::of(&curve, kinematics, meter).line()?);
    }
    Ok(())
}

/// A curve at one feed \[mm/s\].
fn figures(curve: &Curve, feed: f64, kinematics: &Kinematics, meter: &mut impl Meter) -> Result<Figures> {
    let moves = curve.program(feed)?;
    let elements = elements(&moves)?
        .into_iter()
        .map(|element| (element, f64::INFINITY));
    let elements = smooth(elements, HEAVY.acceleration(true));
    let mut start = [0.0; AXES];
    let first = moves.first().context("a curve without lines")?;
    start[..3].copy_from_slice(first.way.start().as_slice());
    let samples = run::run(&elements, &start, &HEAVY.plan_limits(), kinematics, meter)?;
    Ok(Figures::of(&moves, &start, &samples, &HEAVY))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Calls, any_machine};
    use super::*;

    /// Boxes that became ever smaller once made machines creep there, for up to four times as long.
    #[test]
    fn a_feed_that_a_curve_cannot_take_does_not_make_the_machine_creep() {
        for curve in Curve::all(4, 50).into_iter().skip(8) {
            let feeds = Feeds::of(&curve, &any_machine(), &mut Calls);
            for share in feeds.shares() {
                assert!(share.is_some_and(|share| share < 1.5), "{feeds:?}");
            }
        }
    }
}
