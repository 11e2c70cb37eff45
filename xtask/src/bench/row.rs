//! One program that was run, what it must keep, and its line of the table.

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

/// A figure, and what it must not exceed.
pub struct Limit {
    pub name: &'static str,
    pub of: fn(&Figures) -> f64,
    most: f64,
}

/// What every program must keep.
pub const LIMITS: [Limit; 8] = [
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
    /// Whether it is not exceeded, and a number.
    pub fn is_kept(&self, figures: &Figures) -> bool {
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

/// Head of the table.
pub const HEAD: [&str; 12] = [
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

impl Row {
    /// Nothing if it did not come to its end.
    pub fn figures(&self) -> Option<&Figures> {
        self.outcome.figures.as_ref().ok()
    }

    /// Whether it took too long beside a baseline that kept its limits.
    pub fn is_slow(&self) -> bool {
        let slow = |figures: &Figures, base: Baseline| {
            base.trapezoid >= SHORT && !broken(&base) && figures.time > SLOW * base.trapezoid
        };
        self.figures()
            .zip(self.baseline)
            .is_some_and(|(figures, base)| slow(figures, base))
    }

    /// How even the speed is along a curve.
    pub fn evenness(&self) -> Option<String> {
        let even = self.outcome.evenness?;
        let mut line = format!(
            "{}: speed along the curve even to {:.1e} before the output filter",
            self.program, even.interpolator
        );
        if even.outputs > 0 {
            line += &format!(
                ", {:.1e} behind it in the {} ticks at full feed; speed of the true tip there to {:.1e}",
                even.output, even.outputs, even.tip
            );
        }
        Some(line)
    }

    /// Whether the speed along a curve is as even as it must be.
    pub fn is_even(&self) -> bool {
        self.outcome.evenness.is_none_or(|even| even.interpolator <= EVEN)
    }

    /// Its line of the table.
    pub fn cells(&self) -> [String; HEAD.len()] {
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

/// The mean of what was counted, to the nearest.
pub fn mean(calls: &[u32]) -> String {
    let total: u64 = calls.iter().map(|call| u64::from(*call)).sum();
    format!("{:.0}", total as f64 / calls.len() as f64)
}

fn broken(base: &Baseline) -> bool {
    base.trapezoid_acceleration > BASELINE_ACCELERATION || base.trapezoid_contour > BASELINE_CONTOUR
}
