//! What the programs took and kept, as a table and in total.

use super::markdown;
use benchmarks::trajectories::baseline::Baseline;
use benchmarks::trajectories::{Figures, Outcome};

/// A program that was run.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub program: String,
    pub outcome: Outcome,
    pub calls: Option<Calls>,
    pub baseline: Option<Baseline>,
}

/// Instructions of the calls of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calls {
    pub ticks: Vec<u32>,
    /// Of adding an element.
    pub pushes: Vec<u32>,
}

/// All programs that were run.
pub struct Report {
    pub rows: Vec<Row>,
    /// Whether ticks were counted.
    pub instructions: bool,
}

/// A figure, and what it must not exceed.
struct Limit {
    name: &'static str,
    of: fn(&Figures) -> f64,
    most: f64,
}

const LIMITS: [Limit; 8] = [
    Limit {
        name: "acceleration > 1.01 ×",
        of: |figures| figures.acceleration,
        most: 1.01,
    },
    Limit {
        name: "jerk > 1.05 ×",
        of: |figures| figures.jerk,
        most: 1.05,
    },
    Limit {
        name: "path jerk > 1.05 ×",
        of: |figures| figures.path_jerk,
        most: 1.05,
    },
    Limit {
        name: "feed > 1.01 ×",
        of: |figures| figures.feed,
        most: 1.01,
    },
    Limit {
        name: "contour > 50 µm",
        of: |figures| figures.contour,
        most: 0.05,
    },
    Limit {
        name: "cut off > 50 µm",
        of: |figures| figures.cut_off,
        most: 0.05,
    },
    Limit {
        name: "end off > 1 nm",
        of: |figures| figures.end,
        most: 1e-6,
    },
    Limit {
        name: "back > 1 nm",
        of: |figures| figures.back,
        most: 1e-6,
    },
];

impl Limit {
    fn is_kept(&self, figures: &Figures) -> bool {
        (self.of)(figures) <= self.most
    }
}

/// The baseline's own limits, and what of them it may exceed: acceleration \[mm/s²\] and contour error \[µm\].
const BASELINE_ACCELERATION: f64 = 1.01 * 2000.0;
const BASELINE_CONTOUR: f64 = 50.0;
/// How even the speed along a curve must be before the output filter, as a part of it.
const EVEN: f64 = 1e-6;
/// Programs of the baseline's that are shorter \[s\] are not compared one by one, ...
const SHORT: f64 = 0.5;
/// ... the others may take so many times as long.
const SLOW: f64 = 1.05;

const HEAD: [&str; 12] = [
    "program",
    "moves",
    "time s",
    "/ trapezoid",
    "/ S-curve",
    "a / limit",
    "j / limit",
    "path j / limit",
    "contour µm",
    "cut off µm",
    "tick mean",
    "worst",
];
/// Columns without those of instructions.
const UNCOUNTED: usize = 10;

impl Row {
    fn figures(&self) -> Option<&Figures> {
        self.outcome.figures.as_ref().ok()
    }

    /// Whether it took too long beside a baseline that kept its limits.
    fn is_slow(&self) -> bool {
        let slow = |figures: &Figures, base: Baseline| {
            base.trapezoid >= SHORT && !broken(&base) && figures.time > SLOW * base.trapezoid
        };
        self.figures()
            .zip(self.baseline)
            .is_some_and(|(figures, base)| slow(figures, base))
    }

    /// How even the speed is along a curve.
    fn evenness(&self) -> Option<String> {
        let even = self.outcome.evenness?;
        let mut line = format!(
            "{}: speed along the curve even to {:.1e} before the output filter",
            self.program, even.interpolator
        );
        if even.outputs > 0 {
            line += &format!(
                ", {:.1e} behind it in the {} ticks at full feed",
                even.output, even.outputs
            );
        }
        Some(line)
    }

    fn is_even(&self) -> bool {
        self.outcome.evenness.is_none_or(|even| even.interpolator <= EVEN)
    }

    fn cells(&self) -> [String; HEAD.len()] {
        let figure = |of: fn(&Figures) -> f64, decimals: usize| {
            self.figures()
                .map_or_else(|| "–".to_owned(), |figures| format!("{:.decimals$}", of(figures)))
        };
        let ratio = |to: fn(&Baseline) -> f64| {
            self.figures()
                .zip(self.baseline.as_ref())
                .map_or_else(String::new, |(figures, base)| {
                    format!("{:.3}", figures.time / to(base))
                })
        };
        let ticks = |of: fn(&[u32]) -> String| {
            let calls = self.calls.as_ref();
            calls.map_or_else(String::new, |calls| of(&calls.ticks))
        };
        let mark = if self.baseline.is_some_and(|base| broken(&base)) {
            " *"
        } else {
            ""
        };
        [
            self.program.clone(),
            self.outcome.moves.to_string(),
            figure(|figures| figures.time, 3),
            ratio(|base| base.trapezoid) + mark,
            ratio(|base| base.s_curve),
            figure(|figures| figures.acceleration, 3),
            figure(|figures| figures.jerk, 3),
            figure(|figures| figures.path_jerk, 3),
            figure(|figures| figures.contour * 1000.0, 1),
            figure(|figures| figures.cut_off * 1000.0, 1),
            ticks(mean),
            ticks(|ticks| ticks.iter().max().map_or_else(String::new, u32::to_string)),
        ]
    }
}

fn mean(calls: &[u32]) -> String {
    let total: u64 = calls.iter().map(|call| u64::from(*call)).sum();
    format!("{:.0}", total as f64 / calls.len() as f64)
}

fn broken(base: &Baseline) -> bool {
    base.trapezoid_acceleration > BASELINE_ACCELERATION || base.trapezoid_contour > BASELINE_CONTOUR
}

impl Report {
    /// Whether every program came to its end within all limits.
    pub fn kept(&self) -> bool {
        self.rows.iter().all(|row| {
            row.is_even()
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
            outputs: 70,
        });
        let even = report(vec![curve.clone()]);
        assert!(even.kept());
        assert!(even.text().contains(
            "- bow: speed along the curve even to 4.0e-7 before the output filter, 3.0e-4 behind it in the 70 ticks"
        ));
        curve.outcome.evenness = Some(Evenness {
            interpolator: 1.1e-6,
            output: 0.0,
            outputs: 0,
        });
        assert!(!report(vec![curve]).kept());
    }

    #[test]
    fn only_a_baseline_that_is_long_and_within_limits_shows_who_is_slow() {
        let slow = "slower than 1.05 × a trapezoid that took 0.5 s and kept its limits: 1: late";
        let late = row("late", 1.06, 1.0);
        assert!(report(vec![late.clone()]).text().contains(slow));
        for change in [
            |base: &mut Baseline| base.trapezoid_acceleration = 2021.0,
            |base: &mut Baseline| base.trapezoid_contour = 50.1,
            |base: &mut Baseline| base.trapezoid = 0.49,
        ] {
            let mut late = late.clone();
            change(late.baseline.as_mut().expect("one"));
            assert!(!report(vec![late]).text().contains(slow));
        }
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
        }
        .text();
        assert!(text.contains("|       500 |   900 |"), "{text}");
        assert!(
            text.contains("a tick (x86-64, 4 times): 500 in the mean, 900 in the worst; at most 100 in 10 %")
        );
        assert!(text.contains("an element (x86-64, 1 times): 70 in the mean, 70 in the worst"));
    }
}
