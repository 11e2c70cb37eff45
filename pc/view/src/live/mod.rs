//! What the screen knows of a job: its events, folded as they come. It is bounded, however long the job.

mod deviations;
mod journal;
mod signals;

pub use deviations::{Bin, Changed, Deviations};
pub use journal::{Earlier, Entry, Journal, Severity, What};
pub use signals::{SIGNALS, Signal, Signals, Unit};

use cam::along::Along;
use host_link::events::{Event, MeasuredPicture, Phase, Question};
use shared::io::SIDES;
use shared::protocol::{MotionSample, MotionStatus, TrackerStatus};
use shared::state::State;
use std::sync::Arc;
use std::time::Duration;

/// After so long without a word from the boards, what is shown is old, and nothing can be commanded.
const SILENCE: Duration = Duration::from_millis(500);

/// A job, as its events tell it.
#[derive(Debug, Default)]
pub struct Live {
    /// What it is doing.
    pub phase: Option<Phase>,
    /// What the machine waits for.
    pub question: Option<Question>,
    /// The motion board, as it said last.
    pub motion: Option<Box<MotionStatus>>,
    /// The tracker board, as it said last.
    pub tracker: Option<TrackerStatus>,
    /// The newest tick of the motion board.
    pub newest: Option<MotionSample>,
    /// The latest picture of each camera.
    pub pictures: [Option<Arc<MeasuredPicture>>; SIDES],
    /// How far the spots were beside their seams.
    pub deviations: Deviations,
    /// What the boards' telemetry tells, over time.
    pub signals: Signals,
    /// What was said last to what was asked for by hand; nothing once the machine moves.
    pub told: Option<String>,
    /// What happened.
    pub journal: Journal,
    /// Samples that the screen was too slow for.
    pub lost: u64,
    /// The job has ended.
    pub ended: bool,
    along: Along,
    /// When a board was heard last, by the screen's clock.
    heard: Option<Duration>,
}

impl Live {
    /// Of a job whose paths are counted by `along`. What happened before is in `journal`.
    pub fn new(along: Along, journal: Journal) -> Self {
        Self {
            along,
            journal,
            ..Self::default()
        }
    }

    /// Takes an event that came at `now` by the screen's clock.
    pub fn take(&mut self, event: &Event, now: Duration) {
        match event {
            Event::Connected { motion, tracker } => {
                self.heard = Some(now);
                self.journal.connected(now, motion.as_ref(), tracker.as_ref());
            }
            Event::Status { motion, tracker } => {
                self.heard = Some(now);
                if motion.state == State::Running {
                    self.question = None;
                }
                self.motion = Some(motion.clone());
                self.tracker.clone_from(tracker);
            }
            Event::MotionSamples(samples) => {
                self.heard = Some(now);
                samples.iter().for_each(|sample| self.signals.motion(sample));
                self.newest = samples.last().copied().or(self.newest);
            }
            Event::TrackerSamples(samples) => {
                for sample in samples.iter() {
                    self.signals.tracker(sample);
                    let at = self.signals.motion_at(sample.time_us);
                    if let Some(tick) = at.filter(|tick| tick.beams.contains(&true))
                        && let Some(along_mm) = self.along.at(tick.path_id, tick.s_mm)
                    {
                        self.deviations.tick(along_mm, tick.beams, sample);
                    }
                }
            }
            Event::Picture(picture) => {
                if let Some(latest) = self.pictures.get_mut(picture.side) {
                    *latest = Some(Arc::clone(picture));
                }
            }
            Event::Phase(phase) => {
                let goes_on = self.phase.is_some_and(|before| is_same(before, *phase));
                (self.phase, self.question, self.told) = (Some(*phase), None, None);
                // A hand that jogs does it a hundred times.
                if *phase != Phase::Jogging && !goes_on {
                    self.journal.phase(now, *phase);
                }
            }
            Event::Question(question) => {
                self.question = Some(question.clone());
                if *question != Question::ByHand {
                    self.journal.question(now, question);
                }
            }
            Event::Message(text) => {
                self.told = Some(text.clone());
                self.journal.message(now, text);
            }
            Event::MotionFault(fault) => self.journal.motion_fault(now, *fault),
            Event::TrackerFault(fault) => self.journal.tracker_fault(now, *fault),
            Event::End { error, .. } => {
                (self.ended, self.question) = (true, None);
                self.journal.end(now, error.as_deref());
            }
            Event::Progress { .. } | Event::Capture(_) | Event::Measurement { .. } => {}
        }
    }

    /// When a board was heard last, by the screen's clock.
    pub fn heard(&self) -> Option<Duration> {
        self.heard
    }

    /// A board was heard last at `heard`, by the screen's clock.
    pub fn set_heard(&mut self, heard: Option<Duration>) {
        self.heard = heard;
    }

    /// How long the boards have been silent, where that is too long to trust what is shown; `None` before they were heard.
    pub fn silent_for(&self, now: Duration) -> Option<Duration> {
        let silent = now.saturating_sub(self.heard?);
        (!self.ended && silent > SILENCE).then_some(silent)
    }

    /// State of the motion board, as it said last.
    pub fn state(&self) -> Option<State> {
        self.motion.as_ref().map(|motion| motion.state)
    }

    /// Whether a beam is on.
    pub fn beam_is_on(&self) -> bool {
        let on = |sample: &MotionSample| sample.beams.contains(&true);
        !self.ended && self.newest.as_ref().is_some_and(on)
    }

    /// Path and place that the machine is at, as the newest tick says: number and \[mm\].
    pub fn place(&self) -> Option<(u32, f64)> {
        self.newest.as_ref().map(|newest| (newest.path_id, newest.s_mm))
    }

    /// Length along all that works \[mm\].
    pub fn along_mm(&self) -> Option<f64> {
        let (path, s_mm) = self.place()?;
        self.along.at(path, s_mm)
    }
}

/// Whether a motor is excited once more.
fn is_same(before: Phase, now: Phase) -> bool {
    match (before, now) {
        (Phase::Exciting { motor: before, .. }, Phase::Exciting { motor: now, .. }) => before == now,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::state::Fault;

    fn at(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    fn connected() -> Event {
        Event::Connected {
            motion: None,
            tracker: None,
        }
    }

    #[test]
    fn silent_boards_are_seen_within_half_a_second_and_only_while_there_is_a_job() {
        let mut live = Live::default();
        assert_eq!(live.silent_for(at(9000)), None);
        live.take(&connected(), at(1000));
        assert_eq!(live.silent_for(at(1500)), None);
        assert_eq!(live.silent_for(at(1501)), Some(at(501)));
        live.take(&Event::MotionSamples(Arc::new([])), at(1600));
        assert_eq!(live.silent_for(at(2000)), None);
        let end = Event::End {
            error: None,
            duration: at(1000),
        };
        live.take(&end, at(1700));
        assert_eq!(live.silent_for(at(9000)), None);
    }

    #[test]
    fn a_question_stands_until_the_job_goes_on() {
        let mut live = Live::default();
        live.take(&Event::Question(Question::FeedTooLow), at(0));
        assert_eq!(live.question, Some(Question::FeedTooLow));
        live.take(&Event::Phase(Phase::Welding), at(1));
        assert_eq!(live.question, None);
    }

    #[test]
    fn a_fault_is_one_alarm_until_it_is_acknowledged() {
        let mut live = Live::default();
        let fault = Fault::EmergencyStop;
        live.take(&Event::MotionFault(fault), at(0));
        let end = Event::End {
            error: Some(format!("the motion board stopped: {fault}")),
            duration: at(1),
        };
        live.take(&end, at(1));
        assert_eq!(live.journal.open_alarms().count(), 1);
        live.journal.acknowledge();
        assert_eq!(live.journal.open_alarms().count(), 0);
        live.take(&Event::MotionFault(fault), at(2));
        assert_eq!(live.journal.open_alarms().count(), 1);
    }
}
