//! One program from its file to its figures, and how those pass from program to program.

use super::elements::elements;
use super::evenness::{Evenness, evenness};
use super::limits::plan_limits;
use super::metrics::Figures;
use super::run::run;
use super::{free_form, seg};
use crate::meter::Meter;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use shared::io::AXES;
use shared::kinematics::Kinematics;
use std::fs;
use std::path::Path;

/// First word of the line of an outcome.
const WORD: &str = "trajectory ";

/// What became of a program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Moves of the program.
    pub moves: usize,
    /// Elements that the planner was given.
    pub elements: usize,
    /// For each tick, how many elements came before it. All of these calls are counted, in this order.
    pub pushed: Vec<u8>,
    /// Of a program that is a free-form curve.
    pub evenness: Option<Evenness>,
    /// The figures, or why the program did not come to its end.
    pub figures: std::result::Result<Figures, String>,
}

/// Runs the program in `file`, which is a free-form curve if a `feed` \[mm/s\] is given. Before all else `meter` counts
/// one call of nothing.
pub fn of_file(
    file: &Path,
    feed: Option<f64>,
    kinematics: &Kinematics,
    meter: &mut impl Meter,
) -> Result<Outcome> {
    let name = file.display().to_string();
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {name}"))?;
    let moves = match feed {
        Some(feed) => free_form::read(&text, feed).with_context(|| name.clone())?,
        None => seg::read(&text, &name)?,
    };
    let elements = elements(&moves).with_context(|| name)?;
    // Segments begin at the origin, a curve where it does.
    let mut start = [0.0; AXES];
    if let Some(first) = moves.first() {
        start[..3].copy_from_slice(first.way.start().as_slice());
    }
    meter.count(&mut || ());
    let run = run(&elements, &start, &plan_limits(), kinematics, meter);
    let samples = run.as_deref().unwrap_or_default();
    Ok(Outcome {
        moves: moves.len(),
        elements: elements.len(),
        pushed: samples.iter().map(|sample| sample.pushed).collect(),
        evenness: if moves.is_empty() {
            None
        } else {
            evenness(&moves, &elements, samples)
        },
        figures: match &run {
            Ok(_) if moves.is_empty() => Err("it has no moves".to_owned()),
            Ok(samples) => Ok(Figures::of(&moves, &start, samples)),
            Err(stuck) => Err(stuck.to_string()),
        },
    })
}

impl Outcome {
    /// The line that [`Outcome::parse`] reads.
    pub fn line(&self) -> Result<String> {
        Ok(format!("{WORD}{}", serde_json::to_string(self)?))
    }

    /// The outcome among the lines that a program has printed.
    pub fn parse(text: &str) -> Result<Self> {
        let line = text.lines().find_map(|line| line.strip_prefix(WORD));
        let line = line.with_context(|| format!("the run did not come to its end; it printed:\n{text}"))?;
        Ok(serde_json::from_str(line)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::kinematics::{AxisLimits, DualBeamConfig, KinematicsConfig};

    struct Calls;

    impl Meter for Calls {
        fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
            call();
            0
        }
    }

    #[test]
    fn a_program_without_moves_is_told() {
        let config = KinematicsConfig::DualBeamGantry(DualBeamConfig {
            o1_mm: [0.0; 3],
            o2_mm: [0.0; 3],
            o3_mm: [0.0, 0.0, -100.0],
        });
        let kinematics = config.build(&[AxisLimits::NOT_FITTED; AXES]).expect("a machine");
        let file = std::env::temp_dir().join(format!("seamwright-empty-{}.seg", std::process::id()));
        fs::write(&file, "").expect("a file");
        let outcome = of_file(&file, None, &kinematics, &mut Calls);
        fs::remove_file(&file).expect("the file");
        assert_eq!(
            outcome.expect("an outcome").figures,
            Err("it has no moves".into())
        );
    }
}
