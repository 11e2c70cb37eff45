//! The run-in of a tracked weld: where the beams are about to go on and a seam is not found yet, the machine waits for it.
//!
//! Slides look for a seam that is not in sight while the machine goes along its run-in. At a high speed that may be too
//! short for all that has to be looked at. So the path is held just before the first beam, the search goes on at rest,
//! with the cameras over the seam itself, and once both sides are on their seams the path continues: the motion board
//! goes back for its run-up by itself.

use crate::JobError;
use crate::session::Session;
use cam::path::PlannedPath;
use config::machine::TrackingUnit;
use host_link::Command;
use host_link::events::Phase;
use shared::io::SIDES;
use shared::parameter::ParameterError;
use shared::protocol::{MotionSample, Request};
use shared::state::{State, TrackerState};
use shared::tracking::search::SearchLaw;
use shared::trajectory::SpeedLimits;

/// From a sample of the boards to a hold that is in force, at most \[s\].
const LATENCY_S: f64 = 0.05;
/// What slows down before a place at any speed \[mm\].
const BEFORE_MM: f64 = 0.5;
/// Slides that have come to their seams stay there for so long before the path continues \[s\]: some pictures.
const SETTLED_S: f64 = 0.1;
/// After the search of the boards has ended, for the last pictures \[s\].
const LAST_PICTURES_S: f64 = 0.2;
/// So many times the way to the feed.
const RUN_UP: f64 = 1.25;
/// A machine that has not gone back as far as it should by then cannot \[s\].
const LONGEST_BACK_S: f64 = 10.0;
/// What is slower stands \[mm/s\].
const STILL: f64 = 1e-6;

/// What is known of the search of a machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeamSearchFigures {
    lock_mm: f64,
    /// Slides that are this near to their seams are on them when the beams go on: what is left of the way shrinks with
    /// their gain \[mm\].
    soon_mm: f64,
    /// To either side, and above and below \[mm\].
    reach_mm: [f64; 2],
    /// The boards look so long while the machine stands \[s\].
    longest_s: f64,
}

impl SeamSearchFigures {
    /// Of a machine with a tracker.
    pub fn new(unit: &TrackingUnit) -> Result<Self, ParameterError> {
        let search: SearchLaw = unit.board.build()?.search;
        let tracking = &unit.board.tracking;
        Ok(Self {
            lock_mm: tracking.lock_mm,
            soon_mm: tracking.lock_mm * (tracking.kp * LATENCY_S).exp(),
            reach_mm: [tracking.search_mm, tracking.search_height_mm],
            longest_s: search.longest_at_rest(),
        })
    }
}

/// Watches the run-in of one path.
pub(super) struct RunIn {
    /// From here on both seams have to be found \[mm\].
    needed_mm: f64,
    /// The first beam goes on \[mm\].
    weld_mm: f64,
    /// Way to get up to the feed, and a quarter more, as the motion board has it after a hold \[mm\].
    run_up_mm: f64,
    state: Waiting,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Waiting {
    /// For the place where the seams have to be found.
    NotYet,
    /// The path is held, since this path tick; and since when both sides are on their seams.
    Held { since: u32, found: Option<u32> },
    /// To have gone back for the run-up; since this path tick.
    Back { since: u32 },
    /// For nothing any more.
    Over,
}

impl RunIn {
    /// Of a path that is about to be run.
    pub fn new(path: &PlannedPath) -> Self {
        let weld = path.weld().map(|(start, _)| start);
        let speed = path.speeds().fastest_mm_s;
        let weld_mm = weld.unwrap_or(f64::INFINITY);
        let limits = SpeedLimits {
            velocity: speed,
            ..path.limits
        };
        Self {
            needed_mm: weld_mm - LATENCY_S * speed - BEFORE_MM,
            weld_mm,
            run_up_mm: RUN_UP * limits.ramp(),
            state: weld.map_or(Waiting::Over, |_| Waiting::NotYet),
        }
    }

    /// The machine stands because of this, and nobody has to be asked.
    pub fn waits(&self) -> bool {
        matches!(self.state, Waiting::Held { .. } | Waiting::Back { .. })
    }

    /// The operator has taken over.
    pub fn leave(&mut self) {
        self.state = Waiting::Over;
    }

    /// A look at the machine, which is `here` on the path; what is to be said in the operator's place.
    ///
    /// # Errors
    /// [`JobError::SeamNotFound`].
    pub fn watch(&mut self, session: &mut Session, here: &MotionSample) -> Result<Option<Command>, JobError> {
        let held = self.state != Waiting::NotYet;
        let Some((search, missing)) = missing(session, held) else {
            return Ok(None);
        };
        let stands = here.speed_mm_s.abs() < STILL && here.state == State::Holding;
        let seconds_since = |tick: u32| f64::from(here.tick.wrapping_sub(tick)) * 1e-3;
        match self.state {
            Waiting::Over => {}
            Waiting::NotYet => {
                if here.beams.contains(&true) || here.s_mm >= self.weld_mm {
                    self.state = Waiting::Over;
                } else if here.s_mm >= self.needed_mm
                    && here.state == State::Running
                    && missing.contains(&true)
                    && search.longest_s > 0.0
                {
                    session.ask(&Request::Hold)?;
                    session.phase(Phase::SearchingSeam);
                    self.state = Waiting::Held {
                        since: here.tick,
                        found: None,
                    };
                    return Ok(Some(Command::Hold));
                }
            }
            Waiting::Held { since, found } => {
                // It is looked for at rest from then on.
                let since = if stands { since } else { here.tick };
                let found = (!missing.contains(&true)).then(|| found.unwrap_or(here.tick));
                self.state = Waiting::Held { since, found };
                if stands && found.is_some_and(|found| seconds_since(found) >= SETTLED_S) {
                    // Past the beginning of the weld the motion board goes back by itself.
                    let near = self.weld_mm - self.run_up_mm..self.weld_mm;
                    if near.contains(&here.s_mm) {
                        session.ask(&Request::Back)?;
                        self.state = Waiting::Back { since: here.tick };
                        return Ok(Some(Command::Back));
                    }
                    return self.go_on(session);
                }
                if seconds_since(since) > search.longest_s + LAST_PICTURES_S {
                    return Err(JobError::SeamNotFound {
                        sides: missing,
                        s_mm: here.s_mm,
                        reach_mm: search.reach_mm,
                    });
                }
            }
            Waiting::Back { since } => {
                if here.s_mm <= self.weld_mm - self.run_up_mm {
                    session.ask(&Request::Hold)?;
                    self.state = Waiting::Held {
                        since: here.tick,
                        found: None,
                    };
                    return Ok(Some(Command::Hold));
                }
                if stands && seconds_since(since) > LONGEST_BACK_S {
                    return self.go_on(session);
                }
            }
        }
        Ok(None)
    }

    /// Both seams are found.
    fn go_on(&mut self, session: &mut Session) -> Result<Option<Command>, JobError> {
        self.state = Waiting::Over;
        session.phase(Phase::RunningIn);
        session.ask(&Request::Resume)?;
        Ok(Some(Command::Resume))
    }
}

/// The search of the machine, and the sides whose seam is not found: it is not in the latest pictures, or the slides are not
/// where it is, or will not be when the beams go on. `None` while nothing is tracked.
fn missing(session: &Session, held: bool) -> Option<(SeamSearchFigures, [bool; SIDES])> {
    let tracking = session.tracking.as_ref()?;
    let search = tracking.search;
    let slides = session.record.tracker().back()?;
    if slides.state != TrackerState::Tracking {
        return None;
    }
    let near_mm = if held { search.lock_mm } else { search.soon_mm };
    let away = |slide: usize| (slides.target_mm[slide] - slides.slides_mm[slide]).abs() > near_mm;
    let missing = std::array::from_fn(|side| {
        tracking.heads.sides().contains(&side)
            && (!tracking.in_sight(side) || away(2 * side) || away(2 * side + 1))
    });
    Some((search, missing))
}
