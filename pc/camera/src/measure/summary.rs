//! What many measured pictures come to.

use super::Outcome;
use super::verdict::{DOUBTFUL_BELOW, Verdict};
use std::collections::BTreeMap;
use std::fmt;
use vision::{Form, Measured};

/// Counts of verdicts, and what was measured in the pictures that show a seam without doubt.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    counts: BTreeMap<Verdict, usize>,
    quality: Spread,
    width_mm: Spread,
    step_mm: Spread,
}

/// Smallest, largest and mean of what there was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spread {
    number: usize,
    least: f64,
    most: f64,
    sum: f64,
}

impl Summary {
    /// Takes a picture, and says what is to be thought of it.
    pub fn add(&mut self, outcome: &Outcome) -> Verdict {
        let verdict = Verdict::of(outcome);
        *self.counts.entry(verdict).or_default() += 1;
        if let (Verdict::Seam, Some(seam)) = (verdict, outcome.report.seam()) {
            self.measured(seam);
        }
        verdict
    }

    fn measured(&mut self, seam: &Measured) {
        self.quality.add(seam.quality);
        if seam.form == Form::Gap {
            self.width_mm.add(seam.width_mm);
            self.step_mm.add(seam.step_mm);
        }
    }

    /// Number of pictures.
    pub fn pictures(&self) -> usize {
        self.counts.values().sum()
    }

    fn of(&self, name: &str) -> usize {
        let of = self.counts.iter().filter(|(verdict, _)| verdict.name() == name);
        of.map(|(_, count)| count).sum()
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [seam, doubtful, refused] = ["seam", "doubtful", "refused"].map(|name| self.of(name));
        writeln!(
            f,
            "{} pictures: {seam} with a seam, {doubtful} doubtful, {refused} refused",
            self.pictures()
        )?;
        let mut counts: Vec<_> = self.counts.iter().collect();
        counts.sort_by_key(|(verdict, count)| (verdict.name(), std::cmp::Reverse(**count)));
        for (verdict, count) in counts {
            if let Some(reason) = verdict.reason() {
                writeln!(f, "  {:<9}{count:>6}  {reason}", verdict.name())?;
            }
        }
        if doubtful > 0 {
            writeln!(
                f,
                "  (doubtful: quality below {DOUBTFUL_BELOW:.2}, or, in a folder of captures, another seam than before)"
            )?;
        }
        for (name, spread, decimals, unit) in [
            ("quality", self.quality, 2, ""),
            ("gap width", self.width_mm, 4, " mm"),
            ("step", self.step_mm, 4, " mm"),
        ] {
            if let Some(mean) = spread.mean() {
                let (least, most) = (spread.least, spread.most);
                writeln!(
                    f,
                    "  {name:<11}{least:.decimals$} to {most:.decimals$}{unit}, mean {mean:.decimals$}{unit}"
                )?;
            }
        }
        Ok(())
    }
}

impl Spread {
    fn add(&mut self, value: f64) {
        let (least, most) = match self.number {
            0 => (value, value),
            _ => (self.least.min(value), self.most.max(value)),
        };
        *self = Self {
            number: self.number + 1,
            least,
            most,
            sum: self.sum + value,
        };
    }

    fn mean(&self) -> Option<f64> {
        (self.number > 0).then(|| self.sum / self.number as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::verdict::tests::{measured, outcome, refused};

    #[test]
    fn verdicts_are_counted_by_reason_and_ranges_are_of_seams_without_doubt() {
        let mut summary = Summary::default();
        for (quality, width_mm) in [(1.0, 0.1), (0.9, 0.2), (0.6, 0.9)] {
            let seam = vision::Measured {
                width_mm,
                ..measured(quality)
            };
            summary.add(&outcome(seam));
        }
        summary.add(&refused());
        summary.add(&refused());
        let text = summary.to_string();
        for line in [
            "5 pictures: 2 with a seam, 1 doubtful, 2 refused\n",
            "  doubtful      1  the edges are too rough\n",
            "  refused       2  nothing is sharp\n",
            "  quality    0.90 to 1.00, mean 0.95\n",
            "  gap width  0.1000 to 0.2000 mm, mean 0.1500 mm\n",
            "  step       0.0100 to 0.0100 mm, mean 0.0100 mm\n",
        ] {
            assert!(text.contains(line), "{line} is missing in\n{text}");
        }
    }
}
