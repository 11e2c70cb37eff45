//! What the programs took and kept, as a table and in total.

use super::markdown;
use super::row::{Calls, HEAD, LIMITS, Row, mean};
use super::trajectories::BASELINE;
use benchmarks::trajectories::baseline::Baseline;

/// Columns without those of instructions.
const UNCOUNTED: usize = 10;

/// All programs that were run.
pub struct Report {
    pub rows: Vec<Row>,
    /// Whether ticks were counted.
    pub instructions: bool,
    /// Whether there is a baseline.
    pub compared: bool,
}

impl Report {
    /// Whether every program came to its end within all limits, and none is slow beside the baseline.
    pub fn kept(&self) -> bool {
        self.rows.iter().all(|row| {
            row.is_even()
                && !row.is_slow()
                && row
                    .figures()
                    .is_some_and(|figures| LIMITS.iter().all(|limit| limit.is_kept(figures)))
        })
    }

    /// The table and the totals, as Markdown.
    pub fn text(&self) -> String {
        let lines: Vec<[String; HEAD.len()]> = self.rows.iter().map(Row::cells).collect();
        let table = if self.instructions {
            markdown::table(HEAD, 1, &lines)
        } else {
            let shortened: Vec<_> = lines.iter().map(shortened).collect();
            markdown::table(shortened_head(), 1, &shortened)
        };
        let mut text = table + "\n";
        for line in self.totals() {
            text += &format!("- {line}\n");
        }
        text
    }

    fn totals(&self) -> Vec<String> {
        let mut lines = vec![self.time()];
        lines.extend(self.counted("a tick", |calls| &calls.ticks));
        lines.extend(self.counted("to add an element", |calls| &calls.pushes));
        lines.push(listed(
            "not at their end",
            self.rows.iter().filter_map(|row| {
                let why = row.outcome.figures.as_ref().err()?;
                Some(format!("{}: {why}", row.program))
            }),
        ));
        for limit in &LIMITS {
            let beyond = |row: &&Row| row.figures().is_some_and(|figures| !limit.is_kept(figures));
            let named = |row: &Row| {
                let value = row.figures().map_or(f64::NAN, limit.of);
                format!("{} ({value:.4})", row.program)
            };
            lines.push(listed(limit.name, self.rows.iter().filter(beyond).map(named)));
        }
        lines.extend(self.rows.iter().filter_map(Row::evenness));
        lines.push(listed(
            "slower than 1.05 × a trapezoid that took 0.5 s and kept its limits",
            self.rows
                .iter()
                .filter(|row| row.is_slow())
                .map(|row| row.program.clone()),
        ));
        let alone = self.rows.iter().filter(|row| row.baseline.is_none());
        lines.push(if self.compared {
            listed(
                "without a row of the baseline",
                alone.map(|row| row.program.clone()),
            )
        } else {
            format!("no {BASELINE} beside the programs: none is compared")
        });
        lines
    }

    fn time(&self) -> String {
        let time = |row: &Row| row.figures().map_or(0.0, |figures| figures.time);
        let all: f64 = self.rows.iter().map(time).sum();
        let mut line = format!("{} programs in {all:.3} s", self.rows.len());
        let compared: Vec<(f64, Baseline)> = self
            .rows
            .iter()
            .filter_map(|row| Some((row.figures()?.time, row.baseline?)))
            .collect();
        if !compared.is_empty() {
            let ours: f64 = compared.iter().map(|(time, _)| time).sum();
            let trapezoid: f64 = compared.iter().map(|(_, base)| base.trapezoid).sum();
            let s_curve: f64 = compared.iter().map(|(_, base)| base.s_curve).sum();
            line += &format!(
                "; {} of them beside the baseline: {:.3} of the trapezoid's {trapezoid:.3} s, {:.3} of the \
                 S-curve's {s_curve:.3} s",
                compared.len(),
                ours / trapezoid,
                ours / s_curve,
            );
        }
        line
    }

    /// What of all runs together was counted.
    fn counted(&self, what: &str, of: fn(&Calls) -> &[u32]) -> Option<String> {
        let runs = self.rows.iter().filter_map(|row| row.calls.as_ref());
        let mut calls: Vec<u32> = runs.flat_map(of).copied().collect();
        calls.sort_unstable();
        let worst = calls.last()?;
        let below = |percent: usize| calls[(calls.len() - 1) * percent / 100];
        Some(format!(
            "instructions {what} (x86-64, {} times): {} in the mean, {worst} in the worst; at most {} in 10 % of \
             them, {} in half, {} in 90 %, {} in 99 %",
            calls.len(),
            mean(&calls),
            below(10),
            below(50),
            below(90),
            below(99),
        ))
    }
}

fn shortened(line: &[String; HEAD.len()]) -> [String; UNCOUNTED] {
    std::array::from_fn(|column| line[column].clone())
}

fn shortened_head() -> [&'static str; UNCOUNTED] {
    std::array::from_fn(|column| HEAD[column])
}

/// How many there are, and which.
fn listed(what: &str, which: impl Iterator<Item = String>) -> String {
    let which: Vec<String> = which.collect();
    if which.is_empty() {
        format!("{what}: 0")
    } else {
        format!("{what}: {}: {}", which.len(), which.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use benchmarks::trajectories::evenness::Evenness;
    use benchmarks::trajectories::{Figures, Outcome};

    fn row(program: &str, time: f64, jerk: f64) -> Row {
        Row {
            program: program.into(),
            outcome: Outcome {
                moves: 4,
                elements: 5,
                pushed: Vec::new(),
                evenness: None,
                figures: Ok(Figures {
                    time,
                    acceleration: 0.99,
                    jerk,
                    path_jerk: 0.5,
                    feed: 1.0,
                    contour: 0.0351,
                    cut_off: 0.0497,
                    end: 0.0,
                    back: 0.0,
                }),
            },
            calls: None,
            baseline: Some(Baseline {
                trapezoid: 1.0,
                trapezoid_acceleration: 2000.0,
                trapezoid_contour: 37.0,
                s_curve: 2.0,
            }),
        }
    }

    fn report(rows: Vec<Row>) -> Report {
        Report {
            rows,
            instructions: false,
            compared: true,
        }
    }

    #[test]
    fn programs_stand_beside_the_baseline() {
        let report = report(vec![row("square", 0.9, 1.0), row("round", 1.0, 1.04)]);
        let text = report.text();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[2].starts_with("| square  |     4 |  0.900 |       0.900 |     0.450 |"));
        assert_eq!(
            lines[5],
            "- 2 programs in 1.900 s; 2 of them beside the baseline: 0.950 of the trapezoid's 2.000 s, 0.475 of \
             the S-curve's 4.000 s"
        );
        assert!(lines[6..].iter().all(|line| line.ends_with(": 0")), "{text}");
        assert!(report.kept());
    }

    #[test]
    fn what_is_not_kept_is_named() {
        let broken = report(vec![row("square", 0.9, 1.051)]);
        assert!(!broken.kept());
        assert!(broken.text().contains("jerk > 1.05 ×: 1: square (1.0510)"));

        let mut stuck = row("stuck", 0.0, 0.0);
        stuck.outcome.figures = Err("at rest in line 3".into());
        let stuck = report(vec![stuck]);
        assert!(!stuck.kept());
        assert!(
            stuck
                .text()
                .contains("not at their end: 1: stuck: at rest in line 3")
        );

        assert!(!report(vec![row("nan", 1.0, f64::NAN)]).kept());
    }

    #[test]
    fn curves_must_be_even() {
        let mut curve = row("bow", 0.9, 1.0);
        curve.outcome.evenness = Some(Evenness {
            interpolator: 4e-7,
            output: 3e-4,
            tip: 9e-4,
            outputs: 70,
        });
        let even = report(vec![curve.clone()]);
        assert!(even.kept());
        assert!(even.text().contains(
            "- bow: speed along the curve even to 4.0e-7 before the output filter, 3.0e-4 behind it in the 70 ticks \
             at full feed; speed of the true tip there to 9.0e-4"
        ));
        curve.outcome.evenness = Some(Evenness {
            interpolator: 1.1e-6,
            output: 0.0,
            tip: 0.0,
            outputs: 0,
        });
        assert!(!report(vec![curve]).kept());
    }

    #[test]
    fn only_a_baseline_that_is_long_and_within_limits_shows_who_is_slow() {
        let slow = "slower than 1.05 × a trapezoid that took 0.5 s and kept its limits: 1: late";
        let late = row("late", 1.06, 1.0);
        assert!(report(vec![late.clone()]).text().contains(slow));
        assert!(!report(vec![late.clone()]).kept());
        for change in [
            |base: &mut Baseline| base.trapezoid_acceleration = 2021.0,
            |base: &mut Baseline| base.trapezoid_contour = 50.1,
            |base: &mut Baseline| base.trapezoid = 0.49,
        ] {
            let mut late = late.clone();
            change(late.baseline.as_mut().expect("one"));
            let report = report(vec![late]);
            assert!(!report.text().contains(slow) && report.kept());
        }
    }

    #[test]
    fn what_the_baseline_does_not_have_is_named() {
        let mut alone = row("alone", 1.0, 1.0);
        alone.baseline = None;
        let named = "without a row of the baseline: 1: alone";
        assert!(
            report(vec![row("both", 1.0, 1.0), alone.clone()])
                .text()
                .contains(named)
        );
        // Also if it has none of the programs.
        assert!(report(vec![alone.clone()]).text().contains(named));
        let mut report = report(vec![alone]);
        report.compared = false;
        let text = report.text();
        assert!(text.ends_with("- no baseline.csv beside the programs: none is compared\n"));
        assert!(!text.contains("without a row"));
    }

    #[test]
    fn instructions_have_their_columns() {
        let mut counted = row("square", 0.9, 1.0);
        counted.calls = Some(Calls {
            ticks: vec![100, 800, 200, 900],
            pushes: vec![70],
        });
        let text = Report {
            rows: vec![counted],
            instructions: true,
            compared: true,
        }
        .text();
        assert!(text.contains("|       500 |   900 |"), "{text}");
        assert!(
            text.contains("a tick (x86-64, 4 times): 500 in the mean, 900 in the worst; at most 100 in 10 %")
        );
        assert!(text.contains("an element (x86-64, 1 times): 70 in the mean, 70 in the worst"));
    }
}
