//! Curves at feeds below and above what they can be gone along with, beside the best constant speed.

use super::row::LIMITS;
use super::{CURVES, bounded, build, folder, markdown, publish};
use anyhow::{Result, ensure};
use benchmarks::trajectories::curves::{FEEDS, Feeds};
use std::process::ExitCode;
use std::time::Duration;

/// A curve takes under a second.
const LIMIT: Duration = Duration::from_secs(1200);
/// A higher feed counts as slower from so many times the time of a lower one on.
const SLOWER: f64 = 1.03;

/// Runs curves of each kind, and `random` ones from a `seed` on; succeeds if all come to their ends and every limit was kept.
pub fn run(random: u64, seed: u64, record: bool) -> Result<ExitCode> {
    let program = build(None)?.display().to_string();
    let arguments = ["curves".to_owned(), random.to_string(), seed.to_string()];
    let said = bounded::run(&program, &arguments, &folder()?, "pc.console", LIMIT)?;
    let curves = Feeds::parse(&said)?;
    ensure!(!curves.is_empty(), "no curve was run; it printed:\n{said}");
    let wrong: Vec<String> = curves.iter().flat_map(wrong).collect();
    publish(CURVES, &text(&curves, &wrong), record)?;
    Ok(match wrong.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::FAILURE,
    })
}

/// The table, and the totals.
fn text(curves: &[Feeds], wrong: &[String]) -> String {
    let feeds = FEEDS.map(|feed| format!("{feed} ×"));
    let head: [&str; 2 + FEEDS.len()] = std::array::from_fn(|column| match column {
        0 => "curve",
        1 => "mm/s",
        _ => &feeds[column - 2],
    });
    let cells: Vec<_> = curves.iter().map(cells).collect();
    let mut shares: Vec<f64> = curves.iter().flat_map(Feeds::shares).flatten().collect();
    shares.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let last = shares.len().saturating_sub(1) as f64;
        shares.get((part * last) as usize).copied().unwrap_or(f64::NAN)
    };
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let slower: usize = curves.iter().map(slower).sum();
    let mut text = markdown::table(head, 1, &cells) + "\n";
    text += &format!(
        "- {} runs of {} curves: mean {mean:.3}, 90 % {:.3}, 99 % {:.3}, worst {:.3}\n",
        shares.len(),
        curves.len(),
        at(0.9),
        at(0.99),
        at(1.0)
    );
    text += &format!("- slower by 3 % or more than at some lower feed: {slower}\n");
    text += &format!("- not at their end, or a limit not kept: {}\n", wrong.len());
    for line in wrong {
        text += &format!("  - {line}\n");
    }
    text
}

/// Its line of the table.
fn cells(curve: &Feeds) -> [String; 2 + FEEDS.len()] {
    let shares = curve.shares();
    std::array::from_fn(|column| match column {
        0 => curve.name.clone(),
        1 => format!("{:.1}", curve.speed),
        _ => shares[column - 2].map_or_else(|| "–".to_owned(), |share| format!("{share:.3}")),
    })
}

/// At how many feeds it takes longer than at a lower one.
fn slower(curve: &Feeds) -> usize {
    let mut quickest = f64::INFINITY;
    let times = curve.runs.iter().flatten().map(|figures| figures.time);
    times
        .filter(|time| {
            let slower = *time >= SLOWER * quickest;
            quickest = quickest.min(*time);
            slower
        })
        .count()
}

/// What is wrong with its runs.
fn wrong(curve: &Feeds) -> Vec<String> {
    let runs = curve.runs.iter().zip(FEEDS);
    runs.flat_map(|(run, feed)| {
        let what: Vec<String> = match run {
            Err(why) => vec![why.clone()],
            Ok(figures) => LIMITS
                .iter()
                .filter(|limit| !limit.is_kept(figures))
                .map(|limit| format!("{}: {:.4}", limit.name, (limit.of)(figures)))
                .collect(),
        };
        what.into_iter()
            .map(move |what| format!("{} at {feed} ×: {what}", curve.name))
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use benchmarks::trajectories::Figures;

    fn figures(time: f64, jerk: f64) -> Figures {
        Figures {
            time,
            acceleration: 1.0,
            jerk,
            path_jerk: 1.0,
            feed: 1.0,
            contour: 0.0,
            cut_off: 0.0,
            end: 0.0,
            back: 0.0,
        }
    }

    #[test]
    fn what_is_slower_and_what_is_wrong_is_told() {
        let mut curve = Feeds {
            name: "wave".to_owned(),
            speed: 100.0,
            runs: vec![Ok(figures(3.0, 1.0)); FEEDS.len()],
        };
        assert_eq!((slower(&curve), wrong(&curve).len()), (0, 0));
        curve.runs[3] = Ok(figures(3.2, 1.06));
        curve.runs[5] = Err("stuck".to_owned());
        assert_eq!(slower(&curve), 1);
        let wrong = wrong(&curve);
        assert_eq!(
            wrong,
            ["wave at 1.4 ×: jerk > 1.05 ×: 1.0600", "wave at 3 ×: stuck"]
        );
        // 150 mm at 60 mm/s, to which it comes in 0.05 s + 0.06 s.
        assert!((curve.shares()[0].unwrap_or_default() - 3.0 / 2.61).abs() < 1e-9);
        assert!(text(&[curve], &wrong).contains("limit not kept: 2\n"));
    }
}
