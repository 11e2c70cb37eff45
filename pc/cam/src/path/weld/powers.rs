//! Power along the seam of a weld, tacks aside.

use config::weld_data::WeldSet;

/// A change of the power: from what it is there, evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// Where it begins \[mm\].
    pub(super) at: f64,
    /// Over so much of the seam \[mm\].
    pub(super) over: f64,
    /// To this power.
    pub(super) to: f64,
}

/// The power over the seam.
#[derive(Clone, Debug)]
pub(super) struct Powers {
    /// At the beginning.
    pub(super) first: f64,
    /// In the order of their places.
    pub(super) steps: Vec<Step>,
}

impl Step {
    /// The power at `s` \[mm\], which was `from` where it began.
    fn toward(&self, from: f64, s: f64) -> f64 {
        let part = (s - self.at) / self.over;
        if s >= self.at + self.over {
            self.to
        } else {
            from + (self.to - from) * part
        }
    }
}

impl Powers {
    /// Of `set`, on a seam of `length` \[mm\].
    pub(super) fn of(set: &WeldSet, length: f64) -> Self {
        let ignites = set.ignition.map(|ignition| ignition.power);
        let ramps = set.ramp_up.map(|ramp| ramp.power);
        let begin = Step {
            at: 0.0,
            over: set.ramp_up.map_or(0.0, |ramp| ramp.over_mm),
            to: set.power,
        };
        let changes = set.changes.iter().filter_map(|change| {
            Some(Step {
                at: change.at_mm,
                over: change.over_mm,
                to: change.power?,
            })
        });
        let end = set.ramp_down.map(|ramp| Step {
            at: length - ramp.over_mm,
            over: ramp.over_mm,
            to: ramp.power,
        });
        let mut steps: Vec<Step> = [begin].into_iter().chain(changes).chain(end).collect();
        steps.sort_by(|a, b| a.at.total_cmp(&b.at));
        Self {
            first: ignites.or(ramps).unwrap_or(set.power),
            steps,
        }
    }

    /// At `s` \[mm\].
    pub(super) fn at(&self, s: f64) -> f64 {
        let mut power = self.first;
        for (index, step) in self.steps.iter().enumerate().take_while(|(_, step)| step.at <= s) {
            let next = self.steps.get(index + 1).map_or(s, |next| next.at.min(s));
            power = step.toward(power, next);
        }
        power
    }

    /// What is left at `s` \[mm\] of the step that it lies in.
    pub(super) fn left(&self, s: f64) -> Option<Step> {
        let begun = self.steps.iter().rev().find(|step| step.at <= s)?;
        let over = begun.at + begun.over - s;
        (over > 0.0).then_some(Step {
            at: s,
            over,
            to: begun.to,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_goes_evenly_from_step_to_step_and_a_step_may_begin_in_another() {
        let step = |at, over, to| Step { at, over, to };
        let powers = Powers {
            first: 1000.0,
            steps: vec![
                step(0.0, 10.0, 2000.0),
                step(20.0, 10.0, 4000.0),
                step(25.0, 10.0, 1000.0),
                step(50.0, 0.0, 500.0),
            ],
        };
        for (s, power) in [
            (0.0, 1000.0),
            (5.0, 1500.0),
            (15.0, 2000.0),
            (25.0, 3000.0),
            (30.0, 2000.0),
            (40.0, 1000.0),
            (50.0, 500.0),
        ] {
            assert_eq!(powers.at(s), power, "at {s}");
        }
        assert_eq!(powers.left(22.0), Some(step(22.0, 8.0, 4000.0)));
        assert_eq!(powers.left(32.0), Some(step(32.0, 3.0, 1000.0)));
        assert_eq!((powers.left(15.0), powers.left(60.0)), (None, None));
    }
}
