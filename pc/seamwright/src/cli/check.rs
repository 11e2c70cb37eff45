//! `seamwright check`: can this machine run this program?

use super::explain::{Explanation, Lines};
use super::{machine_for, plan_program, read_program, read_program_by, slower, waits};
use crate::console::{out, outln};
use anyhow::{Context, bail};
use cam::dry_run;
use cam::dry_run::Forecast;
use cam::path::{Blocks, PlannedPath, Planner};
use clap::Args;
use config::machine::MachineFile;
use nc::{Motion, Options, Program, explain_file};
use std::path::PathBuf;
use world::{Deviation, SeamError, check_seam, not_followed};

/// Check a program against a machine: travel, speeds, the reach of the slides, and what the cameras see of a seam
#[derive(Debug, Args)]
pub struct Check {
    /// NC program
    program: PathBuf,
    /// Machine file
    #[arg(long)]
    machine: PathBuf,
    /// Seam deviation (CSV) that the slides must reach
    #[arg(long)]
    seam: Option<PathBuf>,
    /// Feed that replaces the programmed one [m/min]
    #[arg(long, value_name = "M_PER_MIN")]
    speed: Option<f64>,
    /// Weld data that the program calls with WELDON [default: welddata.toml beside the program]
    #[arg(long, value_name = "FILE")]
    weld_data: Option<PathBuf>,
    /// Leave out blocks that start with /
    #[arg(long)]
    block_delete: bool,
    /// First print what each block does, as it was understood, or only those of a line or of some lines (120, 100-140)
    #[arg(long, value_name = "LINES", num_args = 0..=1, require_equals = true, default_missing_value = Lines::ALL)]
    explain: Option<Lines>,
}

impl Check {
    /// Prints every path with its length and time.
    pub fn run(self) -> anyhow::Result<()> {
        let machine = machine_for(&self.machine, &self.program, self.weld_data.as_deref())?;
        let name = self.program.display();
        let program = self.read(&machine)?;
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let from = machine.homed_axes();
        let paths = plan_program(&self.program, &program, &planner, &from, self.speed)?;
        let seam = self.seam.as_deref().map(Deviation::read).transpose()?;
        match check_seam(&paths, &machine, seam.as_ref()) {
            // Without a seam, what can be said without one is said.
            Ok(()) | Err(SeamError::NoSeam) => {}
            Err(error) => return Err(error).with_context(|| format!("program {name}")),
        }
        let ran = dry_run::forecast(&machine, &planner, &paths).with_context(|| format!("program {name}"))?;
        print(&paths, &ran);
        if let Some(waits) = waits::told(&program, 0) {
            outln!("  {waits}: these times are in no duration");
        }
        slower(&paths).for_each(|found| outln!("  {found}"));
        out!("{}", ran.slowed);
        print_weakened(&machine);
        let found = not_followed(&paths, &machine, seam.as_ref())?;
        if !found.is_empty() {
            let seam = self.seam.as_deref();
            let of = seam.map_or(format!("program {name}"), |seam| {
                format!("seam {}", seam.display())
            });
            for found in &found {
                outln!("cannot be followed by cameras: {found}");
            }
            bail!(
                "{of} cannot be followed by cameras in {} places, see above",
                found.len()
            );
        }
        Ok(())
    }
}

impl Check {
    /// The program, explained if that was asked for.
    fn read(&self, machine: &MachineFile) -> anyhow::Result<Program> {
        let options = Options {
            block_delete: self.block_delete,
            ..Options::default()
        };
        let Some(lines) = self.explain else {
            return read_program(&self.program, machine, options);
        };
        let mut explanation = Explanation::of(lines);
        let read = read_program_by(&self.program, machine, options, |file, options| {
            explain_file(file, options, |told| explanation.tell(&told))
        });
        explanation.end();
        read
    }
}

/// Protections that the machine file leaves weaker than usual.
fn print_weakened(machine: &MachineFile) {
    for weakened in machine.weak_protections() {
        outln!("weak protection: {weakened}");
    }
}

fn print(paths: &[PlannedPath], ran: &Forecast) {
    outln!(" path            length      time     speed  pieces");
    for (index, (path, time_s)) in paths.iter().zip(&ran.paths_s).enumerate() {
        let kind = match path.motion {
            Motion::Rapid => "rapid",
            Motion::Feed => "feed",
            Motion::Stand => "stand",
        };
        let m_min = |speed: f64| speed / shared::units::MM_S_PER_M_MIN;
        let speeds = path.speeds();
        outln!(
            "{:5} {kind:<6} {:9.1} mm {:7.2} s {:6.2} m/min {:7}",
            index + 1,
            path.length_mm(),
            time_s,
            m_min(speeds.fastest_mm_s),
            path.pieces(),
        );
        if speeds.changes > 0 {
            outln!(
                "      changes its feed {} times, down to {:.2} m/min",
                speeds.changes,
                m_min(speeds.slowest_mm_s)
            );
        }
        let summary = path.blocks.as_ref().map(Blocks::summary);
        if let Some(summary) = summary.filter(|summary| summary.stops > 0) {
            out!("      stops {} times on the way", summary.stops);
            match summary.corners {
                0 => outln!(),
                corners => outln!(
                    ", {corners} times at a corner, of {:.1}° at most",
                    summary.sharpest.to_degrees()
                ),
            }
        }
        if let Some(tolerance) = summary.and_then(|summary| summary.tolerance_mm) {
            outln!("      rounds corners by {tolerance} mm at most, at the closest");
        }
        if let Some(bound) = path.bound {
            outln!(
                "      {} of {} allows {:.2} m/min (at {:.1} mm)",
                bound.quantity,
                bound.axis,
                m_min(bound.largest_mm_s),
                bound.s_mm
            );
        }
        if let Some(corner) = path.corner_deg {
            outln!("      begins at a corner of {corner:.1}°, where the machine stops");
        }
        if let Some(probe) = path.probe {
            let what = if probe.away { "comes free" } else { "touches" };
            outln!(
                "      ends where the probe {what} ({} in line {})",
                probe.code,
                probe.place.line
            );
        }
        for wait in &path.waits_before {
            outln!(
                "      waits before it {} ({} in line {})",
                wait.until,
                wait.code,
                wait.place.line
            );
        }
        if path.dwell_before_s > 0.0 {
            outln!("      after {:.2} s at rest", path.dwell_before_s);
        }
        if let Some((start, end)) = path.weld() {
            outln!(
                "      weld from {start:.1} to {end:.1} mm, {:.1} mm long",
                end - start
            );
        }
    }
    outln!(
        "total {:.2} s from the end of homing to the park position",
        ran.duration_s
    );
}
