//! A path while the motion board runs it: the rest of it is given, and the machine is watched.

use crate::feeding::{EndedBlock, Feeding};
use crate::probing::{self, Guard};
use crate::run_in::RunIn;
use crate::session::{Session, on_path};
use crate::{JobError, recentring};
use cam::path::PlannedPath;
use host_link::Command;
use host_link::events::{Event, Next, Phase, Question};
use shared::protocol::{MotionSample, MotionStatus, Request};
use shared::state::State;

/// A machine that should move, but has not for this time, is taken to be stuck \[s\]; far longer than a queue
/// runs dry.
const STANDSTILL_S: u32 = 10;
/// A path tick is a millisecond.
const TICKS_PER_S: u32 = 1000;

/// A place on the path is reached, to this much \[mm\]; and what is slower stands \[mm/s\].
const REACHED: f64 = 1e-3;
const STILL: f64 = 1e-6;

/// Runs `path`, which has been begun as `id`, to its end, and gives the rest of it meanwhile; in single
/// block the operator is asked after every block of the program.
pub(super) fn follow(
    session: &mut Session,
    mut feeding: Feeding,
    path: &PlannedPath,
    id: u32,
) -> Result<(), JobError> {
    probing::begin(session, path)?;
    session.refresh()?;
    let begun = session.tick();
    let mut welding = false;
    let mut guard = Guard::new(session, path.probe.is_some());
    let mut advance = Advance::new(&session.motion);
    // Line of the next block, while the machine waits before that.
    let mut waits: Option<u32> = None;
    let mut standing = Standing::default();
    let mut run_in = RunIn::new(path);
    let length_mm = path.length_mm();
    session.go_on_until(|s| {
        feeding.go_on(s)?;
        advance.watch(&s.motion)?;
        guard.watch(s)?;
        recentring::watch(s, id)?;
        let mut stands = false;
        let here = s.record.motion().back().filter(|here| here.tick > begun).copied();
        if let Some(here) = &here {
            // The telemetry shows it sooner than the next status; at rest it names no path.
            stands = !on_path(here.state);
        }
        if let Some(here) = here.filter(|here| here.path_id == id) {
            if here.beams.contains(&true) && !welding {
                welding = true;
                s.phase(Phase::Welding);
            }
            s.control.publish(Event::Progress {
                done_mm: here.s_mm,
                length_mm,
            });
            if waits.is_none()
                && let Some(order) = run_in.watch(s, &here)?
            {
                standing.hear(Some(&order), s.tick());
            }
            if let (None, Some(block)) = (waits, feeding.ended_block())
                && rests_after(&block, &here)
            {
                // Held, the beams stay off, and go over the place again.
                s.ask(&Request::Hold)?;
                let next = Next::Line(block.next_line);
                s.question(Question::GoOn { next });
                waits = Some(block.next_line);
            }
        }
        standing.watch(&s.motion);
        if standing.held_by_board && waits.is_none() && !run_in.waits() {
            s.question(Question::FeedTooLow);
            welding = false;
        }
        let for_somebody = standing.for_somebody && !run_in.waits();
        let order = s.obey(waits.is_some() || for_somebody)?;
        if let Some(Command::Hold | Command::Back | Command::Resume) = order {
            run_in.leave();
        }
        standing.hear(order.as_ref(), s.tick());
        if order == Some(Command::Resume) {
            if let Some(line) = waits.take() {
                welding = false;
                s.phase(Phase::Line(line));
                feeding.next_block(s)?;
            }
            s.ask(&Request::Resume)?;
        }
        Ok(stands || !on_path(s.motion.state))
    })?;
    session.refresh()?;
    session.check()
}

/// Whether the machine, which is `here`, has come to rest after `block`.
fn rests_after(block: &EndedBlock, here: &MotionSample) -> bool {
    let reached = (here.s_mm - block.end_s).abs() < REACHED;
    reached && here.speed_mm_s.abs() < STILL && here.state == State::Running
}

/// Whether the machine is at rest until the operator gives a command.
#[derive(Default)]
struct Standing {
    /// It does.
    for_somebody: bool,
    /// In a hold that was not commanded.
    held_by_board: bool,
    /// The last command of hold, back and resume, if the board has not been seen to run since; and when.
    said: Option<Command>,
    said_at: u32,
}

impl Standing {
    /// Takes the state of the board; a hold lasts while the machine goes back before it continues.
    fn watch(&mut self, motion: &MotionStatus) {
        let held = motion.state == State::Holding;
        // Reports from before the command belong to another state.
        if motion.state == State::Running && motion.path_ticks > self.said_at {
            self.said = None;
        }
        self.held_by_board = held && self.said.is_none();
        let stopped = motion.state == State::Running && motion.speed_override <= 0.0;
        self.for_somebody = stopped || held && self.said != Some(Command::Resume);
    }

    /// Takes what was said at path tick `tick`.
    fn hear(&mut self, order: Option<&Command>, tick: u32) {
        if let Some(Command::Hold | Command::Back | Command::Resume) = order {
            (self.said, self.said_at) = (order.cloned(), tick);
        }
    }
}

/// When the machine was last seen to continue, or to have a reason not to.
struct Advance {
    s_mm: f64,
    tick: u32,
}

impl Advance {
    fn new(motion: &MotionStatus) -> Self {
        Self {
            s_mm: motion.s_mm,
            tick: motion.path_ticks,
        }
    }

    /// A hold and an override of 0 may last for ever, and a low override takes what it takes.
    fn watch(&mut self, motion: &MotionStatus) -> Result<(), JobError> {
        let shall_move = match motion.state {
            State::Running => motion.speed_override > 0.0,
            State::Stopping => true,
            State::Off | State::Homing | State::Idle | State::Holding | State::Fault => false,
        };
        if !shall_move || motion.s_mm != self.s_mm {
            *self = Self::new(motion);
        }
        if motion.path_ticks.wrapping_sub(self.tick) > STANDSTILL_S * TICKS_PER_S {
            return Err(JobError::Standstill {
                line: motion.line,
                s_mm: motion.s_mm,
                seconds: STANDSTILL_S,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::motion::MotionController;
    use shared::protocol::Response;

    /// What the board says `seconds` after the path began.
    fn status(seconds: u32, state: State, speed_override: f64, s_mm: f64) -> MotionStatus {
        let Response::MotionStatus(any) = MotionController::new().handle(&Request::Status, 0) else {
            panic!("a board tells its state");
        };
        MotionStatus {
            state,
            speed_override,
            s_mm,
            line: 12,
            // The counter wraps.
            path_ticks: (seconds * TICKS_PER_S).wrapping_sub(5000),
            ..any
        }
    }

    #[test]
    fn only_a_machine_that_shall_move_and_does_not_is_given_up() {
        use State::{Holding, Running, Stopping};
        let mut advance = Advance::new(&status(0, Running, 1.0, 0.0));
        // Slow, held for an hour, on at no feed for another: nothing is wrong with that.
        for seconds in 1..100 {
            let s_mm = 1e-4 * f64::from(seconds);
            advance.watch(&status(seconds, Running, 0.001, s_mm)).unwrap();
        }
        advance.watch(&status(3700, Holding, 1.0, 0.01)).unwrap();
        advance.watch(&status(7300, Running, 0.0, 0.01)).unwrap();
        for (from, state) in [(7300, Running), (8000, Stopping)] {
            advance.watch(&status(from, Holding, 1.0, 0.01)).unwrap();
            advance.watch(&status(from + 10, state, 1.0, 0.01)).unwrap();
            let given_up = advance.watch(&status(from + 11, state, 1.0, 0.01));
            assert!(
                matches!(
                    given_up,
                    Err(JobError::Standstill {
                        line: 12,
                        seconds: 10,
                        ..
                    })
                ),
                "{given_up:?}"
            );
        }
    }

    #[test]
    fn whoever_is_held_waits_for_somebody_until_it_goes_on() {
        use State::{Holding, Running};
        let mut standing = Standing::default();
        let mut told = |tick: u32, state, factor, order: Option<Command>| {
            let mut motion = status(0, state, factor, 0.0);
            motion.path_ticks = tick;
            standing.watch(&motion);
            standing.hear(order.as_ref(), tick);
            (standing.for_somebody, standing.held_by_board)
        };
        assert_eq!(told(10, Running, 1.0, Some(Command::Hold)), (false, false));
        // As reported before the command, and after it.
        assert_eq!(told(10, Running, 1.0, None), (false, false));
        assert_eq!(told(12, Holding, 1.0, None), (true, false));
        assert_eq!(told(13, Holding, 1.0, Some(Command::Back)), (true, false));
        assert_eq!(told(14, Holding, 1.0, Some(Command::Resume)), (true, false));
        // It goes back before it continues.
        assert_eq!(told(15, Holding, 1.0, None), (false, false));
        assert_eq!(told(16, Running, 1.0, None), (false, false));
        // And neither this hold nor its end was commanded.
        assert_eq!(told(17, Holding, 0.01, None), (true, true));
        assert_eq!(told(18, Running, 0.0, None), (true, false));
    }
}
