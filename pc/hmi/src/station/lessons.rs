//! Lessons at the station: the cameras are taught seams.

use super::{Action, Station};
use crate::loaded::deviation_file;
use crate::running::{Machine, Outcome, Task};
use crate::teaching::Seams;
use anyhow::bail;
use host_link::Command;
use std::sync::Arc;
use std::time::Duration;
use world::BoardChoice;

impl Station {
    /// Whether the job that runs is a lesson.
    pub fn is_teaching(&self) -> bool {
        self.lessons.runs()
    }

    /// How the last lesson ended: with a sentence if it could not begin.
    pub fn taught(&self) -> Option<&Result<Outcome, String>> {
        self.lessons.last()
    }

    /// How many lessons have ended.
    pub fn lessons(&self) -> u32 {
        self.lessons.ended()
    }

    /// Teaches `seams` from behind their last point on, if it may.
    ///
    /// # Errors
    /// A sentence: the level that it needs, or what machine or part lack for it.
    pub fn teach_seams(&mut self, seams: &Seams, now: Duration) -> anyhow::Result<()> {
        self.check(Action::Lesson)?;
        if !self.may(Action::Lesson, now) {
            bail!("a lesson only begins where no other job runs: switch the drives off first");
        }
        let machine = Arc::new(Machine::read(&self.machine_file)?);
        let lesson = seams.lesson(machine)?;
        let is_real = matches!(self.place.boards, BoardChoice::At { .. });
        if !is_real && lesson.seam.is_none() {
            let file = deviation_file(&seams.part().with_extension("ngc"));
            bail!(
                "{} is missing: simulated and emulated boards have the seams that it describes",
                file.display()
            );
        }
        self.begin_apart(Task::Lesson(Arc::new(lesson)));
        self.lessons.begin();
        Ok(())
    }

    /// Ends the lesson behind the point that is being taught.
    pub fn end_lesson(&mut self, now: Duration) {
        if self.is_teaching() {
            self.send(Command::Answer("done".to_owned()), now);
        }
    }
}
