//! `seamwright circle`: a circular test after ISO 230-4.

use super::OUTSIDE;
use super::boards::{BoardArgs, exit_code};
use super::weld::speed;
use crate::console::{errln, outln};
use crate::terminal::Operator;
use anyhow::{Context, anyhow};
use cam::path::Planner;
use clap::{Args, ValueEnum};
use commission::{REVERSALS_DEG, TurnFigures, bidirectional_mm};
use config::machine::MachineFile;
use emulator::MACHINE_VARIABLE;
use job::{CircularTest, NoCircle, Plane, SeenCircle, Work};
use report::write_circle;
use std::path::PathBuf;
use std::process::ExitCode;

/// Circular test (ISO 230-4): a circle in both directions, and what the machine makes of it
///
/// The machine homes and goes round twice, with the beams off, where there is room nearest to its reference marks. Without a
/// truth of their own, real machines are seen by their gratings. Everything must be free to move.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code: 0 if the tool was never further from the circle than --within says, 3 if it was, 1 if there is no room \
    or something failed, 130 after Ctrl-C, SIGTERM or SIGHUP."
)]
pub struct Circle {
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: PathBuf,
    /// Axes that make the circle
    #[arg(long, value_enum, default_value_t = PlaneArg::Xy, ignore_case = true)]
    plane: PlaneArg,
    /// Radius [mm]
    #[arg(long, value_name = "MM", value_parser = positive, default_value_t = 100.0, allow_negative_numbers = true)]
    radius: f64,
    /// Speed [m/min]
    #[arg(long, value_name = "M_PER_MIN", value_parser = speed, default_value_t = 9.0, allow_negative_numbers = true)]
    speed: f64,
    /// Farthest that the tool may be from the circle [mm; default: nothing is judged]
    #[arg(long, value_name = "MM", value_parser = positive, allow_negative_numbers = true)]
    within: Option<f64>,
    #[command(flatten)]
    boards: BoardArgs,
    /// Plot (SVG) [default: none is drawn]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Two axes, in the order in which a circle goes from one to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PlaneArg {
    Xy,
    Zx,
    Yz,
}

impl From<PlaneArg> for Plane {
    fn from(plane: PlaneArg) -> Self {
        match plane {
            PlaneArg::Xy => Self::Xy,
            PlaneArg::Zx => Self::Zx,
            PlaneArg::Yz => Self::Yz,
        }
    }
}

/// A length that makes sense.
fn positive(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(length) if f64::is_finite(length) && length > 0.0 => Ok(length),
        _ => Err("must be a number of mm above 0"),
    }
}

/// What a machine cannot make, with what to choose instead.
fn refused(error: NoCircle) -> anyhow::Error {
    match error {
        NoCircle::NoAxis(_) => anyhow!("{error}: choose another --plane"),
        NoCircle::NoRoom { .. } => anyhow!("{error}: choose a smaller --radius"),
        NoCircle::Program(_) | NoCircle::Path(_) => {
            anyhow!(error).context("the machine cannot make this circle; try another --plane or --radius")
        }
    }
}

impl Circle {
    /// Goes round, prints the figures and draws the plot.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let test = CircularTest {
            plane: self.plane.into(),
            radius_mm: self.radius,
            speed_m_per_min: self.speed,
        };
        let circle = test.plan(&machine, &planner).map_err(refused)?;
        let work = Work::Program(&circle.program);
        let of = (&machine, &*self.machine);
        let job = self.boards.bare_job(of, work, "circular test".to_owned());
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        if ended.error.is_some() {
            return exit_code(ended.error);
        }
        let geometry = self.boards.truth(&machine)?.geometry(&machine.motion)?;
        self.judge(test, &circle.seen(&geometry, &ended.record)?)
    }

    fn judge(&self, test: CircularTest, seen: &SeenCircle) -> anyhow::Result<ExitCode> {
        let [there, back] = &seen.figures;
        let title = format!("{test}: {}", self.machine.display());
        outln!("{title}");
        tell(test.plane, "G3", there);
        tell(test.plane, "G2", back);
        outln!(
            "  both directions, circular deviation G(b)  {:.4} mm",
            bidirectional_mm(&seen.turns)
        );
        if let Some(output) = &self.output {
            write_circle(output, &title, &seen.turns)?;
            outln!("{}", output.display());
        }
        let most = there.contour_mm.max(back.contour_mm);
        match self.within {
            Some(within) if most > within => {
                errln!("seamwright: the tool was {most:.4} mm from the circle, and may be {within} mm");
                Ok(ExitCode::from(OUTSIDE))
            }
            _ => Ok(ExitCode::SUCCESS),
        }
    }
}

fn tell(plane: Plane, direction: &str, figures: &TurnFigures) {
    outln!(
        "  {direction}: from the circle {:.4} mm, circular deviation G {:.4} mm, mean radius {:+.4} mm",
        figures.contour_mm,
        figures.circular_mm,
        figures.radius_mm
    );
    // At 0° and 180° the first axis turns round.
    let names = plane.names();
    let spikes: Vec<_> = REVERSALS_DEG
        .iter()
        .zip(figures.spikes_mm)
        .enumerate()
        .map(|(k, (at, spike))| format!("{} at {at:.0}° {spike:+.4}", names[k % 2]))
        .collect();
    outln!("      reversals of {} mm", spikes.join(", "));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_positive_numbers() {
        assert_eq!(positive("7.5"), Ok(7.5));
        for wrong in ["0", "-1", "long", "NaN", "inf"] {
            assert!(positive(wrong).is_err(), "{wrong}");
        }
    }
}
