//! Machines with a defect: whether commissioning refuses them, and for what it takes the defect.

use super::bounded;
use super::markdown;
use super::robustness::{Draws, LIMIT};
use anyhow::{Context, Result};
use plant_file::Defect;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Part of the machines that have to be refused for the right reason.
const RIGHT: f64 = 0.9;

/// How a reason begins, and the defects that it names.
const REASONS: [(&str, &[Defect]); 7] = [
    ("reversed", &[Defect::Reversed]),
    ("still", &[Defect::DeadGrating]),
    ("acceleration", &[Defect::CurrentLimit, Defect::Friction]),
    ("friction or play", &[Defect::Friction, Defect::Play]),
    ("resonance", &[Defect::Resonance]),
    ("slow drive", &[Defect::SlowDrive]),
    (
        "slow",
        &[Defect::SlowDrive, Defect::CurrentLimit, Defect::Friction],
    ),
];

/// A machine, and what was said of it.
struct Inspected {
    seed: u32,
    motor: &'static str,
    defect: Defect,
    /// Reason that was given for that motor, by its place in [`REASONS`].
    reason: Option<usize>,
    /// It was not commissioned.
    refused: bool,
    said: String,
}

/// Commissions machines with a defect; succeeds if enough are refused for the right reason.
pub fn run(draws: &Draws, program: &str, folder: &Path) -> Result<ExitCode> {
    let mut all = Vec::new();
    for seed in draws.seeds() {
        let inspected = inspect(draws, program, folder, seed)?;
        eprintln!("{}", inspected.line());
        all.push(inspected);
    }
    print!("{}", text(&all));
    let right = all.iter().filter(|inspected| inspected.is_right()).count() as f64;
    Ok(if right >= RIGHT * all.len() as f64 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn inspect(draws: &Draws, program: &str, folder: &Path, seed: u32) -> Result<Inspected> {
    let (motor, defect) = plant_file::defect(&draws.machine, seed)?.context("a machine without motors")?;
    let console = "commission.console";
    let arguments = draws.commission(&folder.join("commissioned.toml"), seed);
    let ended = bounded::run(program, &arguments, folder, console, LIMIT);
    let console = fs::read_to_string(folder.join(console)).context("what it said cannot be read")?;
    let said = said_of(motor, &console);
    Ok(Inspected {
        seed,
        motor,
        defect,
        reason: said.as_deref().and_then(reason),
        refused: ended.is_err(),
        said: said.unwrap_or_else(|| console.lines().last().unwrap_or_default().to_owned()),
    })
}

/// The reason that was given for `motor`.
fn said_of(motor: &str, console: &str) -> Option<String> {
    let of_motor = console
        .lines()
        .filter_map(|line| line.strip_prefix(motor)?.strip_prefix(": "));
    let mut reasons = of_motor.map(|said| said.strip_prefix("left as it is: ").unwrap_or(said));
    reasons.next_back().map(str::to_owned)
}

fn reason(said: &str) -> Option<usize> {
    let (begins, _) = said.split_once(": ")?;
    REASONS.iter().position(|(name, _)| *name == begins)
}

impl Inspected {
    fn is_right(&self) -> bool {
        self.refused
            && self
                .reason
                .is_some_and(|reason| REASONS[reason].1.contains(&self.defect))
    }

    fn line(&self) -> String {
        let right = if self.is_right() { "right" } else { "WRONG" };
        format!(
            "{}: {right}: {} of {}: {}",
            self.seed, self.defect, self.motor, self.said
        )
    }
}

/// Which defects were taken for what.
fn text(all: &[Inspected]) -> String {
    let names = REASONS.map(|(name, _)| name);
    let mut head = vec!["defect", "machines", "right"];
    head.extend(names);
    head.extend(["no reason", "not refused"]);
    let rows: Vec<Vec<String>> = Defect::ALL
        .iter()
        .map(|defect| {
            let of: Vec<_> = all
                .iter()
                .filter(|inspected| inspected.defect == *defect)
                .collect();
            let count = |is: &dyn Fn(&Inspected) -> bool| {
                of.iter().filter(|inspected| is(inspected)).count().to_string()
            };
            let mut row = vec![
                defect.to_string(),
                of.len().to_string(),
                count(&Inspected::is_right),
            ];
            let given = (0..names.len())
                .map(|reason| count(&|inspected| inspected.refused && inspected.reason == Some(reason)));
            row.extend(given);
            row.push(count(&|inspected| {
                inspected.refused && inspected.reason.is_none()
            }));
            row.push(count(&|inspected| !inspected.refused));
            row
        })
        .collect();
    let right = all.iter().filter(|inspected| inspected.is_right()).count();
    let head: [&str; 12] = std::array::from_fn(|k| head[k]);
    let rows: Vec<[String; 12]> = rows
        .into_iter()
        .map(|row| std::array::from_fn(|k| row[k].clone()))
        .collect();
    markdown::table(head, 1, &rows) + &format!("\nrefused for the right reason: {right} of {}\n", all.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_counts_for_the_motor_that_has_the_defect() {
        let console =
            "X1: drive gain 1.0\nY: left as it is: friction or play: where it turns\nB: still: its grating\n";
        assert_eq!(said_of("Y", console).as_deref().and_then(reason), Some(3));
        assert_eq!(said_of("B", console).as_deref().and_then(reason), Some(1));
        assert_eq!(said_of("X1", console).as_deref().and_then(reason), None);
        assert_eq!(said_of("X2", console), None);
        let inspected = |defect, refused| Inspected {
            seed: 1,
            motor: "Y",
            defect,
            reason: Some(3),
            refused,
            said: String::new(),
        };
        assert!(inspected(Defect::Play, true).is_right());
        assert!(!inspected(Defect::Play, false).is_right());
        assert!(!inspected(Defect::Resonance, true).is_right());
        assert!(text(&[inspected(Defect::Play, true)]).ends_with("refused for the right reason: 1 of 1\n"));
    }
}
