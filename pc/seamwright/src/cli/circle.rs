//! `seamwright circle`: a circular test after ISO 230-4.

use super::OUTSIDE;
use super::boards::{BoardArgs, exit_code};
use super::weld::speed;
use crate::console::{errln, outln};
use crate::terminal::Operator;
use anyhow::{Context, bail};
use cam::path::Planner;
use clap::{Args, ValueEnum};
use commission::{REVERSALS_DEG, Turn, TurnFigures, bidirectional_mm};
use config::machine::MachineFile;
use emulator::MACHINE_VARIABLE;
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use job::Work;
use nc::{Options, interpret};
use report::{Ended, write_circle};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Room between the circle and the ends of travel \[mm\].
const ROOM_MM: f64 = 5.0;
/// A tool further from the circle than this is on its way to it \[mm\].
const ON_CIRCLE_MM: f64 = 1.0;
/// Part of a turn before the one that is judged, in which the speed is reached \[turns\].
const RUN_IN: f64 = 0.25;

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
    #[arg(long, value_enum, default_value_t = Plane::Xy, ignore_case = true)]
    plane: Plane,
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
enum Plane {
    Xy,
    Zx,
    Yz,
}

/// A length that makes sense.
fn positive(text: &str) -> Result<f64, &'static str> {
    match text.parse() {
        Ok(length) if f64::is_finite(length) && length > 0.0 => Ok(length),
        _ => Err("must be a number of mm above 0"),
    }
}

impl Plane {
    /// Indices of the axes.
    fn axes(self) -> [usize; 2] {
        match self {
            Self::Xy => [0, 1],
            Self::Zx => [2, 0],
            Self::Yz => [1, 2],
        }
    }

    /// Their names.
    fn names(self) -> [&'static str; 2] {
        self.axes().map(|axis| ["X", "Y", "Z"][axis])
    }

    /// Words of NC that select it, and that lead from the start of an arc to its centre along the first axis.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Xy => ["G17", "I"],
            Self::Zx => ["G18", "K"],
            Self::Yz => ["G19", "J"],
        }
    }
}

impl Circle {
    /// Goes round, prints the figures and draws the plot.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let planner = Planner::build(&machine).with_context(|| self.machine.display().to_string())?;
        let centre = self.centre(&machine, &planner)?;
        let text = self.program(centre);
        let options = Options {
            setup: Arc::new(planner.setup(&machine.homed_axes())),
            ..Options::default()
        };
        let refused = || "the machine cannot make this circle; try another --plane or --radius";
        let program = interpret(&text, options).with_context(refused)?;
        planner
            .program(&program, &machine.homed_axes(), None)
            .with_context(refused)?;
        let work = Work::Program(&program);
        let of = (&machine, &*self.machine);
        let job = self.boards.bare_job(of, work, "circular test".to_owned());
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        if ended.error.is_some() {
            return exit_code(ended.error);
        }
        let geometry = MachineGeometry::build(&machine.motion)?;
        let turns = [false, true].map(|backwards| self.turn(&geometry, &ended, centre, backwards));
        self.judge(&turns)
    }

    /// Of the circle: the tip, by X, Y, Z \[mm\], nearest to where it is at the reference marks.
    fn centre(&self, machine: &MachineFile, planner: &Planner) -> anyhow::Result<[f64; 3]> {
        let mut axes = machine.homed_axes();
        for (axis, name) in self.plane.axes().into_iter().zip(self.plane.names()) {
            let Some(limits) = &machine.motion.axes[axis] else {
                bail!("the machine has no axis {name}: choose another --plane");
            };
            let room = self.radius + ROOM_MM;
            let (least, most) = (limits.travel_min + room, limits.travel_max - room);
            if least > most {
                bail!(
                    "a circle of {} mm does not fit into the travel of {name}, {} to {} mm: choose a smaller --radius",
                    self.radius,
                    limits.travel_min,
                    limits.travel_max
                );
            }
            axes[axis] = axes[axis].clamp(least, most);
        }
        Ok(planner.tip(&axes).position_mm)
    }

    /// To the circle, one and a half turns there, and as many back.
    fn program(&self, centre: [f64; 3]) -> String {
        let ([first, _], [plane, to_centre]) = (self.plane.axes(), self.plane.words());
        let at = |side: f64| {
            let mut place = centre;
            place[first] += side * self.radius;
            format!("X{:.6} Y{:.6} Z{:.6}", place[0], place[1], place[2])
        };
        let (start, end, radius) = (at(1.0), at(-1.0), self.radius);
        let feed = self.speed * 1000.0;
        format!(
            "G21 G90 G94 {plane}\nG0 {start}\nF{feed}\nG3 {end} {to_centre}{:.6} P2\nG4 P0.2\nG2 {start} {to_centre}{:.6} P2\nM2\n",
            -radius, radius
        )
    }

    /// The whole turn behind the run-in of one direction.
    fn turn(&self, geometry: &MachineGeometry, ended: &Ended, centre: [f64; 3], backwards: bool) -> Turn {
        let [first, second] = self.plane.axes();
        let mut turn = Turn {
            radius_mm: self.radius,
            backwards,
            places: Vec::new(),
        };
        let (mut before, mut turned) = (None::<[f64; 2]>, 0.0_f64);
        for sample in ended
            .record
            .motion()
            .iter()
            .filter(|sample| sample.state.on_path())
        {
            let tip = geometry.pose(&MachinePosition::of(&sample)).position;
            let place = [tip[first] - centre[first], tip[second] - centre[second]];
            if (place[0].hypot(place[1]) - self.radius).abs() > ON_CIRCLE_MM {
                (before, turned) = (None, 0.0);
                continue;
            }
            let step = before.map_or(0.0, |[x, y]: [f64; 2]| {
                (x * place[1] - y * place[0]).atan2(x * place[0] + y * place[1]) / std::f64::consts::TAU
            });
            before = Some(place);
            // The other direction counts for nothing.
            turned = (turned + if backwards { -step } else { step }).max(0.0);
            if turned > 1.0 + RUN_IN {
                break;
            }
            if turned >= RUN_IN {
                turn.places.push(place);
            }
        }
        turn
    }

    fn judge(&self, turns: &[Turn; 2]) -> anyhow::Result<ExitCode> {
        let figures = turns.each_ref().map(Turn::figures);
        let [Some(there), Some(back)] = figures else {
            bail!(
                "no whole turn was seen within {ON_CIRCLE_MM} mm of the circle: a loop swings (commission it), or telemetry is missing (repeat it)"
            );
        };
        let title = format!(
            "circle of {} mm in {}{} at {:.2} m/min: {}",
            self.radius,
            self.plane.names()[0],
            self.plane.names()[1],
            self.speed,
            self.machine.display()
        );
        outln!("{title}");
        self.tell("G3", &there);
        self.tell("G2", &back);
        outln!(
            "  both directions, circular deviation G(b)  {:.4} mm",
            bidirectional_mm(turns)
        );
        if let Some(output) = &self.output {
            write_circle(output, &title, turns)?;
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

    fn tell(&self, direction: &str, figures: &TurnFigures) {
        outln!(
            "  {direction}: from the circle {:.4} mm, circular deviation G {:.4} mm, mean radius {:+.4} mm",
            figures.contour_mm,
            figures.circular_mm,
            figures.radius_mm
        );
        // At 0° and 180° the first axis turns round.
        let names = self.plane.names();
        let spikes: Vec<_> = REVERSALS_DEG
            .iter()
            .zip(figures.spikes_mm)
            .enumerate()
            .map(|(k, (at, spike))| format!("{} at {at:.0}° {spike:+.4}", names[k % 2]))
            .collect();
        outln!("      reversals of {} mm", spikes.join(", "));
    }
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
