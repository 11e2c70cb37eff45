//! What a viewer knows of the screen that it watches, folded from messages.

use super::wire::{Message, Update};
use crate::drawn::Drawn;
use crate::live::Live;
use crate::seen::{Seen, Standing};
use cam::along::Along;
use shared::kinematics::Kinematics;
use std::sync::Arc;
use std::time::Duration;

/// After so long without a message, or by one that is older, what is shown is old.
pub const SILENCE: Duration = Duration::from_millis(500);

/// How fast one clock may run away from the other: more than two of quartz do.
const DRIFT: f64 = 2e-4;

/// See the module.
#[derive(Debug, Default)]
pub struct Watched {
    /// The job that runs there, or the last one.
    pub live: Live,
    standing: Standing,
    program: Option<(Drawn, Kinematics)>,
    clock: Option<Clock>,
}

/// What is known of the clock of the screen that serves.
#[derive(Clone, Copy, Debug)]
struct Clock {
    /// The newest message was sent then, by that clock.
    sent: Duration,
    /// It came then, by the viewer's.
    came: Duration,
    /// The least that the viewer's was ahead of it when a message came, which is the quickest that one came \[s\].
    ahead_s: f64,
}

impl Clock {
    /// How far the viewer's clock may be ahead at `now`, however the two run \[s\].
    fn ahead_s_at(&self, now: Duration) -> f64 {
        self.ahead_s + DRIFT * now.saturating_sub(self.came).as_secs_f64()
    }
}

impl Watched {
    /// Takes a message that came at `now`, by the viewer's clock.
    pub fn take(&mut self, message: Message, now: Duration) {
        let came_s = now.as_secs_f64() - message.at.as_secs_f64();
        let ahead_s = self
            .clock
            .map_or(came_s, |clock| clock.ahead_s_at(now).min(came_s));
        if message.is_all {
            *self = Self::default();
        }
        self.clock = Some(Clock {
            sent: message.at,
            came: now,
            ahead_s,
        });
        for update in message.updates {
            self.update(update, now);
        }
        let heard = message.heard_before.map(|before| now.saturating_sub(before));
        self.live.set_heard(heard);
    }

    /// Another connection, perhaps to a screen that was opened anew: its clock is not known yet.
    pub fn reconnected(&mut self) {
        self.clock = None;
    }

    /// What there is to see.
    pub fn seen(&self) -> Seen<'_> {
        Seen {
            live: &self.live,
            program: self
                .program
                .as_ref()
                .map(|(drawn, kinematics)| (drawn, kinematics)),
            standing: self.standing.clone(),
        }
    }

    /// How old what is shown is; `None` before anything came. It counts from the message that came quickest: a delay that all have is not
    /// in it.
    pub fn age(&self, now: Duration) -> Option<Duration> {
        let clock = self.clock?;
        let age_s = now.as_secs_f64() - clock.ahead_s_at(now) - clock.sent.as_secs_f64();
        Some(Duration::try_from_secs_f64(age_s).unwrap_or_default())
    }

    fn update(&mut self, update: Update, now: Duration) {
        match update {
            Update::Program(drawn) => self.begin(drawn.map(|drawn| *drawn)),
            Update::Listing(listing) => {
                if let Some((drawn, _)) = &mut self.program {
                    drawn.listing = listing;
                }
            }
            Update::Begins { is_of_program } => {
                let program = self.program.as_ref().filter(|_| is_of_program);
                let along = program.map(|(drawn, _)| drawn.way.along.clone());
                self.begin_record(along.unwrap_or_default());
            }
            Update::Standing(standing) => self.standing = standing,
            Update::Doing {
                phase,
                question,
                told,
                has_ended,
            } => {
                let live = &mut self.live;
                (live.phase, live.question, live.told, live.ended) = (phase, question, told, has_ended);
            }
            Update::Status { motion, tracker } => {
                (self.live.motion, self.live.tracker) = (Some(motion), tracker);
            }
            Update::Motion(samples) => {
                samples.iter().for_each(|sample| self.live.signals.motion(sample));
                self.live.newest = samples.last().copied().or(self.live.newest);
            }
            Update::Tracker { ticks, ahead_us } => {
                let signals = &mut self.live.signals;
                ticks.iter().for_each(|tick| signals.tracker(tick));
                // Which ticks come together says nothing here.
                signals.set_tracker_ahead_us(ahead_us);
            }
            Update::Deviations(changed) => self.live.deviations.follow(&changed),
            Update::Picture(sent) => match sent.decode() {
                Ok(picture) => {
                    let side = picture.side;
                    self.live.pictures[side] = Some(Arc::new(picture));
                }
                Err(error) => self
                    .live
                    .journal
                    .alarm(now, &format!("a picture was not read: {error}")),
            },
            Update::Happened {
                is_acknowledged,
                entries,
            } => {
                if is_acknowledged {
                    self.live.journal.acknowledge();
                }
                entries
                    .into_iter()
                    .for_each(|entry| self.live.journal.append(entry));
            }
        }
    }

    /// Another program, or none. One whose machine this version does not understand is none.
    fn begin(&mut self, drawn: Option<Drawn>) {
        self.program = drawn.and_then(|drawn| {
            let kinematics = drawn.motion.kinematics().ok()?;
            Some((drawn, kinematics))
        });
    }

    fn begin_record(&mut self, along: Along) {
        let journal = std::mem::take(&mut self.live.journal);
        self.live = Live::new(along, journal);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The age at `now_s` after a message that was sent at `at_s` has come at `came_s`.
    fn age_s(watched: &mut Watched, at_s: f64, came_s: f64, now_s: f64) -> f64 {
        let message = Message {
            is_all: false,
            at: Duration::from_secs_f64(at_s),
            heard_before: None,
            updates: Vec::new(),
        };
        watched.take(message, Duration::from_secs_f64(came_s));
        let age = watched.age(Duration::from_secs_f64(now_s)).unwrap();
        age.as_secs_f64()
    }

    #[test]
    fn silence_and_late_messages_are_seen_by_the_age() {
        let mut watched = Watched::default();
        assert_eq!(watched.age(Duration::from_secs(9)), None);
        // The other clock began 100 s before.
        assert!(age_s(&mut watched, 100.0, 0.02, 0.02) < 1e-3);
        assert!((age_s(&mut watched, 101.0, 1.02, 1.62) - 0.6).abs() < 1e-3);
        // What comes from a queue 2 s long is old when it comes.
        assert!((age_s(&mut watched, 102.0, 4.02, 4.02) - 2.0).abs() < 1e-3);
        // The screen was opened anew.
        watched.reconnected();
        assert!(age_s(&mut watched, 0.5, 6.0, 6.0) < 1e-3);
    }

    #[test]
    fn clocks_that_run_apart_for_a_day_make_nothing_old() {
        for rate in [1.0 - 1e-4, 1.0 + 1e-4] {
            let mut watched = Watched::default();
            let worst = (0..86_400)
                .map(|s| {
                    age_s(
                        &mut watched,
                        f64::from(s),
                        f64::from(s) * rate,
                        f64::from(s) * rate,
                    )
                })
                .fold(0.0, f64::max);
            assert!(worst < 1e-3, "{worst} s at {rate}");
        }
    }
}
