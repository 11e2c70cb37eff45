//! NC programs through two interpreters, ours and the peer's (LinuxCNC's `rs274`): which they accept, and whether they
//! understand the same. Built and run by `cargo xtask bench nc`.
//!
//! ```text
//! program → rs274 → canonical commands → canon ─┐
//!                                               ├→ two lists of motions and outputs → compare → report
//! program → nc::interpret_file → Program → ours ┘
//! ```

mod arc;
mod canon;
mod compare;
mod generate;
mod list;
mod mutate;
mod ours;
mod peer;
mod process;
mod programs;
mod quirks;
mod random;
mod report;
mod run;
mod worker;

use anyhow::{Context, Result, ensure};
use clap::{Parser, Subcommand};
use report::Told;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Parser)]
#[command(about, disable_help_subcommand = true)]
struct Arguments {
    #[command(subcommand)]
    task: Option<Task>,
    /// Programs of this folder, in place of those of the peer's package
    #[arg(long, value_name = "FOLDER")]
    programs: Option<PathBuf>,
    /// So many random programs in their place
    #[arg(long, value_name = "N", conflicts_with = "programs")]
    random: Option<u64>,
    /// So many mutated programs, through our interpreter only
    #[arg(long, value_name = "N", conflicts_with = "random")]
    mutate: Option<u64>,
    /// Seed of random and mutated programs
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Folder for programs that fail
    #[arg(long, value_name = "FOLDER", default_value = "nc-failures")]
    failures: PathBuf,
}

#[derive(Subcommand)]
enum Task {
    /// Reads the programs that standard input names
    #[command(hide = true)]
    Worker,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match arguments.task {
        Some(Task::Worker) => worker::serve().map(|()| true),
        None => bench(&arguments),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Whether there was nothing that must not be: differences, panics, hangs.
fn bench(arguments: &Arguments) -> Result<bool> {
    let folder = tempfile::tempdir()?;
    if let Some(count) = arguments.random {
        return random(count, arguments, folder.path());
    }
    let files = match &arguments.programs {
        Some(folder) => programs::of_folder(folder)?,
        None => programs::installed()?,
    };
    ensure!(!files.is_empty(), "no programs (.ngc, .nc, .tap) there");
    let sources = programs::copied(&files, folder.path())?;
    if let Some(count) = arguments.mutate {
        let seed = arguments.seed;
        make(&arguments.failures)?;
        let tally = mutate::run(&sources, count, seed, &arguments.failures)?;
        println!(
            "mutated programs {count} (seed {seed}), accepted {}, panics {}, hangs {}",
            tally.accepted, tally.panics, tally.hangs
        );
        return Ok(tally.panics == 0 && tally.hangs == 0);
    }
    let copies: Vec<PathBuf> = sources.iter().map(|source| source.copy.clone()).collect();
    let pairs = run::all(&copies, folder.path())?;
    let told = sources.iter().map(|source| Told {
        name: source.original.display().to_string(),
        lathe: source.lathe,
    });
    let told: Vec<Told> = told.collect();
    print!("{}", report::of(&told, &pairs));
    Ok(report::is_good(&told, &pairs))
}

/// Random programs; those that both accept and understand differently, and those that break ours, are kept.
fn random(count: u64, arguments: &Arguments, folder: &Path) -> Result<bool> {
    let seed = arguments.seed;
    let mut files = Vec::new();
    let mut told = Vec::new();
    for case in 0..count {
        let name = format!("random-{seed}-{case}.ngc");
        let file = folder.join(&name);
        fs::write(&file, generate::program(seed, case))?;
        files.push(file);
        told.push(Told { name, lathe: false });
    }
    let pairs = run::all(&files, folder)?;
    let both = pairs
        .iter()
        .filter(|pair| pair.ours.accepted() && pair.peer.accepted())
        .count();
    let different = pairs.iter().filter(|pair| pair.difference.is_some()).count();
    let kept = pairs.iter().filter(|pair| pair.fails());
    let kept: Vec<_> = kept
        .map(|pair| (&files[pair.index], &told[pair.index].name))
        .collect();
    println!(
        "random programs, seed {seed}: of {both} that both accept {} agree",
        both - different
    );
    print!("{}", report::of(&told, &pairs));
    if !kept.is_empty() {
        make(&arguments.failures)?;
        println!("\nthese are kept in {}:", arguments.failures.display());
    }
    for (file, name) in &kept {
        fs::copy(file, arguments.failures.join(name))?;
        println!("  {name}");
    }
    Ok(kept.is_empty())
}

fn make(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
