//! The machine operated by hand: it stands until somebody jogs it or has it carry out a block of NC.
//!
//! What is jogged runs by hold-to-run: the board stops it [`HOLD_TO_RUN_MS`] after it was asked for last, whatever has become
//! of this program. Each time that the operator asks again is passed on to the board; a step, whose end is known, is held to
//! by this job.

use crate::feeding::Feeding;
use crate::leading::{Straight, straight};
use crate::probing::Guard;
use crate::session::{Session, on_path};
use crate::{Job, JobError, Weld};
use cam::path::{JogError, PlannedPath, TipMove};
use config::work_offsets::System;
use host_link::events::{Event, Phase, Question};
use host_link::{ByHand, Jog, JogWay};
use nalgebra::Vector3;
use nc::{Options, interpret};
use shared::io::{AXIS_NAMES, SLIDES};
use shared::protocol::{HOLD_TO_RUN_MS, Request, Role};
use std::sync::Arc;
use std::time::Duration;

/// What was asked for longer ago is not begun, nor gone on with.
const STALE: Duration = Duration::from_millis(HOLD_TO_RUN_MS as u64);
/// A step is held to so often.
const RENEWED: Duration = Duration::from_millis(50);
/// A slide that is to go to its end stops so far before it \[mm\].
const CLEAR_OF_END_MM: f64 = 0.01;

impl Weld {
    /// Does what is asked for by hand, until the drives are to be off or nobody is there any more.
    pub(super) fn by_hand(&mut self, session: &mut Session, job: &Job) -> Result<(), JobError> {
        // In a simulated world cameras see the seams of what will be run.
        let planned = job.surroundings.planned(job.machine, &self.planner, &[]);
        if let Err(error) = planned {
            session.control.publish(Event::Message(error.to_string()));
        }
        loop {
            session.question(Question::ByHand);
            let mut asked = None;
            session.go_on_until(|session| {
                session.obey(false)?;
                asked = session.control.take_by_hand();
                Ok(asked.is_some() || session.control.unattended())
            })?;
            let done = match asked {
                None | Some(ByHand::Off) => return Ok(()),
                Some(ByHand::LetGo) => Ok(()),
                Some(ByHand::Jog(jog)) if jog.age() > STALE => Err(JobError::Stale {
                    ms: jog.age().as_millis(),
                }),
                Some(ByHand::Jog(jog)) => self.jog(session, job, &jog),
                Some(ByHand::Block(text)) => self.block(session, job, &text),
            };
            match done {
                Err(error) if error.is_refused_move() => {
                    session.control.publish(Event::Message(error.to_string()));
                }
                done => done?,
            }
        }
    }

    /// Carries out a block, after the checks of a program. Where G10 puts coordinate systems, and what a probe finds, stay for the
    /// blocks after it.
    fn block(&mut self, session: &mut Session, job: &Job, text: &str) -> Result<(), JobError> {
        let options = Options {
            setup: Arc::new(self.planner.setup(&session.motion.reference)),
            ..Options::default()
        };
        let program = interpret(&format!("{text}\nM2\n"), options);
        let mut program = program.map_err(|error| JobError::Block(error.to_string()))?;
        let before = *self.planner.systems();
        if !program.paths.is_empty() || *program.systems == before {
            program = self.program(session, job, &program)?;
        }
        self.planner.set_systems(*program.systems);
        if let Some(found) = program.found() {
            self.planner.set_found(found);
        }
        let are = before
            .iter()
            .zip(program.systems.iter())
            .map(|(was, is)| was != is);
        let set = System::ALL.iter().zip(are).filter(|(_, set)| *set);
        let set: Vec<_> = set.map(|(system, _)| system.name()).collect();
        if !set.is_empty() {
            let text = format!("set for the blocks by hand that follow: {}", set.join(", "));
            session.control.publish(Event::Message(text));
        }
        Ok(())
    }

    /// Jogs until the machine stands.
    fn jog(&mut self, session: &mut Session, job: &Job, jog: &Jog) -> Result<(), JobError> {
        if let JogWay::Slide(slide) = jog.way {
            return jog_slide(session, job, slide, jog);
        }
        let path = self.jog_path(session, jog)?;
        self.run(session, path, Phase::Jogging, |session, feeding, _, _| {
            hold_to_run(session, feeding, jog)
        })
    }

    /// The way of a jog, to its end or to that of the travel.
    fn jog_path(&self, session: &Session, jog: &Jog) -> Result<PlannedPath, JobError> {
        let from = &session.motion.reference;
        let by = jog.step.unwrap_or(f64::INFINITY).copysign(jog.speed);
        let speed = jog.speed.abs();
        let pose = self.planner.pose(&self.planner.tip(from));
        let motion = match jog.way {
            JogWay::Axis(axis) => return Ok(self.planner.jog_axis(from, axis, by, speed)?),
            JogWay::Work(axis) => TipMove::Along(Vector3::ith(axis, 1.0)),
            JogWay::Tool(0) => TipMove::Along(pose.tangent),
            JogWay::Tool(1) => TipMove::Along(pose.normal.cross(&pose.tangent)),
            JogWay::Tool(_) => TipMove::Along(pose.normal),
            JogWay::Turn(axis) => TipMove::Turn(axis),
            JogWay::Slide(_) => return Err(JobError::Move("a slide is no axis".to_owned())),
        };
        let there = self.planner.reach(from, motion, by)?;
        let turned = match motion {
            TipMove::Turn(axis) => vec![(AXIS_NAMES[axis], there.angles_deg[axis - 3])],
            TipMove::Along(_) => Vec::new(),
        };
        let to = Straight {
            position_mm: there.position_mm,
            turned,
            feed: speed * 60.0,
        };
        straight(&self.planner, from, &to)?
            .pop()
            .ok_or(JobError::Jog(JogError::OutOfReach))
    }
}

/// What becomes of a jog by what was asked for since.
enum Hand {
    /// It is asked for again.
    Holds,
    /// It is not, or something else is.
    LetsGo,
    /// Nothing was asked for.
    Silent,
}

/// What was asked for since; whatever is not for this jog stays, to be done after it.
fn hand(session: &mut Session, jog: &Jog) -> Hand {
    let hand = match session.control.by_hand() {
        None => return Hand::Silent,
        Some(ByHand::Jog(again)) if again.renews(jog) && again.age() <= STALE => Hand::Holds,
        Some(ByHand::Jog(again)) if again.renews(jog) => Hand::Silent,
        Some(ByHand::LetGo) => Hand::LetsGo,
        Some(_) => return Hand::LetsGo,
    };
    session.control.take_by_hand();
    hand
}

/// Runs the path that is loaded as long as somebody holds to it.
fn hold_to_run(session: &mut Session, mut feeding: Feeding, jog: &Jog) -> Result<(), JobError> {
    session.command(Role::Motion, &Request::HoldToRun)?;
    session.refresh()?;
    let begun = session.tick();
    let mut held = Held::new(session);
    let mut guard = Guard::new(session, false);
    session.go_on_until(|session| {
        feeding.go_on(session)?;
        guard.watch(session)?;
        match held.turn(session, jog) {
            Some(true) => session.ask(&Request::HoldToRun)?,
            Some(false) => session.ask(&Request::Stop)?,
            None => {}
        }
        let newest = session.record.motion().back();
        let stands = newest.is_some_and(|newest| newest.tick > begun && !on_path(newest.state));
        Ok(stands || !on_path(session.motion.state))
    })?;
    session.refresh()?;
    session.check()
}

/// Moves one slide as long as somebody holds to it.
fn jog_slide(session: &mut Session, job: &Job, slide: usize, jog: &Jog) -> Result<(), JobError> {
    let no_slides = || JobError::Move("it has no slides".to_owned());
    let unit = job.machine.tracking.as_ref().ok_or_else(no_slides)?;
    let of = unit.board.slides.get(slide).ok_or_else(no_slides)?;
    let mut target_mm: [f64; SLIDES] = session.slides_mm();
    let by = jog.step.unwrap_or(f64::INFINITY).copysign(jog.speed);
    let ends = [
        of.travel_min_mm + CLEAR_OF_END_MM,
        of.travel_max_mm - CLEAR_OF_END_MM,
    ];
    target_mm[slide] = (target_mm[slide] + by).clamp(ends[0], ends[1]);
    let request = Request::MoveSlides {
        target_mm,
        hold_to_run: Some(jog.speed.abs()),
    };
    session.phase(Phase::Jogging);
    session.command(Role::Tracker, &request)?;
    let mut held = Held::new(session);
    session.go_on_until(|session| {
        match held.turn(session, jog) {
            Some(true) => session.command(Role::Tracker, &request)?,
            Some(false) => session.command(Role::Tracker, &Request::Stop)?,
            None => {}
        }
        Ok(held.is_over(session) || session.away(&target_mm).is_none())
    })
}

/// Whether a jog is held to.
struct Held {
    /// When it was last, by the clock of the boards' session.
    since: Duration,
    let_go: bool,
}

impl Held {
    fn new(session: &Session) -> Self {
        Self {
            since: session.boards.now(),
            let_go: false,
        }
    }

    /// Whether to ask the board to go on (true) or to stop (false) now.
    fn turn(&mut self, session: &mut Session, jog: &Jog) -> Option<bool> {
        if self.let_go {
            return None;
        }
        let now = session.boards.now();
        let by_itself = jog.step.is_some() && now >= self.since + RENEWED;
        match hand(session, jog) {
            Hand::LetsGo => {
                self.let_go = true;
                Some(false)
            }
            Hand::Silent if !by_itself => None,
            Hand::Holds | Hand::Silent => {
                self.since = now;
                Some(true)
            }
        }
    }

    /// The board does not go on any more.
    fn is_over(&self, session: &Session) -> bool {
        self.let_go || session.boards.now() > self.since + STALE
    }
}
