//! Work offsets as they are set at the screen.

use super::{Action, Station};
use anyhow::{Context, bail};
use config::parameters::Change;
use config::work_offsets::{System, WorkOffset, WorkOffsets};
use host_link::{ByHand, Command};
use shared::io::{AXES, AXIS_NAMES};
use std::time::Duration;

impl Station {
    /// Writes `offsets` beside the machine file, if that may be, has each change on record, and has blocks by hand go by them. The
    /// program is read anew.
    ///
    /// # Errors
    /// A sentence: why nothing is written.
    pub fn set_work_offsets(&mut self, offsets: &WorkOffsets, now: Duration) -> anyhow::Result<()> {
        self.check(Action::WorkOffsets)?;
        if !self.may(Action::WorkOffsets, now) {
            bail!("work offsets are only set where the machine is at rest and no program runs");
        }
        let before = WorkOffsets::beside(&self.machine_file)?;
        let file = WorkOffsets::file(&self.machine_file);
        offsets
            .write(&self.machine_file)
            .with_context(|| format!("cannot write work offsets {}", file.display()))?;
        for system in System::ALL {
            let (old, new) = (before.of(system), offsets.of(system));
            self.live.journal.changed(now, &changes(system, &old, &new));
            if let Some(machine) = self.by_hand.as_ref().filter(|_| old != new) {
                let block = block(system, &new, machine.planner.fitted());
                self.send(Command::ByHand(ByHand::Block(block)), now);
            }
        }
        self.load_again();
        Ok(())
    }
}

/// The block that sets `system` (`G10 L2`), on a machine with the axes `fitted`.
fn block(system: System, offset: &WorkOffset, fitted: [bool; AXES]) -> String {
    let axes = (0..AXES).filter(|axis| *axis < 3 || fitted[*axis]);
    let words = axes.map(|axis| format!(" {}{}", AXIS_NAMES[axis], offset.origin[axis]));
    let words: String = words.collect();
    let number = system as u8 + 1;
    format!("G21 G10 L2 P{number}{words} R{}", offset.rotation_deg)
}

/// What differs.
fn changes(system: System, old: &WorkOffset, new: &WorkOffset) -> Vec<Change> {
    let values = |offset: &WorkOffset| offset.origin.into_iter().chain([offset.rotation_deg]);
    let names = AXIS_NAMES.iter().chain(&["rotation_deg"]);
    let values = names.zip(values(old).zip(values(new)));
    let differing = values.filter(|(_, (old, new))| old != new);
    differing
        .map(|(name, (old, new))| Change {
            key: format!("{}.{name}", system.name()),
            old: Some(old.to_string()),
            new: Some(new.to_string()),
        })
        .collect()
}
