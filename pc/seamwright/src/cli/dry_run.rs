//! `seamwright dry-run`: duration of a program, and its demands on the machine.

use super::{OUTSIDE, machine_for, plan_program, read_program, slower, waits};
use crate::console::{out, outln};
use anyhow::Context;
use cam::dry_run;
use cam::path::Planner;
use clap::Args;
use nc::Options;
use report::write_dry_run;
use std::path::PathBuf;
use std::process::ExitCode;

/// Run a program through the planner of the motion board, without boards: durations, speeds, accelerations, jerks
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code: 0 if every limit is kept, 3 if not, 1 if the machine cannot run the program."
)]
pub struct DryRun {
    /// NC program
    program: PathBuf,
    /// Machine file
    #[arg(long)]
    machine: PathBuf,
    /// Speed of the weld in place of the programmed feed [m/min]
    #[arg(long, value_name = "M_PER_MIN", value_parser = super::weld::speed, allow_negative_numbers = true)]
    speed: Option<f64>,
    /// Feed override, above 0 to 2
    #[arg(long = "override", value_name = "F", value_parser = feed_override, default_value_t = 1.0, allow_negative_numbers = true)]
    factor: f64,
    /// Where dry-run.json and the plots go [default: none are written]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Weld data that the program calls with WELDON [default: welddata.toml beside the program]
    #[arg(long, value_name = "FILE")]
    weld_data: Option<PathBuf>,
    /// Leave out blocks that start with /
    #[arg(long)]
    block_delete: bool,
    /// Start at this line of the program (its first motion in or after it)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    from_line: Option<u32>,
}

/// An override with which a program comes to its end.
fn feed_override(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(factor) if factor > 0.0 && factor <= 2.0 => Ok(factor),
        _ => Err("must be a factor above 0 and up to 2; 1 is the programmed feed"),
    }
}

impl DryRun {
    /// Prints the figures, and writes the report.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = machine_for(&self.machine, &self.program, self.weld_data.as_deref())?;
        let name = self.program.display();
        let options = Options {
            block_delete: self.block_delete,
            ..Options::default()
        };
        let program = read_program(&self.program, &machine, options)?;
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let from = machine.homed_axes();
        let mut paths = plan_program(&self.program, &program, &planner, &from, self.speed)?;
        let slower: Vec<String> = slower(&paths).collect();
        if let Some(line) = self.from_line {
            let started = planner.from_line(&program, paths, line, &from);
            paths = started.with_context(|| format!("program {name}"))?;
        }
        let ran = dry_run::run(&machine, &planner, &paths, self.factor)
            .with_context(|| format!("program {name}"))?;
        let at = match self.factor {
            1.0 => String::new(),
            factor => format!(" at {:.0} % feed", 100.0 * factor),
        };
        let start = self.from_line.map(|line| format!(" from line {line}"));
        let title = format!("{name}{} on {}{at}", start.unwrap_or_default(), machine.name);
        if let Some(directory) = &self.report {
            write_dry_run(directory, &title, &ran)?;
        }
        outln!("{title}");
        out!("{ran}");
        if let Some(waits) = waits::told(&program, self.from_line.unwrap_or(0)) {
            outln!("  {waits}: these times are in no duration");
        }
        slower.iter().for_each(|found| outln!("  {found}"));
        if let Some(directory) = &self.report {
            outln!("  report in {}", directory.display());
        }
        Ok(match ran.highest.above().next() {
            None => ExitCode::SUCCESS,
            Some(_) => ExitCode::from(OUTSIDE),
        })
    }
}
