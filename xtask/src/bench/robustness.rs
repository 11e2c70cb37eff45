//! Machines drawn at random, on simulated boards: how each welds the shipped job of its kind with the shipped gains, and how
//! when it was commissioned, and the positions of its linear axes measured.

use super::{bad, bounded, markdown};
use crate::cargo::root;
use crate::firmware::build_seamwright;
use crate::weld::{SEAM, job_of};
use anyhow::{Context, Result};
use plant_file::Quality;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Commissioning takes some ten seconds, a weld some seconds.
pub const LIMIT: Duration = Duration::from_secs(600);
/// The dual-beam gantry goes as fast as it may \[m/min\], with cameras that see where the seam is, not pictures.
const GANTRY: [&str; 4] = ["--speed", "9", "--camera", "geometric"];
/// Parts of the draws that are told.
const PARTS: [f64; 3] = [0.5, 0.95, 1.0];
/// Deviations within which draws are counted \[mm\].
const WITHIN_MM: [f64; 3] = [0.05, 0.08, 0.10];

/// What commissioning says of a motor that stays as it was, without the reason.
const LEFT: &str = ": left as it is: ";

/// What is drawn.
pub struct Draws {
    /// Name of the machine.
    pub machine: String,
    /// How good it is.
    pub quality: Quality,
    /// The first seed, and how many follow.
    pub seed: u32,
    /// How many.
    pub draws: u32,
}

/// A weld of a drawn machine.
struct Welded {
    /// Largest deviation of a spot, or of the tip from its path \[mm\]; `None` if it did not come to its end.
    off_mm: Option<f64>,
    /// Why it is not well.
    why: String,
}

/// A machine, with the shipped gains and commissioned.
struct Drawn {
    seed: u32,
    before: Welded,
    after: Welded,
    /// With the softened loops of commissioning it homed, and all motors went to and fro, without a trip.
    moved: bool,
    /// What commissioning said of motors that it left as they were.
    left: Vec<String>,
}

/// Draws, commissions and welds; succeeds if all that were commissioned weld within their limits.
pub fn run(draws: &Draws) -> Result<ExitCode> {
    let program = build_seamwright()?.display().to_string();
    // Of its own, so that several can run side by side.
    let name = format!("robustness-{}-{}-{}", draws.machine, draws.quality, draws.seed);
    let folder = super::folder()?.join(name);
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    if draws.quality == Quality::Bad {
        return bad::run(draws, &program, &folder);
    }
    let mut all = Vec::new();
    for seed in draws.seeds() {
        let drawn = draws.one(&program, &folder, seed)?;
        eprintln!("{}", drawn.line());
        all.push(drawn);
    }
    print!("{}", text(&all));
    let good = all.iter().all(|drawn| drawn.after.is_within());
    Ok(if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

impl Draws {
    /// All seeds.
    pub fn seeds(&self) -> Range<u32> {
        self.seed..self.seed.saturating_add(self.draws)
    }

    /// Words that commission one, with the shipped machine file.
    pub fn commission(&self, output: &Path, seed: u32) -> Vec<String> {
        words(&[
            "commission",
            "--machine",
            &self.shipped().display().to_string(),
            "--plant",
            &format!("draw:{}:{seed}", self.quality),
            "--boards",
            "simulated",
            "-o",
            &output.display().to_string(),
        ])
    }

    /// Axes whose positions are measured, and of what.
    fn measured(&self) -> Vec<(&'static str, &'static str)> {
        let x = if self.machine == plant_file::DEFAULT_MACHINE {
            // Both gratings of the gantry.
            ("X", "X1,X2")
        } else {
            ("X", "X")
        };
        let all = [x, ("Y", "Y"), ("Z", "Z")];
        // The pipe welder has no Y.
        let fitted = |axis: &&(&str, &str)| self.machine != "pipe-welder" || axis.0 != "Y";
        all.iter().filter(fitted).copied().collect()
    }

    /// Words that measure the positions of `axis`, and put them into the `commissioned` file.
    fn positioning(&self, commissioned: &Path, axis: &str, of: &str, seed: u32) -> Vec<String> {
        let file = commissioned.display().to_string();
        words(&[
            "positioning",
            "--machine",
            &file,
            "--axis",
            axis,
            "--of",
            of,
            "--runs",
            "1",
            "--dwell",
            "0.5",
            "--plant",
            &format!("draw:{}:{seed}", self.quality),
            "--boards",
            "simulated",
            "-o",
            &file,
        ])
    }

    fn shipped(&self) -> PathBuf {
        root().join("machines").join(&self.machine).with_extension("toml")
    }

    fn one(&self, program: &str, folder: &Path, seed: u32) -> Result<Drawn> {
        let plant = format!("draw:{}:{seed}", self.quality);
        let commissioned = folder.join("commissioned.toml");
        // Of the draw before.
        let _ = fs::remove_file(&commissioned);
        let arguments = self.commission(&commissioned, seed);
        let told = bounded::run(program, &arguments, folder, "commission.console", LIMIT);
        let said = fs::read_to_string(folder.join("commission.console")).unwrap_or_default();
        let left = said
            .lines()
            .filter(|line| line.contains(LEFT))
            .map(str::to_owned)
            .collect();
        // It homes, and each motor goes to and fro, with loops that are too slow to ring.
        let moved = commissioned.exists();
        let told = if moved {
            self.measured().into_iter().try_for_each(|(axis, of)| {
                let arguments = self.positioning(&commissioned, axis, of, seed);
                bounded::run(program, &arguments, folder, "positioning.console", LIMIT).map(drop)
            })
        } else {
            told.map(drop)
        };
        let after = match told {
            Err(error) => Welded::failed(last_words(&error.to_string())),
            Ok(()) => self.weld(program, folder, &commissioned, &plant)?,
        };
        Ok(Drawn {
            seed,
            before: self.weld(program, folder, &self.shipped(), &plant)?,
            after,
            moved,
            left,
        })
    }

    fn weld(&self, program: &str, folder: &Path, machine: &Path, plant: &str) -> Result<Welded> {
        let report = folder.join("report");
        if report.exists() {
            fs::remove_dir_all(&report).context("cannot remove the last report")?;
        }
        let job = root().join(job_of(&self.machine).context("no such machine is shipped")?);
        let mut arguments = words(&[
            "weld",
            &job.display().to_string(),
            "--machine",
            &machine.display().to_string(),
            "--plant",
            plant,
            "--boards",
            "simulated",
            "--report",
            &report.display().to_string(),
        ]);
        if self.machine == plant_file::DEFAULT_MACHINE {
            arguments.extend(words(&GANTRY));
            arguments.extend(words(&["--seam", &root().join(SEAM).display().to_string()]));
        }
        let ended = bounded::run(program, &arguments, folder, "weld.console", LIMIT);
        let why = ended
            .err()
            .map_or_else(String::new, |error| last_words(&error.to_string()));
        match fs::read_to_string(report.join("report.json")) {
            Ok(text) => Welded::of(&text, why),
            Err(_) => Ok(Welded::failed(why)),
        }
    }
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

/// The last line that a program said.
fn last_words(said: &str) -> String {
    said.lines()
        .rfind(|line| !line.trim().is_empty())
        .unwrap_or_default()
        .to_owned()
}

impl Welded {
    fn failed(why: String) -> Self {
        Self { off_mm: None, why }
    }

    /// Of the report of a weld.
    fn of(report: &str, why: String) -> Result<Self> {
        let report: serde_json::Value = serde_json::from_str(report).context("report.json")?;
        if report["outcome"] != "finished" {
            return Ok(Self::failed(why));
        }
        let spots = report["max_deviation_mm"].as_object().into_iter().flatten();
        let spots = spots.filter_map(|(_, off)| off.as_f64());
        Ok(Self {
            off_mm: spots.reduce(f64::max).or(report["max_contour_error_mm"].as_f64()),
            why,
        })
    }

    fn is_within(&self) -> bool {
        self.off_mm.is_some() && self.why.is_empty()
    }

    fn cell(&self) -> String {
        self.off_mm
            .map_or_else(|| "–".to_owned(), |off| format!("{off:.4}"))
    }
}

impl Drawn {
    fn line(&self) -> String {
        let why = [&self.before, &self.after].map(|welded| welded.why.as_str());
        format!(
            "{}: shipped {} mm {}; commissioned {} mm {}",
            self.seed,
            self.before.cell(),
            why[0],
            self.after.cell(),
            why[1]
        )
    }
}

/// The table of all draws, and how many are within their limits.
fn text(all: &[Drawn]) -> String {
    let of = |name: &str, pick: fn(&Drawn) -> &Welded| {
        let mut off: Vec<f64> = all.iter().filter_map(|drawn| pick(drawn).off_mm).collect();
        off.sort_by(f64::total_cmp);
        let at = |part: f64| {
            // The smallest that so many are within.
            let place = (part * off.len() as f64).ceil() as usize;
            off.get(place.saturating_sub(1))
                .map_or_else(|| "–".to_owned(), |off| format!("{off:.4}"))
        };
        let within = all.iter().filter(|drawn| pick(drawn).is_within()).count();
        let [half, most, worst] = PARTS.map(at);
        let [least, more, most_of_all] =
            WITHIN_MM.map(|limit| off.iter().filter(|off| **off <= limit).count().to_string());
        [
            name.to_owned(),
            all.len().to_string(),
            off.len().to_string(),
            within.to_string(),
            least,
            more,
            most_of_all,
            half,
            most,
            worst,
        ]
    };
    let head = [
        "gains",
        "machines",
        "to the end",
        "within limits",
        "≤ 0.05 mm",
        "≤ 0.08 mm",
        "≤ 0.10 mm",
        "half ≤ mm",
        "95 % ≤ mm",
        "all ≤ mm",
    ];
    let rows = [
        of("shipped", |drawn| &drawn.before),
        of("commissioned", |drawn| &drawn.after),
    ];
    let moved = all.iter().filter(|drawn| drawn.moved).count();
    let left: usize = all.iter().map(|drawn| drawn.left.len()).sum();
    let mut text = markdown::table(head, 1, &rows);
    text += &format!(
        "\nhomed and moved with softened loops: {moved} of {}\n",
        all.len()
    );
    text += &format!("motors that commissioning left as they were: {left}\n");
    for drawn in all {
        text.extend(
            drawn
                .left
                .iter()
                .map(|said| format!("- {}: {said}\n", drawn.seed)),
        );
    }
    for drawn in all.iter().filter(|drawn| !drawn.after.is_within()) {
        text += &format!("- {}: {}\n", drawn.seed, drawn.after.why);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = r#"{"outcome": "finished", "max_deviation_mm": {"u1": 0.03, "v1": 0.04}, "max_contour_error_mm": 0.01}"#;

    #[test]
    fn a_report_gives_the_furthest_spot() {
        let welded = Welded::of(REPORT, String::new()).expect("a report");
        assert_eq!(welded.off_mm, Some(0.04));
        assert!(welded.is_within());
        let stopped = REPORT.replace("finished", "fault");
        assert!(!Welded::of(&stopped, String::new()).expect("a report").is_within());
    }

    #[test]
    fn those_that_fail_are_counted_and_named() {
        let welded = |off| Welded {
            off_mm: Some(off),
            why: String::new(),
        };
        let drawn = |seed, after| Drawn {
            seed,
            before: welded(0.1),
            after,
            moved: true,
            left: vec!["B: left as it is: friction or play".to_owned()],
        };
        let all = [
            drawn(1, welded(0.02)),
            drawn(2, welded(0.04)),
            drawn(3, Welded::failed("seamwright: no".to_owned())),
        ];
        let text = text(&all);
        assert!(
            text.contains(
                "| commissioned |        3 |          2 |             2 |         2 |         2 |         2 |    0.0200 |    0.0400 |   0.0400 |"
            ),
            "{text}"
        );
        assert!(text.contains("- 3: seamwright: no\n"));
        assert!(
            text.contains("softened loops: 3 of 3\n")
                && text.contains("- 1: B: left as it is: friction or play\n")
        );
    }
}
