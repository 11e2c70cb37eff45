//! `seamwright plan`: from parts to programs.

use super::machine_for;
use crate::console::outln;
use anyhow::Context;
use cam::path::{PlannedPath, Planner};
use clap::Args;
use parts::{PartFile, checked};
use std::path::{Path, PathBuf};

/// Write the program of a part
///
/// A part file says what is to be made and how; programs/ has one of each kind:
///
///   [t-seam]  two seam curves at the feet of a rib, drawn or as `seamwright teach` writes them, for the dual-beam
///             gantry
///   [saddle]  two pipes by their dimensions, or by points taught on their seam, for the pipe welder
///   [panel]   points on a curved panel, as `seamwright teach` writes them, for the A/C head
///   [stir]    lines and arcs on a plate, for the friction-stir gantry
///   [bead]    a NURBS along which wire is deposited, for the wire-arc robot
///   [seam]    places taught with the tip, and passes with weld data, for any machine
///
/// To make a part of your own:
///
///   1. copy the part file of its kind from programs/ to my.toml, with the curves or points it names, and write
///      your dimensions into it; what is wrong is said with its place
///   2. seamwright plan my.toml --machine machines/MACHINE.toml -o my.ngc
///   3. seamwright check my.ngc --machine machines/MACHINE.toml
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
    /// Plan from these taught seams (CSV), and not from the drawing
    #[arg(long, value_name = "FILE")]
    taught: Option<PathBuf>,
    /// Weld data [default: welddata.toml beside the program]
    #[arg(long, value_name = "FILE")]
    weld_data: Option<PathBuf>,
    /// Program for the measuring heads to write as well: the cameras pass along both seams, beams off
    #[arg(long, value_name = "FILE")]
    measuring_head: Option<PathBuf>,
}

impl Plan {
    /// Plans, checks and writes the program.
    pub fn run(self) -> anyhow::Result<()> {
        let machine = machine_for(&self.machine, &self.output, self.weld_data.as_deref())?;
        let mut part = PartFile::read(&self.part)?;
        if let Some(taught) = &self.taught {
            part = part.with_taught_seams(taught)?;
        }
        let of_part = || format!("part {}", self.part.display());
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let (plan, paths) = part
            .plan_checked(&machine, &planner, &title(&self.output))
            .with_context(of_part)?;
        let measuring = self.measuring_head.as_deref().map(|output| {
            let program = part
                .plan_measuring(&machine, &title(output))
                .with_context(of_part)?;
            let paths = checked(&program, &planner, &machine, true)?;
            anyhow::Ok((output, program, paths))
        });
        let measuring = measuring.transpose()?;
        write(&self.output, &plan.program)?;
        outln!("{}:", self.output.display());
        for note in &plan.notes {
            outln!("  {note}");
        }
        for path in &paths {
            if let Some((start, end)) = path.weld() {
                outln!(
                    "  run-in {start:.2} mm, weld {:.2} mm, run-out {:.2} mm",
                    end - start,
                    path.length_mm() - end
                );
                outln!("  speed along the path exact to {:.1e}", path.speed_error);
            }
        }
        if let Some((output, program, paths)) = measuring {
            write(output, &program)?;
            let length: f64 = paths.iter().map(PlannedPath::length_mm).fold(0.0, f64::max);
            outln!("{}:", output.display());
            outln!("  the cameras pass along both seams on {length:.2} mm, beams off");
        }
        Ok(())
    }
}

/// What a program is called after its file.
fn title(output: &Path) -> String {
    let stem = output.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

fn write(output: &Path, program: &str) -> anyhow::Result<()> {
    std::fs::write(output, program).with_context(|| format!("cannot write {}", output.display()))
}
