//! `host-link plan`: from parts to programs.

use crate::machine::MachineFile;
use crate::nc::{Options, interpret};
use crate::part::PartFile;
use crate::path::Planner;
use anyhow::Context;
use clap::Args;
use std::path::PathBuf;

/// Write the program of a part
///
/// A part file says what is to be made and how; programs/ has one of each kind:
///
///   [t-seam]  two seam curves at the feet of a rib, for the dual-beam gantry
///   [saddle]  two pipes by their dimensions, or by points taught on their seam, for the pipe welder
///   [panel]   points on a curved panel, as `host-link teach` writes them, for the A/C head
///   [stir]    lines and arcs on a plate, for the friction-stir gantry
///   [bead]    a NURBS along which wire is deposited, for the wire-arc robot
///
/// To make a part of your own:
///
///   1. copy the part file of its kind from programs/ to my.toml, with the curves or points it names, and write
///      your dimensions into it; what is wrong is said with its place
///   2. host-link plan my.toml --machine machines/MACHINE.toml -o my.ngc
///   3. host-link check my.ngc --machine machines/MACHINE.toml
///   4. cargo xtask weld my.ngc --machine machines/MACHINE.toml, on emulated boards: the run is judged by my.toml,
///      because it has the name of the program
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct Plan {
    /// Part file
    part: PathBuf,
    /// Machine file
    #[arg(long)]
    machine: PathBuf,
    /// Program to write
    #[arg(short, long)]
    output: PathBuf,
}

impl Plan {
    /// Plans, checks and writes the program.
    pub fn run(self) -> anyhow::Result<()> {
        let machine = MachineFile::read(&self.machine)?;
        let part = PartFile::read(&self.part)?;
        let title = self
            .output
            .file_stem()
            .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let name = self.part.display();
        let plan = part
            .plan(&machine, &title)
            .with_context(|| format!("part {name}"))?;

        // What is written has been read and checked as the weld will.
        let program = interpret(&plan.program, Options::default()).context("the planned program")?;
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let from = machine.planning.park_axes();
        let paths = planner
            .program(&program, &from, None)
            .context("the planned program")?;
        let output = self.output.display();
        std::fs::write(&self.output, &plan.program)
            .map_err(|error| anyhow::anyhow!("cannot write {output}: {error}"))?;

        println!("{output}:");
        for note in &plan.notes {
            println!("  {note}");
        }
        for path in &paths {
            if let Some((start, end)) = path.weld() {
                println!(
                    "  run-in {start:.2} mm, weld {:.2} mm, run-out {:.2} mm",
                    end - start,
                    path.length_mm() - end
                );
                println!("  speed along the path exact to {:.1e}", path.speed_error);
            }
        }
        Ok(())
    }
}
