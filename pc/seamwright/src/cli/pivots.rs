//! `seamwright pivots`: where the tip goes while the attitude of the tool goes round, and the arms that this tells.

use super::boards::{BoardArgs, exit_code};
use super::{OUTSIDE, above_0};
use crate::console::{errln, outln};
use crate::terminal::Operator;
use anyhow::{Context, anyhow, bail};
use cam::path::Planner;
use clap::Args;
use commission::{Arms, SeenTip, arms, rewrite_arms};
use config::machine::MachineFile;
use config::table;
use emulator::MACHINE_VARIABLE;
use job::{PivotTest, PlannedPivots, Work};
use shared::kinematics::AxisLimits;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Columns of what was measured.
const COLUMNS: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// Arms and pivots of the head: the tip stays at a place, and the attitude goes round
///
/// Every rotary axis goes to both sides, in all combinations, and the linear ones bring the tip back to its place. Where it is beside it tells by how much the
/// lengths in [kinematics] are off. A simulated machine tells itself where its tip is; on a real one a dial gauge or a probe in a sphere is read at every rest, in
/// the frame of the work, and --measured reads that table. With --output what was found goes into the machine file. Everything must be free to move.
#[derive(Debug, Args)]
#[command(
    name = "pivots",
    after_help = "Exit code: 0 if the tip was never further off than --within says, 3 if it was, 1 if there is no room or something failed, \
    130 after Ctrl-C, SIGTERM or SIGHUP."
)]
pub struct Pivots {
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: PathBuf,
    /// Where the tip stays, in the frame of the work [mm; default: in the middle of the travel]
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true
    )]
    at: Vec<f64>,
    /// How far each rotary axis goes to both sides [degrees]
    #[arg(long, value_name = "DEG", value_parser = swing, default_value_t = 30.0)]
    swing: f64,
    /// How far the tip goes away along the tool between two attitudes [mm]
    #[arg(long, value_name = "MM", value_parser = clear, default_value_t = 20.0)]
    clear: f64,
    /// Rest in each attitude [s]
    #[arg(long, value_name = "S", value_parser = super::dwell, default_value_t = 1.0)]
    dwell: f64,
    /// What was measured, in place of a test: CSV with x_mm,y_mm,z_mm, how far the tip was beside its place in each attitude, in order
    #[arg(long, value_name = "FILE")]
    measured: Option<PathBuf>,
    /// Farthest that the tip may be from its mean place [mm; default: nothing is judged]
    #[arg(long, value_name = "MM", value_parser = above_0, allow_negative_numbers = true)]
    within: Option<f64>,
    #[command(flatten)]
    boards: BoardArgs,
    /// Machine file to write, with what was found [default: it is only told]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn swing(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(angle) if (1.0..=180.0).contains(&angle) => Ok(angle),
        _ => Err("must be an angle from 1 to 180 degrees"),
    }
}

fn clear(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(way) if (0.0..=500.0).contains(&way) => Ok(way),
        _ => Err("must be a way from 0 to 500 mm"),
    }
}

impl Pivots {
    /// Measures or reads, tells, and writes.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        let planned = self.plan(&machine)?;
        let seen = match &self.measured {
            Some(file) => read(file, &planned)?,
            None => match self.test(&machine, &planned)? {
                Ok(seen) => seen,
                Err(code) => return Ok(code),
            },
        };
        let limits = AxisLimits::build_all(&machine.motion.axes)?;
        let found = arms(&machine.motion.kinematics, &limits, &seen)?;
        self.tell(&planned, &found);
        if let Some(output) = &self.output {
            let text = std::fs::read_to_string(&self.machine)
                .with_context(|| format!("machine file {}", self.machine.display()))?;
            let text = rewrite_arms(&text, machine.motion.kinematics.name(), &found.all)
                .with_context(|| format!("machine file {}", self.machine.display()))?;
            MachineFile::parse(&output.display().to_string(), &text)
                .context("what was found makes no machine file, and none is written")?;
            std::fs::write(output, text).with_context(|| format!("cannot write {}", output.display()))?;
            outln!("{}", output.display());
        }
        match (self.within, found.before_mm) {
            (Some(within), [largest, _]) if largest > within => {
                errln!("seamwright: the tip was up to {largest:.4} mm off, and may be {within}");
                Ok(ExitCode::from(OUTSIDE))
            }
            _ => Ok(ExitCode::SUCCESS),
        }
    }

    fn plan(&self, machine: &MachineFile) -> anyhow::Result<PlannedPivots> {
        let at_mm = match self.at[..] {
            [] => None,
            [x, y, z] if self.at.iter().all(|place| place.is_finite()) => Some([x, y, z]),
            _ => bail!("--at: give three numbers, X,Y,Z, in mm"),
        };
        let planner = Planner::build(machine).with_context(|| self.machine.display().to_string())?;
        let test = PivotTest {
            at_mm,
            swing_deg: self.swing,
            clear_mm: self.clear,
            dwell_s: self.dwell,
        };
        test.plan(machine, &planner)
            .map_err(|error| anyhow!(error).context("the machine cannot turn its tool about that place"))
    }

    /// On the boards; an exit code where the job ended before, or where nothing was seen.
    fn test(
        &self,
        machine: &MachineFile,
        planned: &PlannedPivots,
    ) -> anyhow::Result<Result<Vec<SeenTip>, ExitCode>> {
        self.boards.check(machine)?;
        let work = Work::Program(&planned.program);
        let of = (machine, &*self.machine);
        let job = self.boards.bare_job(of, work, "test of the pivots".to_owned());
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(Err(code)),
        };
        if ended.error.is_some() {
            return exit_code(ended.error).map(Err);
        }
        let geometry = self.boards.truth(machine)?.geometry(&machine.motion)?;
        Ok(planned.seen(&geometry, &ended.record)?.ok_or_else(|| {
            tell_stands(planned);
            ExitCode::SUCCESS
        }))
    }

    fn tell(&self, planned: &PlannedPivots, found: &Arms) {
        let [[largest, rms], [left, left_rms]] = [found.before_mm, found.left_mm];
        let [x, y, z] = planned.at_mm;
        outln!(
            "pivots of {}: {} attitudes with the tip at {x:.1}, {y:.1} and {z:.1} mm{}",
            self.machine.display(),
            planned.stands.len(),
            match planned.left_out {
                0 => String::new(),
                out => format!(" ({out} are out of reach)"),
            }
        );
        outln!("  tip from its mean place  {largest:.4} mm at most, {rms:.4} rms");
        for arm in &found.all {
            let known = match arm.uncertainty_mm {
                Some(uncertainty) => format!("± {uncertainty:.4}"),
                None => "only together with others".to_owned(),
            };
            // A length of -0.00001 mm is no negative one.
            let found = (arm.found_mm * 1e4).round() / 1e4 + 0.0;
            outln!(
                "  {:<22} {found:>11.4} mm, was {:.4}   {known}",
                arm.name(),
                arm.before_mm
            );
        }
        outln!("  left with these          {left:.4} mm at most, {left_rms:.4} rms");
    }
}

/// What is to be done on a machine that has no truth.
fn tell_stands(planned: &PlannedPivots) {
    outln!(
        "The tool has rested in {} attitudes. This machine does not know where its tip truly was: write down by how much it was beside its place at each rest, in the \
         frame of the work and in this order, and read it with --measured FILE and the same --at, --swing and --clear:",
        planned.stands.len()
    );
    outln!("{}", COLUMNS.join(","));
}

/// The table that was measured.
fn read(file: &Path, planned: &PlannedPivots) -> anyhow::Result<Vec<SeenTip>> {
    let path = file.display().to_string();
    let text = table::read(file)?;
    let rows = table::cells(&path, &text, &COLUMNS)?;
    if rows.len() != planned.stands.len() {
        bail!(
            "{path} has {} rows, and the test has {} attitudes: give the same --at, --swing and --clear, and a row for each rest",
            rows.len(),
            planned.stands.len()
        );
    }
    let seen = rows
        .into_iter()
        .zip(&planned.stands)
        .map(|((line, cells), axes)| {
            let beside = table::numbers(&path, line, COLUMNS, &cells)?;
            Ok(SeenTip {
                axes: *axes,
                beside_mm: beside,
            })
        });
    seen.collect()
}
