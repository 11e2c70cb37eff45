//! What a program asks the machine: with each answer it is read again, and goes on behind its question.

use crate::{Job, JobError};
use cam::path::{PlannedPath, Planner};
use nc::{Answer, Probe, Probed, Program, Wait};
use shared::io::AXES;
use std::borrow::Cow;
use std::vec::IntoIter;

/// A program as it was read last, and how far it has come.
pub(super) struct Answers<'a> {
    program: Cow<'a, Program>,
    /// Where the axes stood when it began (mm, degrees).
    from: [f64; AXES],
    given: Vec<Answer>,
    /// Waits that are over.
    waits: usize,
    begins: Begins,
}

/// Where the paths begin that are left.
#[derive(Clone, Copy)]
enum Begins {
    WithTheFirst,
    /// With that which has the wait of this number before it.
    AtWait(usize),
    /// Behind the motion with the probe that is the question of this number.
    Behind(usize),
}

impl<'a> Answers<'a> {
    pub fn new(program: &'a Program, from: [f64; AXES]) -> Self {
        Self {
            program: Cow::Borrowed(program),
            from,
            given: Vec::new(),
            waits: 0,
            begins: Begins::WithTheFirst,
        }
    }

    /// All paths that are left, the first one with waits that are over, too.
    pub fn plan(&self, job: &Job, planner: &Planner) -> Result<IntoIter<PlannedPath>, JobError> {
        let mut left = job.plan(&self.program, planner, &self.from)?.into_iter();
        match self.begins {
            Begins::WithTheFirst => {}
            Begins::AtWait(number) => {
                let waits = |path: &PlannedPath| path.waits_before.iter().any(|wait| wait.number == number);
                let before = left.as_slice().iter().take_while(|path| !waits(path)).count();
                left.by_ref().take(before).for_each(drop);
            }
            Begins::Behind(question) => {
                left.find(|path| path.probe.is_some_and(|probe| probe.question == question));
            }
        }
        Ok(left)
    }

    /// Whether `wait` is over.
    pub fn is_over(&self, wait: &Wait) -> bool {
        wait.number < self.waits
    }

    /// `wait` is over.
    pub fn over(&mut self, wait: &Wait) {
        self.waits = wait.number + 1;
    }

    /// Whether the program looks at what comes of `wait`.
    pub fn looks_at(&self, wait: &Wait) -> bool {
        wait.question
            .is_some_and(|question| self.program.looks_at(question))
    }

    /// Takes what came of `wait`, `#5399`; whether the paths that are left are to be planned anew.
    pub fn input(&mut self, wait: &Wait, value: i8) -> Result<bool, JobError> {
        self.over(wait);
        let looks = self.looks_at(wait);
        self.given.push(Answer::Input(value));
        if looks {
            self.begins = Begins::AtWait(wait.number);
            self.read()?;
        }
        Ok(looks)
    }

    /// Takes what the motion of `probe` has found; the paths that are left are to be planned anew.
    pub fn probed(&mut self, probe: &Probe, found: Probed) -> Result<(), JobError> {
        self.given.push(Answer::Probe(found));
        self.begins = Begins::Behind(probe.question);
        self.read()
    }

    fn read(&mut self) -> Result<(), JobError> {
        let again = self.program.answered(&self.given);
        self.program = Cow::Owned(again.map_err(JobError::Answered)?);
        Ok(())
    }

    /// The program as it was read last.
    pub fn program(self) -> Program {
        self.program.into_owned()
    }
}
