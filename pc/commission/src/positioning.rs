//! Positioning accuracy of an axis, judged as in ISO 230-2, and the table that makes up for its systematic part.

use shared::config::{DEVIATION_POINTS, DeviationConfig};
use thiserror::Error;

/// Targets that are nearer to each other than this are one (mm or degrees).
const ONE_TARGET: f64 = 1e-4;
/// Steps of a table are even within this part.
const EVEN: f64 = 1e-3;

/// The tool at rest at a target (mm or degrees).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Where the axis was sent.
    pub target: f64,
    /// Actual place less target, in the unit of what deviates.
    pub deviation: f64,
    /// It came from above.
    pub backwards: bool,
}

/// All approaches to one target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Target {
    /// Where it is.
    pub at: f64,
    /// Deviations of those from below, and of those from above.
    pub deviations: [Vec<f64>; 2],
}

/// An axis that was sent to targets from both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Positioning {
    /// In the order of their places.
    targets: Vec<Target>,
}

/// What ISO 230-2 tells of an axis, in the unit of what deviates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositioningFigures {
    /// Bidirectional accuracy A, with two standard deviations; not of one run.
    pub accuracy: Option<f64>,
    /// Bidirectional systematic deviation E.
    pub systematic: f64,
    /// Range of the mean bidirectional deviation M: what a table takes away.
    pub mean_range: f64,
    /// Bidirectional repeatability R; not of one run.
    pub repeatability: Option<f64>,
    /// Largest reversal value B.
    pub reversal: f64,
}

/// Why approaches tell nothing.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoPositioning {
    /// Too few targets.
    #[error("there are {0} targets, at least 2 are needed")]
    Few(usize),
    /// One side is missing.
    #[error("the target at {at} was approached only from {}", if *.backwards { "above" } else { "below" })]
    OneSide {
        /// The target.
        at: f64,
        /// The side that is there.
        backwards: bool,
    },
}

impl Target {
    /// Mean deviation from each side.
    fn means(&self) -> [f64; 2] {
        self.deviations.each_ref().map(|deviations| mean(deviations))
    }

    /// Mean of both sides.
    pub fn mean(&self) -> f64 {
        let [below, above] = self.means();
        (below + above) / 2.0
    }

    /// Standard deviation of each side, where there are two approaches at least.
    fn scatter(&self) -> Option<[f64; 2]> {
        let [below, above] = self.deviations.each_ref().map(|deviations| scatter(deviations));
        Some([below?, above?])
    }

    /// Bidirectional repeatability there.
    fn repeatability(&self) -> Option<f64> {
        let [s_below, s_above] = self.scatter()?;
        let [below, above] = self.means();
        let both = 2.0 * (s_below + s_above) + (below - above).abs();
        Some(both.max(4.0 * s_below).max(4.0 * s_above))
    }
}

impl Positioning {
    /// Sorts approaches by their targets.
    ///
    /// # Errors
    /// There are too few, or a target was not approached from both sides.
    pub fn of(approaches: &[Approach]) -> Result<Self, NoPositioning> {
        let mut targets: Vec<Target> = Vec::new();
        for approach in approaches {
            let same = |target: &&mut Target| (target.at - approach.target).abs() < ONE_TARGET;
            let side = usize::from(approach.backwards);
            match targets.iter_mut().find(same) {
                Some(target) => target.deviations[side].push(approach.deviation),
                None => {
                    let mut target = Target {
                        at: approach.target,
                        ..Target::default()
                    };
                    target.deviations[side].push(approach.deviation);
                    targets.push(target);
                }
            }
        }
        if targets.len() < 2 {
            return Err(NoPositioning::Few(targets.len()));
        }
        targets.sort_by(|a, b| a.at.total_cmp(&b.at));
        for target in &targets {
            if let Some(missing) = target.deviations.iter().position(Vec::is_empty) {
                return Err(NoPositioning::OneSide {
                    at: target.at,
                    backwards: missing == 0,
                });
            }
        }
        Ok(Self { targets })
    }

    /// The targets, in the order of their places.
    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// What ISO 230-2 tells.
    pub fn figures(&self) -> PositioningFigures {
        let targets = || self.targets.iter();
        let with_scatter = |sign: f64| {
            let each = targets().map(move |target| {
                let [s_below, s_above] = target.scatter()?;
                let [below, above] = target.means();
                Some([below + sign * 2.0 * s_below, above + sign * 2.0 * s_above])
            });
            each.collect::<Option<Vec<_>>>()
        };
        let accuracy = with_scatter(1.0).zip(with_scatter(-1.0)).map(|(high, low)| {
            most(high.into_iter().flatten()) + most(low.into_iter().flatten().map(|x| -x))
        });
        let repeatability: Option<Vec<f64>> = targets().map(Target::repeatability).collect();
        PositioningFigures {
            accuracy,
            systematic: range(targets().flat_map(Target::means)),
            mean_range: range(targets().map(Target::mean)),
            repeatability: repeatability.map(|all| most(all.into_iter())),
            reversal: most(targets().map(|target| {
                let [below, above] = target.means();
                (below - above).abs()
            })),
        }
    }

    /// The table for `motor`, measured along `axis`: the means of both sides beside what `held` made up for meanwhile, in even steps,
    /// 0 at the reference mark of the axis, from where its grating counts. Between uneven targets it is straight.
    pub fn table(
        &self,
        axis: usize,
        motor: usize,
        mark: f64,
        held: Option<&DeviationConfig>,
    ) -> DeviationConfig {
        let (first, last) = (self.targets[0].at, self.targets[self.targets.len() - 1].at);
        let points = self.targets.len().min(DEVIATION_POINTS);
        let step = (last - first) / (points - 1) as f64;
        let total = |at: f64| self.between(at) + held.map_or(0.0, |held| held.at(at));
        let at_mark = total(mark);
        let value = |point: usize| (total(first + step * point as f64) - at_mark) as f32;
        DeviationConfig {
            axis: axis as u8,
            motor: motor as u8,
            from: first,
            step,
            values: (0..points).map(value).collect(),
        }
    }

    /// Targets in even steps, as tables have them.
    pub fn is_even(&self) -> bool {
        let steps = || self.targets.windows(2).map(|pair| pair[1].at - pair[0].at);
        let longest = most(steps());
        self.targets.len() <= DEVIATION_POINTS && steps().all(|step| step > (1.0 - EVEN) * longest)
    }

    /// Mean of both sides at `at`, straight between targets.
    fn between(&self, at: f64) -> f64 {
        let after = self.targets.partition_point(|target| target.at <= at);
        let Some(after) = self.targets.get(after) else {
            return self.targets[self.targets.len() - 1].mean();
        };
        let Some(before) = self.targets.iter().rev().find(|target| target.at <= at) else {
            return self.targets[0].mean();
        };
        let part = (at - before.at) / (after.at - before.at);
        before.mean() + part * (after.mean() - before.mean())
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn scatter(values: &[f64]) -> Option<f64> {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (values.len() - 1) as f64).sqrt())
}

fn most(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}

fn range(values: impl Iterator<Item = f64> + Clone) -> f64 {
    most(values.clone()) + most(values.map(|x| -x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two targets, two approaches from each side, by hand: below 1, 3 and 4, 6; above 2, 2 and 9, 11.
    fn by_hand() -> Positioning {
        let approach = |target, backwards, deviation| Approach {
            target,
            deviation,
            backwards,
        };
        let approaches = [
            approach(10.0, false, 1.0),
            approach(20.0, false, 4.0),
            approach(20.0, true, 9.0),
            approach(10.0, true, 2.0),
            approach(10.0, false, 3.0),
            approach(20.0, false, 6.0),
            approach(20.0, true, 11.0),
            approach(10.0, true, 2.0),
        ];
        Positioning::of(&approaches).unwrap()
    }

    #[test]
    fn figures_are_those_of_the_standard() {
        let figures = by_hand().figures();
        // Means 2, 2 and 5, 10; standard deviations √2, 0 and √2, √2.
        let s = 2_f64.sqrt();
        assert_eq!(figures.systematic, 8.0);
        assert_eq!(figures.mean_range, 5.5);
        assert_eq!(figures.reversal, 5.0);
        assert!((figures.repeatability.unwrap() - (4.0 * s + 5.0)).abs() < 1e-12);
        assert!((figures.accuracy.unwrap() - (10.0 + 2.0 * s - (2.0 - 2.0 * s))).abs() < 1e-12);
    }

    #[test]
    fn one_run_has_no_scatter_and_both_sides_are_needed() {
        let there: Vec<_> = [0.0, 5.0, 10.0]
            .map(|target| Approach {
                target,
                deviation: 0.01,
                backwards: false,
            })
            .into();
        let error = Positioning::of(&there).unwrap_err().to_string();
        assert_eq!(error, "the target at 0 was approached only from below");
        let back = there.iter().map(|approach| Approach {
            backwards: true,
            ..*approach
        });
        let both: Vec<_> = there.iter().copied().chain(back).collect();
        let figures = Positioning::of(&both).unwrap().figures();
        assert_eq!((figures.accuracy, figures.repeatability), (None, None));
        assert_eq!(Positioning::of(&both[..1]), Err(NoPositioning::Few(1)));
    }

    #[test]
    fn a_table_is_nothing_at_the_mark_and_goes_beside_what_held() {
        let positioning = by_hand();
        assert!(positioning.is_even());
        let table = positioning.table(1, 2, 15.0, None);
        assert_eq!(
            (table.axis, table.motor, table.from, table.step),
            (1, 2, 10.0, 10.0)
        );
        // Means 2 and 7.5, 4.75 at the mark.
        assert_eq!(table.values, [-2.75, 2.75]);
        let again = positioning.table(1, 2, 15.0, Some(&table));
        assert_eq!(again.values, [-5.5, 5.5]);
    }

    #[test]
    fn uneven_and_many_targets_become_even_steps() {
        let line = |at: f64| 0.001 * at;
        let approaches: Vec<_> = (0..200)
            .flat_map(|k| {
                let target = f64::from(k) + 0.3 * f64::from(k).sin();
                [false, true].map(|backwards| Approach {
                    target,
                    deviation: line(target),
                    backwards,
                })
            })
            .collect();
        let positioning = Positioning::of(&approaches).unwrap();
        assert!(!positioning.is_even());
        let table = positioning.table(0, 0, 0.0, None);
        assert_eq!(table.values.len(), DEVIATION_POINTS);
        for (k, value) in table.values.iter().enumerate() {
            let at = table.from + table.step * k as f64;
            assert!((f64::from(*value) - line(at)).abs() < 1e-6, "{at}: {value}");
        }
    }
}
