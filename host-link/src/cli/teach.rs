//! `host-link teach`: points and normals of a surface, by the machine's probe.

use super::boards::{BoardChoice, exit_code};
use crate::machine::MachineFile;
use crate::part::PartFile;
use crate::teach::write_points;
use crate::weld::{Job, Names, Surroundings, Terminal, Work, check_teaching, run};
use anyhow::Context;
use clap::Args;
use emulator::MACHINE_VARIABLE;
use std::path::PathBuf;
use std::process::ExitCode;

/// Teach a panel: measure its points and normals with the ranging probe
///
/// The machine homes, goes from guide point to guide point, measures rings of eight neighbours around each, turns the
/// probe to the normal they show, and parks. With taught = "taught.csv" in its part file the panel can be planned.
#[derive(Debug, Args)]
pub struct Teach {
    /// Part file of a panel
    part: PathBuf,
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: PathBuf,
    /// emulated or simulated; no real board has an input for the probe yet
    #[arg(long, default_value = "emulated")]
    boards: BoardChoice,
    /// Where the points go (CSV), those up to a trouble too
    #[arg(short, long)]
    output: PathBuf,
    /// Start of the simulated probe's noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Teach {
    /// Teaches and writes the points.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let part = PartFile::read(&self.part)?;
        check_teaching(&machine, &part).with_context(|| format!("part {}", self.part.display()))?;
        let job = Job {
            machine: &machine,
            work: Work::Teach,
            part: Some(&part),
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings {
                seed: self.seed,
                ..Surroundings::default()
            },
            names: Names {
                program: self.part.display().to_string(),
                machine: self.machine.display().to_string(),
                seam: None,
                boards: self.boards.name(),
            },
        };
        let mut connected = match self.boards.connect_for(&machine)? {
            Ok(connected) => connected,
            Err(code) => return Ok(code),
        };
        let ended = run(
            connected.boards.as_mut(),
            &job,
            &connected.interrupted,
            &mut Terminal::new(),
        )?;
        let points = &ended.taught.points;
        if !points.is_empty() {
            let output = self.output.display();
            std::fs::write(&self.output, write_points(points))
                .with_context(|| format!("cannot write {output}"))?;
            println!("{output}: {} points", points.len());
            for figure in &ended.report.figures {
                println!("  {} {:.4} {}", figure.text, figure.value, figure.unit);
            }
        }
        exit_code(ended.error)
    }
}
