//! One program from its file to its figures, and how those pass from program to program.

use super::elements::elements;
use super::evenness::{Evenness, evenness};
use super::limits::QUICK;
use super::metrics::Figures;
use super::run::run;
use super::way::Move;
use super::{free_form, seg};
use crate::meter::Meter;
use anyhow::{Context, Result};
use curves::smoothing::smooth;
use serde::{Deserialize, Serialize};
use shared::io::AXES;
use shared::kinematics::Kinematics;
use shared::trajectory::Element;
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
/// one call of nothing. What is no program is an outcome too: others are run after it.
pub fn of_file(
    file: &Path,
    feed: Option<f64>,
    kinematics: &Kinematics,
    meter: &mut impl Meter,
) -> Result<Outcome> {
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    let (moves, elements) = match understood(file, &text, feed) {
        Ok(program) => program,
        Err(error) => return Ok(Outcome::without_moves(format!("{error:#}"))),
    };
    if moves.is_empty() {
        return Ok(Outcome::without_moves("it has no moves".to_owned()));
    }
    // As programs with G64 P are, before they go to the board.
    let elements = smooth(
        elements.into_iter().map(|element| (element, f64::INFINITY)),
        QUICK.acceleration(true),
    );
    // Segments begin at the origin, a curve where it does.
    let mut start = [0.0; AXES];
    if let Some(first) = moves.first() {
        start[..3].copy_from_slice(first.way.start().as_slice());
    }
    meter.count(&mut || ());
    let run = run(&elements, &start, &QUICK.plan_limits(), kinematics, meter);
    let samples = run.as_deref().unwrap_or_default();
    Ok(Outcome {
        moves: moves.len(),
        elements: elements.len(),
        pushed: samples.iter().map(|sample| sample.pushed).collect(),
        evenness: evenness(&moves, &elements, samples),
        figures: match &run {
            Ok(samples) => Ok(Figures::of(&moves, &start, samples, &QUICK)),
            Err(stuck) => Err(stuck.to_string()),
        },
    })
}

/// The program that `text` in `file` is. Errors say where in it.
fn understood(file: &Path, text: &str, feed: Option<f64>) -> Result<(Vec<Move>, Vec<Element>)> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let moves = match feed {
        Some(feed) => free_form::read(text, feed).with_context(|| name.into_owned())?,
        None => seg::read(text, &name)?,
    };
    let elements = elements(&moves)?;
    Ok((moves, elements))
}

impl Outcome {
    /// Of a file in which there is nothing to run, and why.
    fn without_moves(why: String) -> Self {
        Self {
            moves: 0,
            elements: 0,
            pushed: Vec::new(),
            evenness: None,
            figures: Err(why),
        }
    }

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
    use super::super::testing::{Calls, any_machine};
    use super::*;

    /// What becomes of `text` as a program; a free-form curve with a `feed`.
    fn why_not(text: &str, feed: Option<f64>) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("program");
        fs::write(&file, text).expect("a file");
        let outcome = of_file(&file, feed, &any_machine(), &mut Calls).expect("an outcome");
        outcome.figures.expect_err("nothing to run")
    }

    #[test]
    fn a_program_without_moves_is_told() {
        assert_eq!(why_not("", None), "it has no moves");
        assert_eq!(why_not("L 0 0 0 0 0 0 10\n", None), "it has no moves");
    }

    #[test]
    fn what_is_no_program_is_told_with_its_place() {
        assert_eq!(
            why_not("L 1 0 0 0 0 0 10\nL 2 0\n", None),
            "program:2: 2 numbers after 'L', which takes 7"
        );
        assert_eq!(
            why_not("{}", Some(50.0)),
            "program: missing field `degree` at line 1 column 2"
        );
    }
}
