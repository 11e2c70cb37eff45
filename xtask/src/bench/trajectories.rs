//! Programs through the trajectory planner, one after the other, beside what another planner took for them.

use super::report::Report;
use super::row::{Calls, Row};
use super::{TRAJECTORIES, bounded, build, callgrind, folder, publish};
use anyhow::{Context, Result, ensure};
use benchmarks::trajectories::{Outcome, baseline};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Of programs of segments.
const SEGMENTS: &str = "seg";
/// Of free-form curves, ...
const CURVE: &str = "json";
/// ... which are programs at each of these feeds \[mm/s\].
const FEEDS: [&str; 3] = ["50", "100", "200"];
/// File of the baseline, in the folder of the programs.
pub const BASELINE: &str = "baseline.csv";
/// To the benchmark program: run a program.
const TRAJECTORY: &str = "trajectory";
/// A program takes seconds.
const LIMIT: Duration = Duration::from_secs(300);

/// Runs all programs of a folder; succeeds if every limit was kept.
pub fn run(programs: &Path, instructions: bool, record: bool) -> Result<ExitCode> {
    let baselines = baselines(programs)?;
    let programs = all(programs)?;
    let folder = folder()?;
    let benchmark = build(None)?;
    let mut rows = Vec::new();
    for Program { name, file, feed } in programs {
        eprintln!("{name}");
        let (outcome, calls) = one(&benchmark, &file, feed, &folder, instructions)
            .with_context(|| file.display().to_string())?;
        rows.push(Row {
            baseline: baselines.as_ref().and_then(|rows| rows.get(&name)).copied(),
            program: name,
            outcome,
            calls,
        });
    }
    let report = Report {
        rows,
        instructions,
        compared: baselines.is_some(),
    };
    publish(TRAJECTORIES, &report.text(), record)?;
    Ok(if report.kept() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// What is run.
#[derive(Clone, Debug, PartialEq)]
struct Program {
    name: String,
    file: PathBuf,
    /// Of a free-form curve.
    feed: Option<&'static str>,
}

/// The programs of a folder, in the order of their names, then the free-form curves.
fn all(folder: &Path) -> Result<Vec<Program>> {
    let cannot = || format!("cannot read the programs of {}", folder.display());
    let folder = folder.canonicalize().with_context(cannot)?;
    let entries = fs::read_dir(&folder).with_context(cannot)?;
    let mut files = entries
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<Vec<PathBuf>>>()
        .with_context(cannot)?;
    files.sort();
    let of = |extension: &'static str| {
        let is_one = move |file: &&PathBuf| file.extension().is_some_and(|its| its == extension);
        files.iter().filter(is_one)
    };
    let name = |file: &Path| {
        file.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    let segments = of(SEGMENTS).map(|file| Program {
        name: name(file),
        file: file.clone(),
        feed: None,
    });
    let curves = of(CURVE).flat_map(|file| {
        FEEDS.map(|feed| Program {
            name: format!("{} at {feed} mm/s", name(file)),
            file: file.clone(),
            feed: Some(feed),
        })
    });
    let programs: Vec<Program> = segments.chain(curves).collect();
    ensure!(
        !programs.is_empty(),
        "no program (*.{SEGMENTS}) and no curve (*.{CURVE}) in {}",
        folder.display()
    );
    Ok(programs)
}

/// The rows of the folder's baseline, if it has one.
fn baselines(folder: &Path) -> Result<Option<BTreeMap<String, baseline::Baseline>>> {
    let file = folder.join(BASELINE);
    if !file.exists() {
        return Ok(None);
    }
    let cannot = || format!("cannot read {}", file.display());
    let text = fs::read_to_string(&file).with_context(cannot)?;
    baseline::read(&text).with_context(cannot).map(Some)
}

/// Runs one program, and counts its ticks if asked to.
fn one(
    benchmark: &Path,
    file: &Path,
    feed: Option<&str>,
    folder: &Path,
    instructions: bool,
) -> Result<(Outcome, Option<Calls>)> {
    let file = file.to_str().context("the name of the file is not text")?;
    let arguments: Vec<&str> = [TRAJECTORY, file].into_iter().chain(feed).collect();
    if !instructions {
        let program = benchmark.display().to_string();
        let arguments: Vec<String> = arguments.into_iter().map(str::to_owned).collect();
        let said = bounded::run(&program, &arguments, folder, "pc.console", LIMIT)?;
        return Ok((Outcome::parse(&said)?, None));
    }
    let (said, calls) = callgrind::count(benchmark, &arguments, folder)?;
    let outcome = Outcome::parse(&said)?;
    let calls = outcome.figures.is_ok().then(|| sorted(&calls, &outcome.pushed));
    Ok((outcome, calls.transpose()?))
}

/// Parts calls into ticks and the elements that came before each. The first does nothing: what that costs, counting
/// costs.
fn sorted(calls: &[u32], pushed: &[u8]) -> Result<Calls> {
    let (nothing, calls) = calls.split_first().context("callgrind saw no call")?;
    let expected = pushed.len() + pushed.iter().map(|n| usize::from(*n)).sum::<usize>();
    ensure!(
        calls.len() == expected,
        "callgrind saw {} calls of the {expected} made",
        calls.len()
    );
    let mut calls = calls.iter().map(|call| call.saturating_sub(*nothing));
    let mut sorted = Calls::default();
    for n in pushed {
        sorted.pushes.extend(calls.by_ref().take(usize::from(*n)));
        sorted.ticks.extend(calls.next());
    }
    Ok(sorted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_are_parted_and_the_first_tells_what_counting_costs() {
        let calls = sorted(&[8, 18, 28, 108, 58, 38, 68], &[2, 0, 1]).expect("all");
        assert_eq!(calls.pushes, [10, 20, 30]);
        assert_eq!(calls.ticks, [100, 50, 60]);
        assert!(sorted(&[8, 108], &[1]).is_err());
        assert!(sorted(&[], &[]).is_err());
    }

    #[test]
    fn segments_come_first_and_curves_at_every_feed() {
        let folder = tempfile::tempdir().expect("a folder");
        for file in ["b.seg", "a.json", "a.seg", "baseline.csv"] {
            fs::write(folder.path().join(file), "").expect("a file");
        }
        let programs = all(folder.path()).expect("programs");
        let names: Vec<&str> = programs.iter().map(|program| program.name.as_str()).collect();
        assert_eq!(
            names,
            ["a", "b", "a at 50 mm/s", "a at 100 mm/s", "a at 200 mm/s"]
        );
        assert_eq!(programs[4].feed, Some("200"));
    }

    #[test]
    fn a_folder_without_programs_is_an_error() {
        let error = all(Path::new(env!("CARGO_MANIFEST_DIR")))
            .unwrap_err()
            .to_string();
        assert!(error.contains("no program"), "{error}");
    }
}
