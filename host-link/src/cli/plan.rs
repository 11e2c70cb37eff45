//! `host-link plan`: from seam curves to programs.

use crate::machine::MachineFile;
use crate::nc::{Options, interpret};
use crate::path::Planner;
use crate::plan::{PlanOptions, plan_dual_beam};
use crate::seam::{read_main_curve, read_other_curve};
use anyhow::Context;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Write a program from seam curves
#[derive(Debug, Args)]
pub struct Plan {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    DualBeam(DualBeam),
}

/// Weld both feet of a rib with the two beams of the dual-beam head
#[derive(Debug, Args)]
struct DualBeam {
    /// Main seam, in the direction of travel (CSV x_mm,y_mm,z_mm,nx,ny,nz with the skin normal)
    seam1: PathBuf,
    /// Seam on the other side of the rib (CSV x_mm,y_mm,z_mm)
    seam2: PathBuf,
    /// Machine file
    #[arg(long)]
    machine: PathBuf,
    /// Program to write
    #[arg(short, long)]
    output: PathBuf,
    /// Speed of the tip [m/min]
    #[arg(long, default_value_t = 5.0, value_name = "M_PER_MIN")]
    speed: f64,
    /// Power of each beam [W]
    #[arg(long, default_value_t = 2000.0, value_name = "WATT")]
    power: f64,
    /// Cut both seams by the plane across seam 1, as the published method does
    #[arg(long)]
    paper: bool,
}

impl Plan {
    /// Plans, checks and writes the program.
    pub fn run(self) -> anyhow::Result<()> {
        match self.kind {
            Kind::DualBeam(command) => command.run(),
        }
    }
}

impl DualBeam {
    fn run(self) -> anyhow::Result<()> {
        let machine = MachineFile::read(&self.machine)?;
        let main = read_main_curve(&self.seam1)?;
        let other = read_other_curve(&self.seam2)?;
        let title = self
            .output
            .file_stem()
            .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let options = PlanOptions {
            title,
            speed_m_min: self.speed,
            power_w: [self.power; 2],
            paper: self.paper,
        };
        let plan = plan_dual_beam(&main, &other, &machine, &options)?;

        // What is written has been read and checked as the weld will.
        let program = interpret(&plan.program, Options::default()).context("the planned program")?;
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let from = planner.tip(&machine.planning.park_axes());
        let paths = planner
            .program(&program, &from, None)
            .context("the planned program")?;
        let output = self.output.display();
        std::fs::write(&self.output, &plan.program)
            .map_err(|error| anyhow::anyhow!("cannot write {output}: {error}"))?;

        println!("{output}: {} points", plan.points.len());
        for path in &paths {
            if let Some((start, end)) = path.weld() {
                println!(
                    "run-in {start:.2} mm, weld {:.2} mm, run-out {:.2} mm",
                    end - start,
                    path.length_mm() - end
                );
                println!("speed along the path exact to {:.1e}", path.speed_error);
            }
        }
        println!(
            "beam axes meet within {:.1e} mm; speed on seam 2 differs by up to {:.2} %",
            plan.max_gap,
            100.0 * plan.max_speed_difference
        );
        Ok(())
    }
}
