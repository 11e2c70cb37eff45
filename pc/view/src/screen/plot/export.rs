//! Curves as a file.

use super::name;
use crate::live::{Signal, Signals};
use crate::texts::Words;
use anyhow::Context;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Writes every tick of the window into a new file in `folder`: a line for each, an own time for each signal.
pub(super) fn write(
    folder: &Path,
    words: Words,
    shown: &Signals,
    chosen: &[Signal],
    window_s: f64,
) -> anyhow::Result<PathBuf> {
    let courses: Vec<_> = chosen
        .iter()
        .map(|signal| shown.course(*signal, window_s, usize::MAX))
        .collect();
    let headings = chosen.iter().map(|signal| {
        let unit = signal.unit().name();
        format!("time_s,\"{} [{unit}]\"", name(words, *signal))
    });
    let mut text = headings.collect::<Vec<_>>().join(",") + "\n";
    for row in 0..courses.iter().map(Vec::len).max().unwrap_or(0) {
        let values = courses.iter().map(|course| match course.get(row) {
            Some([time, value]) => format!("{time:.6},{value:.6}"),
            None => ",".to_owned(),
        });
        writeln!(text, "{}", values.collect::<Vec<_>>().join(","))?;
    }
    std::fs::create_dir_all(folder).with_context(|| format!("cannot write in {}", folder.display()))?;
    let free = (1..)
        .map(|number| folder.join(format!("curves-{number:03}.csv")))
        .find(|file| !file.exists());
    let file = free.context("there is no free number")?;
    std::fs::write(&file, text).with_context(|| format!("cannot write {}", file.display()))?;
    Ok(file)
}
