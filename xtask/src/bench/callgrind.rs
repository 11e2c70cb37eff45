//! The PC's program under callgrind, which counts from outside.
//!
//! It collects only while the function `measured` runs, and writes what it has collected whenever that begins again:
//! after a part of its file without calls, one part a call, in the order of the calls. (It could write whenever the
//! function returns; but not together with collecting there only.) The program's own records say whose calls they are.

use super::{Counts, Row, bounded};
use anyhow::{Context, Result, bail, ensure};
use benchmarks::record::Tally;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::time::Duration;

const VALGRIND: &str = "valgrind";
/// It takes a minute or so.
const LIMIT: Duration = Duration::from_secs(900);
/// The function within which instructions count.
const MEASURED: &str = "benchmarks::meter::measured";
const FILE: &str = "callgrind.out";

/// Runs the benchmark called `name` in `folder`.
pub fn run(program: &Path, name: &str, folder: &Path) -> Result<Counts> {
    let (said, calls) = count(program, &[name], folder)?;
    let mut counts = Counts::read(&said)?;
    assign(&mut counts.rows, &calls)?;
    Ok(counts)
}

/// Runs `program` in `folder`: what it said, and the instructions of each call that it measured.
pub fn count(program: &Path, arguments: &[&str], folder: &Path) -> Result<(String, Vec<u32>)> {
    let program = program.display().to_string();
    let flags = [
        "--tool=callgrind".to_owned(),
        format!("--callgrind-out-file={FILE}"),
        format!("--toggle-collect={MEASURED}"),
        format!("--dump-before={MEASURED}"),
        "--combine-dumps=yes".to_owned(),
        "--dump-line=no".to_owned(),
    ];
    let words = [program.as_str()].into_iter().chain(arguments.iter().copied());
    let arguments: Vec<String> = flags.into_iter().chain(words.map(str::to_owned)).collect();
    let path = folder.join(FILE);
    let cannot = || format!("cannot read {}", path.display());
    // Callgrind would continue with the file of a run that did not come to its end.
    if path.exists() {
        fs::remove_file(&path).with_context(cannot)?;
    }
    let said = bounded::run(VALGRIND, &arguments, folder, "pc.console", LIMIT)?;
    let parts = totals(BufReader::new(File::open(&path).with_context(cannot)?))?;
    // It is large.
    fs::remove_file(&path).with_context(cannot)?;
    let Some((0, calls)) = parts.split_first() else {
        bail!("callgrind has counted before the first call");
    };
    Ok((said, calls.to_vec()))
}

/// Instructions of each part of callgrind's file.
fn totals(file: impl BufRead) -> Result<Vec<u32>> {
    let mut totals = Vec::new();
    for line in file.lines() {
        let line = line.context("cannot read callgrind's file")?;
        if let Some(total) = line.strip_prefix("totals: ") {
            totals.push(total.parse().with_context(|| format!("not a count: {line}"))?);
        }
    }
    Ok(totals)
}

/// Puts the calls where they belong: subject by subject, the functions of a subject were called in
/// turns.
fn assign(rows: &mut [Row], calls: &[u32]) -> Result<()> {
    let expected: usize = rows.iter().map(|row| row.tally.calls as usize).sum();
    ensure!(
        calls.len() == expected,
        "callgrind saw {} calls of the {expected} made",
        calls.len()
    );
    let mut calls = calls.iter();
    for functions in rows.chunk_by_mut(|a, b| a.subject == b.subject) {
        let turns = functions[0].tally.calls;
        for row in functions.iter_mut() {
            ensure!(
                row.tally.calls == turns,
                "functions called in turns are called as often: {row:?}"
            );
            row.tally = Tally::default();
        }
        for _ in 0..turns {
            for (row, instructions) in functions.iter_mut().zip(calls.by_ref()) {
                row.tally.add(*instructions);
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Row> {
        [
            ("m", "nothing"),
            ("m", "inverse"),
            ("n", "nothing"),
            ("n", "inverse"),
        ]
        .map(|(subject, function)| Row {
            subject: subject.into(),
            function: function.into(),
            tally: Tally {
                calls: 2,
                total: 0,
                worst: 0,
            },
        })
        .into()
    }

    #[test]
    fn the_totals_of_all_parts_are_read() {
        let file =
            "part: 1\nsummary: 0\n\ntotals: 0\npart: 2\nfn=(1) x\n3 281\nsummary: 281\n\ntotals: 281\n";
        assert_eq!(totals(file.as_bytes()).expect("numbers"), [0, 281]);
        assert!(totals("totals: many".as_bytes()).is_err());
    }

    #[test]
    fn calls_in_turns_go_to_their_functions() {
        let mut rows = rows();
        assign(&mut rows, &[8, 100, 8, 120, 9, 200, 9, 180]).expect("complete");
        let seen: Vec<_> = rows
            .iter()
            .map(|row| (row.tally.total, row.tally.worst))
            .collect();
        assert_eq!(seen, [(16, 8), (220, 120), (18, 9), (380, 200)]);
    }

    #[test]
    fn missing_calls_are_an_error() {
        assert!(assign(&mut rows(), &[8, 100, 8, 120, 9, 200, 9]).is_err());
        assert!(assign(&mut rows(), &[8, 100, 8, 120, 9, 200, 9, 180, 9]).is_err());
        assert!(assign(&mut rows(), &[]).is_err());
    }
}
