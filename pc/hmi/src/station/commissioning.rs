//! Commissioning at the station: motors are measured, a circle is made, the spot of a camera is found, and what was found is
//! written.

use super::{Action, Station};
use crate::commissioning::Commissioning;
use crate::edited::Edited;
use crate::parameters::{Parameters, Written};
use crate::running::{FoundSpot, Machine, Outcome, Task};
use anyhow::{Context, bail, ensure};
use job::{CircularTest, Marking};
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

    /// Burns marks before the beginning of the weld of the program that is loaded, and has a camera look back at them, if it may.
    ///
    /// # Errors
    /// A sentence: the level that it needs, what is wrong with the machine file, or that there is no program.
    pub fn find_spot(&mut self, marking: Marking, now: Duration) -> anyhow::Result<()> {
        let machine = self.to_be_commissioned(now)?;
        let loaded = self
            .loaded
            .clone()
            .context("no program is loaded at the beginning of whose weld the plate would lie")?;
        ensure!(
            loaded.program.waits().next().is_none(),
            "the program waits for the operator or an input, which this does not: load one that does not wait"
        );
        self.commission(Task::Spot {
            machine,
            loaded,
            marking,
        });
        Ok(())
    }

    /// Writes the calibration of the camera whose spot was `found`, keeps what was there before as a version, and reads the program
    /// anew.
    ///
    /// # Errors
    /// A sentence: why it is not written.
    pub fn write_calibration(&mut self, found: &FoundSpot, now: Duration) -> anyhow::Result<()> {
        self.check(Action::Write)?;
        if !self.may(Action::Write, now) {
            bail!("a calibration is only written where no job runs");
        }
        let mut text = Edited::open_or_new("calibration", &found.file)?;
        text.set(found.result.found.calibration.to_toml());
        let written = Written {
            changes: Vec::new(),
            version: text.write()?,
        };
        self.told_written(now, &found.file, &written);
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
