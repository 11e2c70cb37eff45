//! The measurement of pictures: what a picture costs, and how far it is off.

use super::planner::Log;
use super::{VISION, VISION_COST, bounded, build_as, callgrind, folder, markdown, publish};
use anyhow::{Context, Result, ensure};
use std::process::ExitCode;
use std::time::Duration;

/// Pictures through the truth renderer take a tenth of a second each.
const LIMIT: Duration = Duration::from_secs(3600);

/// The profile of the PC's own programs.
const PROFILE: &str = "release";

const COST: [&str; 4] = ["picture", "mode", "million instructions", "ms"];

const GAP: [&str; 15] = [
    "gaps",
    "pictures",
    "with seam",
    "measured %",
    "waiting",
    "believed %",
    "without seam",
    "centre rms µm",
    "99 %",
    "worst",
    "height rms µm",
    "mean of 4, 99 %",
    "bias",
    "width rms µm",
    "roll rms",
];

const CORNER: [&str; 9] = [
    "corners",
    "pictures",
    "believed %",
    "centre rms µm",
    "worst",
    "mean of 8 rms",
    "height rms µm",
    "bias",
    "mean of 8 rms",
];

const LIMITS: [&str; 4] = ["limit", "measured", "allowed", "verdict"];

/// Counts, times and measures `pictures`, none of them if that is 0, prints the tables, and puts them into the documentation if `record`.
pub fn run(pictures: u64, record: bool) -> Result<ExitCode> {
    let folder = folder()?;
    let pc = build_as(PROFILE, None)?;
    let program = pc.display().to_string();
    let say = |arguments: &[String]| bounded::run(&program, arguments, &folder, "pc.console", LIMIT);
    eprintln!("timing");
    let timed = Log::read(&say(&["vision-time".to_owned()])?)?.by_function()?;
    eprintln!("counting instructions");
    let (said, counted) = callgrind::count(&pc, &["vision-cost"], &folder)?;
    let counted = Log::read(&said)?.with_counts(&counted)?.by_function()?;
    ensure!(
        timed.len() == counted.len(),
        "what was timed is not what was counted"
    );
    let lines: Vec<[String; COST.len()]> = counted
        .iter()
        .zip(&timed)
        .map(|(counted, timed)| {
            [
                counted.program.clone(),
                counted.function.replace('_', " "),
                format!("{:.1}", counted.mean() / 1e6),
                format!("{:.2}", timed.mean() / 1e6),
            ]
        })
        .collect();
    publish(VISION_COST, &markdown::table(COST, 2, &lines), record)?;
    if pictures == 0 {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!("measuring {pictures} pictures");
    let arguments = ["vision-accuracy".to_owned(), pictures.to_string()];
    let said = bounded::run_aloud(&program, &arguments, &folder, "pc.console", LIMIT)?;
    let gaps = markdown::table(GAP, 1, &lines_of(&said, "gap")?);
    let corners = markdown::table(CORNER, 1, &lines_of(&said, "corner")?);
    let limits = markdown::table(LIMITS, 1, &lines_of(&said, "limit")?);
    publish(VISION, &format!("{limits}\n{gaps}\n{corners}"), record)?;
    Ok(ExitCode::SUCCESS)
}

/// The lines of one kind, as they were printed.
fn lines_of<const N: usize>(said: &str, kind: &str) -> Result<Vec<[String; N]>> {
    let of_kind = said
        .lines()
        .filter_map(|line| line.strip_prefix(kind)?.strip_prefix('\t'));
    let lines = of_kind.map(|line| {
        let cells: Vec<String> = line.split('\t').map(str::to_owned).collect();
        cells
            .try_into()
            .ok()
            .with_context(|| format!("not {N} cells: {line}"))
    });
    let lines: Vec<[String; N]> = lines.collect::<Result<_>>()?;
    ensure!(!lines.is_empty(), "the benchmark printed no line of a {kind}");
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::lines_of;

    #[test]
    fn lines_are_told_by_their_first_word() {
        let said = "gap\tall\t1\ncorner\tplain\t2\ngap\trolled\t3\n";
        let gaps: Vec<[String; 2]> = lines_of(said, "gap").expect("lines");
        assert_eq!(gaps, [["all", "1"], ["rolled", "3"]]);
        assert!(lines_of::<3>(said, "gap").is_err());
        assert!(lines_of::<2>(said, "plate").is_err());
    }
}
