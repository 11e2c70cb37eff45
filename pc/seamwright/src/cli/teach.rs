//! `seamwright teach`: points and normals of a surface, by the machine's probe, or of seams, by its cameras.

use super::boards::{BoardArgs, exit_code};
use super::teach_seam::SeamArgs;
use crate::console::{errln, outln};
use crate::terminal::Operator;
use anyhow::Context;
use clap::Args;
use config::machine::MachineFile;
use emulator::MACHINE_VARIABLE;
use job::{Job, Names, Work, check_teaching};
use parts::PartFile;
use std::path::PathBuf;
use std::process::ExitCode;
use teach::write_points;
use world::Surroundings;

/// Teach a part: seams with the cameras, a panel with the ranging probe, places by leading the tip there
///
/// Seams ([t-seam]): the machine homes, goes to where the seams are drawn to begin, searches them around
/// there, brings both to the middle of the cameras' bands, and continues along their tangent from point to
/// point, farther where they are straight. Every point is written at once: the same command continues after
/// the last one. done and Enter ends. With --jog the operator drives; help lists the words. `seamwright plan
/// PART --taught FILE` makes a program of it.
///
/// Seams through taught places ([seam]), on any machine: the machine homes, goes to --from if that is given, and the operator
/// leads the tip by commands on standard input and takes places down; help lists the words. Every place is written at once, and the
/// same command continues after the last one.
///
/// Panels ([panel]): the machine homes, goes from guide point to guide point, measures rings of eight neighbours around
/// each, turns the probe to the normal they show, and parks. With taught = "taught.csv" in its part file the panel can
/// be planned.
#[derive(Debug, Args)]
pub struct Teach {
    /// Part file of seams or of a panel
    part: PathBuf,
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: PathBuf,
    #[command(flatten)]
    boards: BoardArgs,
    /// Where the points go (CSV), those up to a trouble too [default: where the part file expects taught seams]
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    seams: SeamArgs,
    /// Start of the noise of simulated cameras and probes
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Teach {
    /// Teaches and writes the points.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let part = PartFile::read(&self.part)?;
        if part.t_seam().is_some() {
            let machine = (&machine, self.machine.as_path());
            return self
                .seams
                .teach(&self.boards, machine, &part, self.output.as_deref(), self.seed);
        }
        if part.taught_seam().is_some() {
            let machine = (&machine, self.machine.as_path());
            return self
                .seams
                .lead(&self.boards, machine, &part, self.output.as_deref());
        }
        self.seams.refuse()?;
        let output = self
            .output
            .context("where should the points be written? give --output FILE")?;
        let note =
            check_teaching(&machine, &part).with_context(|| format!("part {}", self.part.display()))?;
        if let Some(note) = note {
            errln!("seamwright: part {}: {note}", self.part.display());
        }
        let job = Job {
            machine: &machine,
            work: Work::Teach,
            part: Some(&part),
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings {
                seed: self.seed,
                truth: self.boards.truth(&machine)?,
                ..Surroundings::default()
            }
            .into(),
            spooling: Default::default(),
            names: Names {
                program: self.part.display().to_string(),
                machine: self.machine.display().to_string(),
                seam: None,
                boards: self.boards.name(),
            },
        };
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        let points = &ended.taught.points;
        if !points.is_empty() {
            let file = &output;
            let output = file.display();
            std::fs::write(file, write_points(points)).with_context(|| format!("cannot write {output}"))?;
            outln!("{output}: {} points", points.len());
            for figure in &ended.report.figures {
                outln!("  {} {:.4} {}", figure.text, figure.value, figure.unit);
            }
        }
        exit_code(ended.error)
    }
}
