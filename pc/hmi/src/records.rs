//! Reports of past jobs, read back from their folders.

use crate::live::Deviations;
use anyhow::{Context, bail};
use serde_json::Value;
use shared::io::{SLIDE_NAMES, SLIDES};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Name of the report in its folder.
const REPORT: &str = "report.json";

/// The report of a job.
#[derive(Clone, Debug)]
pub struct Record {
    /// Name of its folder.
    pub name: String,
    /// The program, the machine file and the boards, as they were named.
    pub of: [String; 3],
    /// It came to its end, within all limits.
    pub is_good: bool,
    /// It came to its end.
    pub is_finished: bool,
    /// Why it ended early, as sentences.
    pub faults: Vec<String>,
    /// How long it took \[s\].
    pub duration_s: f64,
    /// What the part says of it, in the order of their keys.
    pub figures: Vec<Judged>,
    /// True deviations along the seams, where they are known.
    pub deviations: Deviations,
}

/// A figure of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// What it is, in English.
    pub text: String,
    /// Its value.
    pub value: f64,
    /// Unit of all of its numbers.
    pub unit: String,
    /// What it may be at least and at most.
    pub may_be: [Option<f64>; 2],
}

impl Judged {
    /// Whether it is outside what it may be.
    pub fn is_outside(&self) -> bool {
        let [least, most] = self.may_be;
        least.is_some_and(|least| self.value < least) || most.is_some_and(|most| self.value > most)
    }
}

/// Folders with a report in `reports`, the newest first by their names.
pub fn folders(reports: &Path) -> Vec<PathBuf> {
    let found = std::fs::read_dir(reports).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = found
        .map(|entry| entry.path())
        .filter(|folder| folder.join(REPORT).is_file())
        .collect();
    folders.sort();
    folders.reverse();
    folders
}

impl Record {
    /// Reads the report in `folder`, and of its log the deviations.
    ///
    /// # Errors
    /// A sentence with the file.
    pub fn read(folder: &Path) -> anyhow::Result<Self> {
        let file = folder.join(REPORT);
        let text = std::fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
        let report: Value =
            serde_json::from_slice(&text).with_context(|| format!("{} is no report", file.display()))?;
        let text = |key: &str| report[key].as_str().unwrap_or_default().to_owned();
        let Some(outcome) = report["outcome"].as_str() else {
            bail!("{} is no report: it has no outcome", file.display());
        };
        let figures: Vec<Judged> = report["figures"]
            .as_object()
            .into_iter()
            .flatten()
            .filter_map(judged)
            .collect();
        let is_finished = outcome == "finished";
        let is_whole = report["unwelded"].as_array().is_none_or(Vec::is_empty);
        Ok(Self {
            name: folder
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            of: [
                text("program"),
                text("machine"),
                report["boards"]["choice"].as_str().unwrap_or_default().to_owned(),
            ],
            is_good: is_finished && is_whole && !figures.iter().any(Judged::is_outside),
            is_finished,
            faults: report["faults"]
                .as_array()
                .into_iter()
                .flatten()
                .filter_map(|fault| Some(fault.as_str()?.to_owned()))
                .collect(),
            duration_s: report["duration_s"].as_f64().unwrap_or(0.0),
            figures,
            deviations: deviations(&folder.join(report::LOG)).unwrap_or_default(),
        })
    }
}

fn judged((_, figure): (&String, &Value)) -> Option<Judged> {
    Some(Judged {
        text: figure["text"].as_str()?.to_owned(),
        value: figure["value"].as_f64()?,
        unit: figure["unit"].as_str()?.to_owned(),
        may_be: [figure["least"].as_f64(), figure["limit"].as_f64()],
    })
}

/// The deviations in a log, by the names of its columns; `None` of a log without them.
fn deviations(log: &Path) -> Option<Deviations> {
    let mut lines = BufReader::new(File::open(log).ok()?)
        .lines()
        .map_while(Result::ok);
    let heading = lines.next()?;
    let column = |name: &str| heading.split(',').position(|column| column == name);
    let (along, beams) = (column("along_mm")?, [column("beam_1")?, column("beam_2")?]);
    let mut slides = [0; SLIDES];
    for (slide, name) in SLIDE_NAMES.iter().enumerate() {
        slides[slide] = column(&format!("deviation_{}_mm", name.to_lowercase()))?;
    }
    let mut seen = Deviations::default();
    for line in lines {
        let values: Vec<&str> = line.split(',').collect();
        let number = |column: usize| values.get(column)?.parse::<f64>().ok();
        if let Some(along_mm) = number(along) {
            let on = beams.map(|column| number(column) == Some(1.0));
            let of_slide = |slide: usize| number(slides[slide]).filter(|_| on[slide / 2]);
            seen.add(along_mm, std::array::from_fn(of_slide));
        }
    }
    Some(seen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_read_back_with_its_verdict_and_its_deviations() {
        let reports = tempfile::tempdir().unwrap();
        let folder = reports.path().join("0002-t");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::create_dir_all(reports.path().join("0003-nothing")).unwrap();
        let report = r#"{"outcome": "finished", "program": "t.ngc", "machine": "m.toml", "boards": {"choice": "simulated"},
            "figures": {"a": {"text": "far", "value": 0.06, "unit": "mm", "limit": 0.05},
                        "b": {"text": "long", "value": 7, "unit": "mm", "limit": null}},
            "unwelded": [], "faults": [], "duration_s": 3.5}"#;
        std::fs::write(folder.join(REPORT), report).unwrap();
        let log = "tick,along_mm,beam_1,beam_2,deviation_u1_mm,deviation_v1_mm,deviation_u2_mm,deviation_v2_mm\n\
                   1,,0,0,,,,\n2,0.5,1,0,0.01,-0.02,0.9,0.9\n";
        std::fs::write(folder.join(report::LOG), log).unwrap();
        assert_eq!(folders(reports.path()), std::slice::from_ref(&folder));
        let record = Record::read(&folder).unwrap();
        assert!(record.is_finished && !record.is_good);
        assert_eq!(
            record.figures.iter().filter(|figure| figure.is_outside()).count(),
            1
        );
        assert_eq!(record.deviations.worst_between(0.5, 0.5), Some(0.02));
        std::fs::write(folder.join(REPORT), "{}").unwrap();
        let said = Record::read(&folder).unwrap_err().to_string();
        assert!(said.ends_with("is no report: it has no outcome"), "{said}");
    }
}
