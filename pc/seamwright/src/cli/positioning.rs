//! `seamwright positioning`: a test of positioning accuracy after ISO 230-2, and tables that make up for what it shows.

use super::boards::{BoardArgs, exit_code};
use super::{OUTSIDE, above_0, dwell};
use crate::console::{errln, outln};
use crate::terminal::Operator;
use anyhow::{Context, anyhow, bail};
use cam::path::Planner;
use clap::Args;
use commission::{Approach, Positioning, rewrite_deviation};
use config::machine::MachineFile;
use config::table;
use emulator::MACHINE_VARIABLE;
use host_link::geometry::MachineGeometry;
use job::{NoTest, PlannedPositioning, PositioningTest, Rest, Work};
use report::write_positioning;
use shared::config::DEVIATION_POINTS;
use shared::io::{AXIS_NAMES, MOTOR_AXIS, MOTOR_NAMES, is_called};
use shared::kinematics::AXIS_UNIT;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Distance of targets, if their number is not said (mm, degrees).
const APART: [f64; 2] = [50.0, 15.0];
/// Fewest targets, if their number is not said: those of the standard.
const FEWEST: usize = 5;

/// Test of positioning accuracy (ISO 230-2): an axis goes to targets from both sides and rests at each
///
/// On a simulated machine its truth tells by how much it is beside each target. A real one is measured at its rests by an interferometer
/// (an autocollimator for angles), whose table --measured reads. With --output what repeats goes into the machine file, beside what it
/// has already, and the motion board makes up for it. The other axes stand at their reference marks. Everything must be free to move.
#[derive(Debug, Args)]
#[command(
    name = "positioning",
    after_help = "Exit code: 0 if the axis was never further off than --within says, 3 if it was, 1 if there is no room or something failed, \
    130 after Ctrl-C, SIGTERM or SIGHUP."
)]
pub struct PositioningCommand {
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: PathBuf,
    /// Axis that goes to the targets
    #[arg(long, value_name = "AXIS", ignore_case = true)]
    axis: String,
    /// What is beside its place by it: the axis itself, others for straightness and squareness, a motor of a gantry [default: the axis]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', ignore_case = true)]
    of: Vec<String>,
    /// Targets over the travel [default: one every 50 mm or 15 degrees, 5 to 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=1000))]
    targets: Option<u16>,
    /// How often the axis goes there and back
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=20), default_value_t = 5)]
    runs: u16,
    /// Rest at each target [s]
    #[arg(long, value_name = "S", value_parser = dwell, default_value_t = 1.0)]
    dwell: f64,
    /// What an interferometer measured, in place of a test: CSV with target_mm,deviation_um (target_deg, deviation_arcsec), in order
    #[arg(long, value_name = "FILE")]
    measured: Option<PathBuf>,
    /// Farthest that the axis may be beside a target [mm or degrees; default: nothing is judged]
    #[arg(long, value_name = "MM", value_parser = above_0, allow_negative_numbers = true)]
    within: Option<f64>,
    #[command(flatten)]
    boards: BoardArgs,
    /// Machine file to write, with what was measured [default: it is only told]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Folder for plots (SVG) and tables (CSV) [default: none]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// What deviates: name, axis, and the first of its motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Of {
    name: &'static str,
    axis: usize,
    motor: usize,
}

/// The approaches by what they show.
type Seen = Vec<(Of, Vec<Approach>)>;

impl Of {
    /// Units of its deviations, as tables and messages have them, and how many of the first are in one of the machine file.
    fn units(self) -> (&'static str, &'static str, f64) {
        if is_rotary(self.axis) {
            ("arcsec", "\"", 3600.0)
        } else {
            ("um", "µm", 1000.0)
        }
    }

    /// What it shows at a rest.
    fn approach(self, rest: &Rest) -> Approach {
        Approach {
            target: rest.target,
            deviation: if self.name == AXIS_NAMES[self.axis] {
                rest.axes[self.axis]
            } else {
                rest.motors[self.motor]
            },
            backwards: rest.backwards,
        }
    }

    /// Columns of its table along `axis`.
    fn columns(self, axis: usize) -> [String; 2] {
        let unit = if is_rotary(axis) { "deg" } else { "mm" };
        [format!("target_{unit}"), format!("deviation_{}", self.units().0)]
    }
}

fn is_rotary(axis: usize) -> bool {
    AXIS_UNIT[axis] != 1.0
}

impl PositioningCommand {
    /// Measures or reads, tells, and writes.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        let axis = self.axis(&machine)?;
        let all = self.of(&machine, axis)?;
        let found = match &self.measured {
            Some(file) => {
                let [of] = all[..] else {
                    bail!("--measured is of one thing: name it with --of, and read the others one by one");
                };
                vec![(of, read(file, of, axis)?)]
            }
            None => {
                self.boards.check(&machine)?;
                match self.test(&machine, axis, &all)? {
                    Ok(found) => found,
                    Err(code) => return Ok(code),
                }
            }
        };
        let mut text = std::fs::read_to_string(&self.machine)
            .with_context(|| format!("machine file {}", self.machine.display()))?;
        let mut farthest = 0.0_f64;
        for (of, approaches) in &found {
            let name = of.name;
            let positioning = Positioning::of(approaches)
                .map_err(|error| anyhow!("{name} along {}: {error}", AXIS_NAMES[axis]))?;
            self.tell(*of, axis, &positioning)?;
            let off = approaches.iter().map(|approach| approach.deviation.abs());
            farthest = off.fold(farthest, f64::max);
            let held = machine
                .deviations
                .iter()
                .find(|held| (usize::from(held.axis), usize::from(held.motor)) == (axis, of.motor));
            let table = positioning.table(axis, of.motor, machine.homed_axes()[axis], held);
            text = rewrite_deviation(&text, name, AXIS_NAMES[axis], &table)
                .with_context(|| format!("machine file {}", self.machine.display()))?;
        }
        if let Some(output) = &self.output {
            MachineFile::parse(&output.display().to_string(), &text)
                .context("what was measured makes no machine file, and none is written")?;
            std::fs::write(output, text).with_context(|| format!("cannot write {}", output.display()))?;
            outln!("{}", output.display());
        }
        match self.within {
            Some(within) if farthest > within => {
                errln!("seamwright: the axis was up to {farthest:.4} off, and may be {within}");
                Ok(ExitCode::from(OUTSIDE))
            }
            _ => Ok(ExitCode::SUCCESS),
        }
    }

    fn axis(&self, machine: &MachineFile) -> anyhow::Result<usize> {
        let fitted: Vec<_> = AXIS_NAMES
            .iter()
            .zip(&machine.motion.axes)
            .filter_map(|(name, axis)| axis.as_ref().map(|_| *name))
            .collect();
        let name = fitted.iter().find(|name| name.eq_ignore_ascii_case(&self.axis));
        let index = name.and_then(|name| AXIS_NAMES.iter().position(|axis| axis == name));
        index.with_context(|| {
            format!(
                "--axis: the machine has no axis {}; it has {}",
                self.axis,
                fitted.join(", ")
            )
        })
    }

    fn of(&self, machine: &MachineFile, axis: usize) -> anyhow::Result<Vec<Of>> {
        let fitted = || (0..MOTOR_NAMES.len()).filter(|motor| machine.motion.motors[*motor].is_some());
        let of = |name: &str| {
            let name = name.to_uppercase();
            fitted().find(|motor| is_called(*motor, &name)).map(|motor| {
                let axis = MOTOR_AXIS[motor];
                let names = [AXIS_NAMES[axis], MOTOR_NAMES[motor]];
                Of {
                    name: if names[0] == name { names[0] } else { names[1] },
                    axis,
                    motor,
                }
            })
        };
        if self.of.is_empty() {
            return Ok(of(AXIS_NAMES[axis]).into_iter().collect());
        }
        let known = |name: &String| {
            of(name).with_context(|| {
                let names: Vec<_> = fitted().map(|motor| MOTOR_NAMES[motor]).collect();
                format!(
                    "--of: the machine has no axis or motor {name}; it has {}",
                    names.join(", ")
                )
            })
        };
        self.of.iter().map(known).collect()
    }

    /// On the boards; an exit code where the job ended before, or where nothing was seen that a table could be made of.
    fn test(&self, machine: &MachineFile, axis: usize, all: &[Of]) -> anyhow::Result<Result<Seen, ExitCode>> {
        let planner = Planner::build(machine).with_context(|| self.machine.display().to_string())?;
        let test = PositioningTest {
            axis,
            targets: self.targets(machine, axis),
            runs: self.runs.into(),
            dwell_s: self.dwell,
        };
        let planned = test.plan(machine, &planner).map_err(|error| match error {
            NoTest::Program(_) | NoTest::Path(_) => {
                anyhow!(error).context("the machine cannot go to these targets")
            }
            other => anyhow!(other),
        })?;
        let work = Work::Program(&planned.program);
        let job = self
            .boards
            .bare_job((machine, &*self.machine), work, "positioning test".to_owned());
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(Err(code)),
        };
        if ended.error.is_some() {
            return exit_code(ended.error).map(Err);
        }
        let geometry = MachineGeometry::build(&machine.motion)?;
        let Some(seen) = planned.seen(&geometry, &ended.record)? else {
            tell_rests(&planned, all);
            return Ok(Err(ExitCode::SUCCESS));
        };
        let found = all
            .iter()
            .map(|of| (*of, seen.iter().map(|rest| of.approach(rest)).collect()));
        Ok(Ok(found.collect()))
    }

    fn targets(&self, machine: &MachineFile, axis: usize) -> usize {
        let travel = machine.motion.axes[axis]
            .as_ref()
            .map_or(0.0, |limits| limits.travel_max - limits.travel_min);
        let usual = (travel / APART[usize::from(is_rotary(axis))]) as usize + 1;
        self.targets
            .map_or_else(|| usual.clamp(FEWEST, DEVIATION_POINTS), usize::from)
    }

    /// Figures, plot and table.
    fn tell(&self, of: Of, axis: usize, positioning: &Positioning) -> anyhow::Result<()> {
        let (_, unit, scale) = of.units();
        let title = format!(
            "{} along {}: {}",
            of.name,
            AXIS_NAMES[axis],
            self.machine.display()
        );
        let figures = positioning.figures();
        let told = |figure: Option<f64>| match figure {
            Some(figure) => format!("{:.2} {unit}", scale * figure),
            None => "needs more than one run".to_owned(),
        };
        outln!("{title}");
        outln!("  accuracy A             {}", told(figures.accuracy));
        outln!("  repeatability R        {}", told(figures.repeatability));
        outln!("  systematic deviation E {}", told(Some(figures.systematic)));
        outln!("  reversal value B       {}", told(Some(figures.reversal)));
        outln!(
            "  range of the mean M    {}, for which a table makes up",
            told(Some(figures.mean_range))
        );
        if !positioning.is_even() {
            errln!(
                "seamwright: the targets are uneven, or more than {DEVIATION_POINTS}: the table has even steps, straight between them"
            );
        }
        if let Some(report) = &self.report {
            std::fs::create_dir_all(report).with_context(|| format!("cannot make {}", report.display()))?;
            let name = format!("{}-along-{}", of.name, AXIS_NAMES[axis]);
            write_positioning(
                &report.join(&name).with_extension("svg"),
                &title,
                (is_rotary(axis), unit, scale),
                positioning,
            )?;
            write_table(&report.join(&name).with_extension("csv"), of, axis, positioning)?;
        }
        Ok(())
    }
}

/// What is to be done on a machine that has no truth.
fn tell_rests(planned: &PlannedPositioning, all: &[Of]) {
    outln!(
        "The axis has rested at {} targets, {} runs there and back. This machine does not know where it truly was: write down what the \
         interferometer shows at each rest, in this order, and read it with --measured FILE:",
        planned.rests.len(),
        planned.test.runs
    );
    for of in all {
        outln!("{}   (of {})", of.columns(planned.test.axis).join(","), of.name);
    }
    for (target, _) in planned.rests.iter().take(planned.rests.len() / planned.test.runs) {
        outln!("{target:.4},");
    }
}

/// The table of an interferometer: a target is approached from the side of the one before it.
fn read(file: &Path, of: Of, axis: usize) -> anyhow::Result<Vec<Approach>> {
    let path = file.display().to_string();
    let columns = of.columns(axis);
    let columns = [columns[0].as_str(), columns[1].as_str()];
    let (_, _, scale) = of.units();
    let mut rows = Vec::new();
    for (line, cells) in table::cells(&path, &table::read(file)?, &columns)? {
        rows.push(table::numbers(&path, line, columns, &cells)?);
    }
    let side = |row: usize| {
        let before = rows[..row].iter().rev().map(|[target, _]| *target);
        let here = rows[row][0];
        let other = before
            .chain(rows.iter().map(|[target, _]| *target))
            .find(|target| *target != here);
        // The first comes as the next goes on; where the axis turns round at a target it comes to it again from beyond.
        let turned = row > 0 && rows[row - 1][0] == here;
        let first = rows[..row].iter().all(|[target, _]| *target == here);
        other.map(|other| (here < other) != (turned || first))
    };
    Ok((0..rows.len())
        .map(|row| Approach {
            target: rows[row][0],
            deviation: rows[row][1] / scale,
            backwards: side(row).unwrap_or(false),
        })
        .collect())
}

/// Mean deviations in a table.
fn write_table(path: &Path, of: Of, axis: usize, positioning: &Positioning) -> anyhow::Result<()> {
    let (_, _, scale) = of.units();
    let mut text = of.columns(axis).join(",") + "\n";
    for target in positioning.targets() {
        // A text is always written.
        let _ = writeln!(text, "{:.4},{:.3}", target.at, scale * target.mean());
    }
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}
