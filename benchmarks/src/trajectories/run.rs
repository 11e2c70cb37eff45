//! Running a program through the planner as the board does: elements come over a link a few at a time.

use super::TICK;
use crate::meter::Meter;
use shared::io::AXES;
use shared::kinematics::Kinematics;
use shared::trajectory::{BoardPlanner, Element, PathSpace, PlanLimits, PushError, Unreachable};
use std::hint::black_box;
use thiserror::Error;

/// Elements that come over the link in a tick at most.
const CREDITS: usize = 8;

/// Ticks at rest before the end that a plan may take to come.
const REST: usize = 500;

/// Output of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where the axes are sent (mm, rad).
    pub axes: [f64; AXES],
    /// Path length published \[mm\].
    pub s: f64,
    /// Elements that came before this tick.
    pub pushed: u8,
}

/// Why a program did not come to its end.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Stuck {
    /// The planner refused an element.
    #[error("after {ticks} ticks: {error}")]
    Push {
        /// Ticks until then.
        ticks: usize,
        /// Why.
        error: PushError,
    },
    /// The planner gave no output.
    #[error("tick {ticks}, line {line}: {error}")]
    Tick {
        /// Number of the tick.
        ticks: usize,
        /// Line of the program in the last output.
        line: u32,
        /// Why.
        error: Unreachable,
    },
    /// An output is not finite.
    #[error("tick {ticks}, line {line}: an output is not a finite number")]
    NotFinite {
        /// Number of the tick.
        ticks: usize,
        /// Line of the program.
        line: u32,
    },
    /// It says that nothing moves any more, and is not at the end.
    #[error("at rest in line {line}, at s = {s} mm of {length} mm, after {ticks} ticks")]
    Rest {
        /// Ticks until then.
        ticks: usize,
        /// Line of the program.
        line: u32,
        /// Where.
        s: f64,
        /// Where the end is.
        length: f64,
    },
    /// It takes longer than stopping after every element would.
    #[error("still in line {line}, at s = {s} mm of {length} mm, after {ticks} ticks")]
    Slow {
        /// Ticks until then.
        ticks: usize,
        /// Line of the program.
        line: u32,
        /// Where.
        s: f64,
        /// Where the end is.
        length: f64,
    },
}

/// Runs `elements` to their end, from axes at `start`; `meter` counts every element that comes and every tick.
pub fn run(
    elements: &[Element],
    start: &[f64; AXES],
    limits: &PlanLimits,
    kinematics: &Kinematics,
    meter: &mut impl Meter,
) -> Result<Vec<Sample>, Stuck> {
    let mut planner = Box::new(BoardPlanner::new());
    planner.start(limits, PathSpace::Axes, 0.0, start);
    let length: f64 = elements.iter().map(|element| element.length).sum();
    let mut coming = elements.iter();
    let mut samples = Vec::new();
    let (mut line, mut resting) = (0, 0);
    for ticks in 0..patience(elements) {
        let mut pushed = 0;
        for element in coming.by_ref().take(CREDITS.min(planner.room())) {
            let mut element = Some(element.clone());
            let mut result = Ok(());
            meter.count(&mut || result = element.take().map_or(Ok(()), |element| planner.push(element)));
            result.map_err(|error| Stuck::Push { ticks, error })?;
            pushed += 1;
        }
        let mut output = None;
        meter.count(&mut || output = Some(planner.tick(kinematics)));
        let output = black_box(output)
            .expect("a meter makes the call")
            .map_err(|error| Stuck::Tick { ticks, line, error })?;
        let s = output.along.s;
        line = output.line;
        let axes = output.axes.position;
        if !(s.is_finite() && axes.iter().all(|axis| axis.is_finite())) {
            return Err(Stuck::NotFinite { ticks, line });
        }
        samples.push(Sample { axes, s, pushed });
        resting = if output.at_rest { resting + 1 } else { 0 };
        if coming.len() == 0 && output.at_rest && (s - length).abs() <= 1e-6 * length.max(1.0) {
            return Ok(samples);
        }
        if resting > REST {
            return Err(Stuck::Rest {
                ticks,
                line,
                s,
                length,
            });
        }
    }
    Err(Stuck::Slow {
        ticks: samples.len(),
        line,
        s: samples.last().map_or(0.0, |sample| sample.s),
        length,
    })
}

/// Ticks that a program may take: stopping after every element, twice as long as that takes.
fn patience(elements: &[Element]) -> usize {
    const REACTION: f64 = 0.1;
    const ACCELERATION: f64 = 500.0;
    let time = |element: &Element| {
        element.length / element.feed + 2.0 * (element.length / ACCELERATION).sqrt() + REACTION
    };
    let time: f64 = elements.iter().map(time).sum();
    ((2.0 * time + 1.0) / TICK) as usize
}
