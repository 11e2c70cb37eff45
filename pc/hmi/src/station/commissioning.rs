//! Commissioning at the station: motors are measured, a circle is made, what was found is written.

use super::{Action, Station};
use crate::commissioning::Commissioning;
use crate::parameters::Parameters;
use crate::running::{Machine, Outcome, Task};
use anyhow::bail;
use job::CircularTest;
use std::sync::Arc;
use std::time::Duration;

impl Station {
    /// Whether the job that runs commissions the machine.
    pub fn is_commissioning(&self) -> bool {
        self.commissioned.runs()
    }

    /// How the last job of commissioning ended: with a sentence if it could not begin, or if what came of it could not be kept.
    pub fn commissioned(&self) -> Option<&Result<Outcome, String>> {
        self.commissioned.last()
    }

    /// How many jobs of commissioning have ended.
    pub fn commissioned_jobs(&self) -> u32 {
        self.commissioned.ended()
    }

    /// Measures these motors of the machine, by their indices, if it may.
    ///
    /// # Errors
    /// A sentence: the level that it needs, or what is wrong with the machine file.
    pub fn measure(&mut self, motors: &[usize], now: Duration) -> anyhow::Result<()> {
        let machine = self.to_be_commissioned(now)?;
        self.commission(Task::Measure {
            machine,
            motors: motors.to_vec(),
        });
        Ok(())
    }

    /// Goes round a circle, if it may.
    ///
    /// # Errors
    /// A sentence: the level that it needs, or why the machine cannot make it.
    pub fn circle(&mut self, test: CircularTest, now: Duration) -> anyhow::Result<()> {
        let machine = self.to_be_commissioned(now)?;
        let circle = test.plan(&machine.is, &machine.planner)?;
        self.commission(Task::Circle {
            machine,
            circle: Box::new(circle),
        });
        Ok(())
    }

    /// Writes what was found of these motors, which `parameters` has as changes.
    ///
    /// # Errors
    /// A sentence: why it is not written, or why that is not noted.
    pub fn write_found(
        &mut self,
        commissioning: &Commissioning,
        motors: &[usize],
        parameters: &mut Parameters,
        now: Duration,
    ) -> anyhow::Result<()> {
        self.write(parameters, now)?;
        commissioning.note_written(motors)
    }

    fn to_be_commissioned(&self, now: Duration) -> anyhow::Result<Arc<Machine>> {
        self.check(Action::Commission)?;
        if !self.may(Action::Commission, now) {
            bail!("a machine is only commissioned where no other job runs");
        }
        Ok(Arc::new(Machine::read(&self.machine_file)?))
    }

    fn commission(&mut self, task: Task) {
        self.begin_apart(task);
        self.commissioned.begin();
    }
}
