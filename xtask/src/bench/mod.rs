//! Benchmarks: instructions of functions, on the PC and on the emulated board, and programs through the planner.

mod bad;
mod board;
mod bounded;
mod callgrind;
mod check;
mod curves;
mod docs;
mod hands;
mod markdown;
mod nc;
mod planner;
mod report;
mod robustness;
mod row;
mod table;
mod trajectories;
mod vision;

use crate::cargo::{cargo, root, run_command, target_directory};
use crate::firmware::{PROFILE, TARGET};
use crate::setup::{self, Tool};
use anyhow::{Context, Result, bail, ensure};
use benchmarks::MACHINES_FILE;
use benchmarks::machine_files::pack;
use benchmarks::record::{NOTHING, Record, Tally};
use clap::Subcommand;
use plant_file::Quality;
use robustness::Draws;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

/// The package of what is counted.
pub const PACKAGE: &str = "seamwright-benchmarks";
/// Its program.
const PROGRAM: &str = "benchmarks";

/// What can be run.
#[derive(Clone, Debug, PartialEq, Eq, Subcommand)]
pub enum Benchmark {
    /// Count instructions of forward, inverse, rates and accelerations of every machine
    Kinematics {
        /// Put the table into docs/benchmarks.md too
        #[arg(long)]
        record: bool,
    },
    /// Count instructions of the trajectory planner, tick by tick, on programs that need no files
    Planner {
        /// Put the table into docs/benchmarks.md too
        #[arg(long)]
        record: bool,
    },
    /// Time and count the measurement of pictures, and hold it against rendered truth
    Vision {
        /// Pictures of gaps to measure; each takes a tenth of a second of a core. 0: only what a picture costs
        #[arg(long, value_name = "N", default_value_t = 2000)]
        frames: u64,
        /// Put the tables into docs/benchmarks.md too
        #[arg(long)]
        record: bool,
    },
    /// Run random programs with hands at the controls (holds, overrides, ways back) through the planner; fails if one of them
    /// breaks a limit, leaves the path, or obeys a hold or a lower override too late
    Hands {
        /// How many; a thousand take some seconds
        #[arg(long, value_name = "N", default_value_t = 10_000)]
        programs: u64,
        /// Seed of the first; the others follow
        #[arg(long, value_name = "N", default_value_t = 0)]
        seed: u64,
    },
    /// Run curves in short lines at feeds below and above what they can be gone along with, on a machine that comes to its
    /// acceleration in 50 ms, beside the best constant speed; fails if a limit is not kept
    Curves {
        /// Random curves after those of each kind; one takes half a second
        #[arg(long, value_name = "N", default_value_t = 0)]
        random: u64,
        /// Seed of the first of them; the others follow
        #[arg(long, value_name = "N", default_value_t = 0)]
        seed: u64,
        /// Put the table into docs/benchmarks.md too
        #[arg(long)]
        record: bool,
    },
    /// Read NC programs with our interpreter and with LinuxCNC's: which they accept, and whether they understand the same;
    /// fails if a program that both accept differs
    Nc {
        /// Programs of this folder; else those that LinuxCNC installs
        #[arg(long, value_name = "DIR")]
        programs: Option<PathBuf>,
        /// Random programs in their place; a hundred take a second
        #[arg(long, value_name = "N", conflicts_with = "programs")]
        random: Option<u64>,
        /// Mutate them so many times, and read these with our interpreter only; fails if it panics or hangs
        #[arg(long, value_name = "N", conflicts_with = "random")]
        mutate: Option<u64>,
        /// Seed of random and mutated programs
        #[arg(long, value_name = "N", default_value_t = 0)]
        seed: u64,
    },
    /// Draw machines at random and let each weld the shipped job of its kind on simulated boards, with the shipped gains and
    /// commissioned; fails if a commissioned one does not weld within its limits. Bad ones are only commissioned; fails if fewer than
    /// 90 % are refused for the right reason. A draw takes half a minute
    Robustness {
        /// Which machine
        #[arg(long, value_name = "NAME", default_value = plant_file::DEFAULT_MACHINE)]
        machine: String,
        /// usual, poor or bad
        #[arg(long, default_value_t = Quality::Usual)]
        quality: Quality,
        /// How many
        #[arg(long, value_name = "N", default_value_t = 10)]
        draws: u32,
        /// Seed of the first; the others follow
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u32,
    },
    /// Check a program of many short lines with `seamwright check`: time and memory
    Check {
        /// How many
        #[arg(long, value_name = "N", default_value_t = 1_000_000)]
        lines: u64,
    },
    /// Run every program (.seg) of a folder through the trajectory planner; fails if a limit is not kept
    Trajectories {
        /// Folder of the programs, and of baseline.csv with what another planner took, if there is one
        #[arg(long, value_name = "DIR")]
        programs: PathBuf,
        /// Count instructions of every tick, by valgrind
        #[arg(long)]
        instructions: bool,
        /// Put the table into docs/benchmarks.md too
        #[arg(long)]
        record: bool,
    },
}

/// Names of the benchmarks, in the documentation.
const KINEMATICS: &str = "kinematics";
const PLANNER: &str = "planner";
const TRAJECTORIES: &str = "trajectories";
const CURVES: &str = "curves";
const VISION: &str = "vision";
const VISION_COST: &str = "vision cost";

impl Benchmark {
    /// What must be installed for it.
    pub fn wants(&self) -> &'static [Tool] {
        match self {
            Self::Kinematics { .. } | Self::Planner { .. } => &setup::COUNTING,
            Self::Vision { .. }
            | Self::Trajectories {
                instructions: true, ..
            } => &[Tool::Valgrind],
            Self::Nc { .. } => &[Tool::LinuxCnc],
            Self::Check { .. }
            | Self::Curves { .. }
            | Self::Hands { .. }
            | Self::Robustness { .. }
            | Self::Trajectories { .. } => &[],
        }
    }

    /// Runs it.
    pub fn run(self) -> Result<ExitCode> {
        match self {
            Self::Kinematics { record } => kinematics(record),
            Self::Planner { record } => planner::run(record),
            Self::Curves { random, seed, record } => curves::run(random, seed, record),
            Self::Check { lines } => check::run(lines),
            Self::Hands { programs, seed } => hands::run(programs, seed),
            Self::Robustness {
                machine,
                quality,
                draws,
                seed,
            } => robustness::run(&Draws {
                machine,
                quality,
                seed,
                draws,
            }),
            Self::Nc {
                programs,
                random,
                mutate,
                seed,
            } => nc::run(programs.as_deref(), random, mutate, seed),
            Self::Vision { frames, record } => vision::run(frames, record),
            Self::Trajectories {
                programs,
                instructions,
                record,
            } => trajectories::run(&programs, instructions, record),
        }
    }
}

/// One function of one subject, counted.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    subject: String,
    function: String,
    tally: Tally,
}

/// All of a run.
#[derive(Debug, PartialEq)]
struct Counts {
    rows: Vec<Row>,
    checksum: u64,
}

/// Builds, runs and counts the programs of both, prints the table, and puts it into the documentation if `record`.
fn kinematics(record: bool) -> Result<ExitCode> {
    let folder = folder()?;
    let pc = build(None)?;
    let image = build(Some(TARGET))?;
    eprintln!("counting on the PC");
    let pc = callgrind::run(&pc, KINEMATICS, &folder)?;
    eprintln!("counting on the emulated board");
    let board = board::run(&image, KINEMATICS, &folder)?;
    ensure!(
        pc.checksum == board.checksum,
        "PC and board differ in their results: {:016x}, {:016x}",
        pc.checksum,
        board.checksum
    );
    publish(
        KINEMATICS,
        &table::of(pc.without_counting()?, board.without_counting()?)?,
        record,
    )?;
    Ok(ExitCode::SUCCESS)
}

/// The folder that the programs run in, with the file of machines in it.
fn folder() -> Result<PathBuf> {
    let folder = target_directory()?.join("benchmarks");
    let cannot = || format!("cannot write to {}", folder.display());
    fs::create_dir_all(&folder).with_context(cannot)?;
    let machines = folder.join(MACHINES_FILE.to_str()?);
    fs::write(machines, pack(&root().join("machines"))?).with_context(cannot)?;
    Ok(folder)
}

/// Prints the table of the benchmark called `name`, and puts it into the documentation if `record`.
fn publish(name: &str, table: &str, record: bool) -> Result<()> {
    print!("{table}");
    if record {
        docs::replace(&root().join("docs/benchmarks.md"), name, table)?;
    }
    Ok(())
}

/// Builds the program as firmware is built, for the boards' processor or for the PC.
fn build(target: Option<&str>) -> Result<PathBuf> {
    build_as(PROFILE, target)
}

/// Whether a stack that runs over its end leads to the handler of faults, on the emulated board.
pub fn stack_overflow() -> Result<()> {
    let image = build(Some(TARGET))?;
    board::overflow_stack(&image, &folder()?)
}

/// The same in another profile.
fn build_as(profile: &str, target: Option<&str>) -> Result<PathBuf> {
    let what = format!("the benchmarks for {}", target.unwrap_or("the PC"));
    eprintln!("building {what}");
    let mut command = cargo(&["build", "--quiet", "--package", PACKAGE, "--profile", profile])?;
    let mut folder = target_directory()?;
    if let Some(target) = target {
        command.args(["--target", target]);
        folder.push(target);
    }
    run_command(command, &format!("building {what}"))?;
    Ok(folder.join(profile).join(PROGRAM))
}

impl Counts {
    /// Reads what a program printed. Other lines may stand between.
    fn read(text: &str) -> Result<Self> {
        let mut rows = Vec::new();
        for record in text.lines().filter_map(Record::parse) {
            match record {
                Record::Count {
                    subject,
                    function,
                    tally,
                } => rows.push(Row {
                    subject: subject.to_owned(),
                    function: function.to_owned(),
                    tally,
                }),
                Record::Call { .. } => {}
                Record::Checksum(checksum) => return Ok(Self { rows, checksum }),
            }
        }
        bail!("the benchmark did not end; it printed:\n{text}")
    }

    /// The rows less what counting itself costs, which is what the function that does nothing costs.
    fn without_counting(&self) -> Result<Vec<Row>> {
        let mut rows = Vec::new();
        let mut nothing: Option<&Row> = None;
        for row in &self.rows {
            if row.function == NOTHING {
                let Tally { calls, total, worst } = row.tally;
                ensure!(
                    total == u64::from(calls) * u64::from(worst),
                    "counting itself does not always cost the same: {row:?}"
                );
                nothing = Some(row);
                continue;
            }
            let cost = nothing
                .filter(|nothing| nothing.subject == row.subject)
                .context("a subject without a function that does nothing")?
                .tally
                .worst;
            let tally = &row.tally;
            rows.push(Row {
                tally: Tally {
                    total: tally.total - u64::from(cost) * u64::from(tally.calls),
                    worst: tally.worst - cost,
                    ..*tally
                },
                ..row.clone()
            });
        }
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: &str =
        "warning: of QEMU\ncount m nothing 2 20 10\ncount m inverse 2 230 120\nchecksum 0f\n";

    #[test]
    fn what_counting_costs_is_taken_off() {
        let counts = Counts::read(PRINTED).expect("complete");
        assert_eq!(counts.checksum, 15);
        let rows = counts.without_counting().expect("consistent");
        let tally = Tally {
            calls: 2,
            total: 210,
            worst: 110,
        };
        assert_eq!((rows.len(), rows[0].tally), (1, tally));
    }

    #[test]
    fn a_run_without_its_end_is_an_error_that_shows_what_was_said() {
        let error = Counts::read("count m inverse 2 230 120\nerror: of the board\n").unwrap_err();
        assert!(error.to_string().contains("error: of the board"), "{error}");
    }

    #[test]
    fn counting_that_costs_now_this_now_that_is_refused() {
        for text in [
            PRINTED.replace("2 20 10", "2 19 10"),
            PRINTED.replace("m nothing", "n nothing"),
        ] {
            assert!(Counts::read(&text).expect("complete").without_counting().is_err());
        }
    }
}
