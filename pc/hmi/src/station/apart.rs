//! Jobs that a page has begun for itself: the machine is commissioned, or the cameras are taught.

use super::Station;
use crate::running::{Outcome, Running, Task};
use cam::along::Along;
use commission::bidirectional_mm;
use config::sentence;
use std::time::Duration;

/// The jobs of one page.
#[derive(Debug, Default)]
pub(super) struct Apart {
    runs: bool,
    last: Option<Result<Outcome, String>>,
    ended: u32,
}

impl Apart {
    /// The job that runs is one of them.
    pub(super) fn runs(&self) -> bool {
        self.runs
    }

    /// How the last one ended.
    pub(super) fn last(&self) -> Option<&Result<Outcome, String>> {
        self.last.as_ref()
    }

    /// How many have ended.
    pub(super) fn ended(&self) -> u32 {
        self.ended
    }

    /// One begins.
    pub(super) fn begin(&mut self) {
        (self.runs, self.last) = (true, None);
    }

    fn end(&mut self, outcome: Result<Outcome, String>) {
        (self.runs, self.last, self.ended) = (false, Some(outcome), self.ended + 1);
    }
}

impl Station {
    /// Begins `task`.
    pub(super) fn begin_apart(&mut self, task: Task) {
        self.begin_record(Along::default());
        (self.override_percent, self.last) = (100.0, None);
        self.running = Some(Running::start(task, self.place.clone(), self.stage.as_ref()));
    }

    /// Takes how a job ended, if that was one that a page has begun for itself; otherwise gives it back.
    pub(super) fn take_apart(
        &mut self,
        outcome: anyhow::Result<Outcome>,
        now: Duration,
    ) -> Option<anyhow::Result<Outcome>> {
        let jobs = [&mut self.commissioned, &mut self.lessons];
        let Some(jobs) = jobs.into_iter().find(|jobs| jobs.runs) else {
            return Some(outcome);
        };
        let outcome = outcome.map_err(|error| sentence(error.as_ref()));
        let journal = &mut self.live.journal;
        match &outcome {
            Err(error) => journal.alarm(now, error),
            Ok(Outcome {
                circle: Some((test, seen)),
                ..
            }) => {
                let [there, back] = seen.figures.map(|figures| figures.contour_mm);
                let both = bidirectional_mm(&seen.turns);
                let told = format!(
                    "{test}: at most {:.4} mm from the circle, G(b) {both:.4} mm",
                    there.max(back)
                );
                journal.message(now, &told);
            }
            Ok(Outcome {
                spot: Some(found), ..
            }) => {
                let [u, v] = found.result.moved_mm.map(|mm| 1e3 * mm);
                let told = format!(
                    "camera {}: the spot has moved by {u:+.1} µm in U and {v:+.1} µm in V since the calibration before",
                    found.side + 1
                );
                journal.message(now, &told);
            }
            Ok(Outcome {
                taught: Some(taught), ..
            }) => {
                for told in taught.told().unwrap_or_default() {
                    journal.message(now, &told);
                }
            }
            Ok(_) => {}
        }
        jobs.end(outcome);
        None
    }
}
