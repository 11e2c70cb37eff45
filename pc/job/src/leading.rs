//! Teaching places of the tip with the machine of a session: an operator leads it.

use crate::session::Session;
use crate::{JobError, Weld};
use cam::path::{PathError, PlannedPath, Planner};
use host_link::events::{Event, Phase, Question};
use nalgebra::Vector3;
use nc::text::words;
use nc::{Options, interpret};
use shared::io::{AXES, AXIS_NAMES};
use teach::{LedMachine, TipFile, TipPoint, lead};

/// Speed of a move \[mm/min\], and of a turn \[°/min\]: slow enough to be stopped by hand before it does harm.
const MOVE: f64 = 600.0;
const TURN: f64 = 300.0;

/// Places to be taught, and where they go.
#[derive(Debug)]
pub struct LedLesson {
    /// Where the axes go first (mm, degrees); they stay at their reference marks without it.
    pub start: Option<[f64; AXES]>,
    /// Places taught before.
    pub points: Vec<TipPoint>,
    /// Where all places go.
    pub file: TipFile,
}

impl Weld {
    /// Lets the operator teach the places of `lesson`.
    pub(super) fn lead(&mut self, session: &mut Session, lesson: &LedLesson) -> Result<(), JobError> {
        if let Some(start) = lesson.start {
            let paths = self.planner.go_to(&session.motion.reference, &start);
            for path in paths.map_err(refused)? {
                self.path(session, path, Phase::Approaching)?;
            }
        }
        let mut machine = Led {
            weld: self,
            session,
            lesson,
            count: lesson.points.len(),
        };
        self.taught.led = lead(&mut machine, &lesson.points)?;
        Ok(())
    }
}

/// Where the tip goes straight to.
pub(crate) struct Straight {
    pub position_mm: [f64; 3],
    /// Axes that turn, and where to \[°\].
    pub turned: Vec<(&'static str, f64)>,
    /// \[mm/min\]; \[°/min\] where the tip stays.
    pub feed: f64,
}

/// The paths from the axes `from` (mm, degrees), after the checks of a program.
pub(crate) fn straight(
    planner: &Planner,
    from: &[f64; AXES],
    to: &Straight,
) -> Result<Vec<PlannedPath>, JobError> {
    let place = AXIS_NAMES.into_iter().zip(to.position_mm);
    let words = words(place.chain(to.turned.iter().copied()));
    let text = format!("G21 G90 G94 G43.4 G61\nG1 {words} F{}\nM2\n", to.feed);
    let program = interpret(&text, Options::default()).map_err(|error| JobError::Plan(error.to_string()))?;
    planner.program(&program, from, None).map_err(refused)
}

/// A move that cannot be made. Where in a program it stands is left out: the operator wrote none.
fn refused(error: PathError) -> JobError {
    let text = error.to_string();
    let place = |text: &str| text.starts_with("line ");
    match text.split_once(": ") {
        Some((before, reason)) if place(before) => JobError::Move(reason.to_owned()),
        _ => JobError::Move(text),
    }
}

/// The machine of a session.
struct Led<'w, 's, 'b> {
    weld: &'w mut Weld,
    session: &'s mut Session<'b>,
    lesson: &'w LedLesson,
    /// Places in the file.
    count: usize,
}

impl LedMachine for Led<'_, '_, '_> {
    type Error = JobError;

    fn tip(&self) -> TipPoint {
        let tip = self.weld.planner.tip(&self.session.motion.reference);
        TipPoint {
            position_mm: tip.position_mm,
            angles_deg: tip.angles_deg,
        }
    }

    fn tool(&self) -> Vector3<f64> {
        let tip = self.weld.planner.tip(&self.session.motion.reference);
        self.weld.planner.pose(&tip).normal
    }

    fn go(&mut self, there: &TipPoint) -> Result<(), JobError> {
        let here = self.tip();
        let fitted = self.weld.planner.fitted();
        let mut turned = Vec::new();
        for (axis, (from, to)) in (3..AXES).zip(here.angles_deg.into_iter().zip(there.angles_deg)) {
            let name = AXIS_NAMES[axis];
            match (from == to, fitted[axis]) {
                (true, _) => {}
                (false, true) => turned.push((name, to)),
                (false, false) => return Err(JobError::Move(format!("it has no {name} axis"))),
            }
        }
        let to = Straight {
            position_mm: there.position_mm,
            feed: if turned.is_empty() { MOVE } else { TURN },
            turned,
        };
        let number = self.count + 1;
        for path in straight(&self.weld.planner, &self.session.motion.reference, &to)? {
            self.weld
                .path(self.session, path, Phase::TeachingSeam { number })?;
        }
        Ok(())
    }

    fn line(&mut self) -> Result<Option<String>, JobError> {
        self.session.answer(Question::Jog)
    }

    fn say(&mut self, text: &str) {
        self.session.control.publish(Event::Message(text.to_owned()));
    }

    fn keep(&mut self, points: &[TipPoint]) -> Result<(), JobError> {
        self.count = points.len();
        let file = &self.lesson.file;
        let path = file.path().display();
        let kept = file.keep(points);
        kept.map_err(|error| JobError::Teach(format!("cannot write {path}: {error}")))
    }

    fn is_refusal(&self, error: &JobError) -> bool {
        error.is_refused_move()
    }
}
