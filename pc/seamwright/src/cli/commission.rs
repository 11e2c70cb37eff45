//! `seamwright commission`: sets the position loops of a machine by what its drives answer.

use super::boards::{BoardArgs, exit_code};
use crate::console::outln;
use crate::terminal::Operator;
use anyhow::{Context, bail};
use clap::Args;
use commission::{
    Capture, Loop, Margins, NoFriction, Planned, Requirements, Response, SETTLE_PERIODS, TRAVEL, TURNS_HZ,
    WAY, design, friction, plan, rewrite, turns,
};
use config::machine::MachineFile;
use job::{CapturedMotion, ExcitationRun, Work};
use shared::control::FrictionConfig;
use shared::io::{MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{Excitation, Excited};
use std::path::PathBuf;
use std::process::ExitCode;

/// Part of the acceleration of an axis that an excitation uses.
const OF_ACCELERATION: f64 = 0.5;
/// Part of its proportional gains with which a machine is measured.
const SOFTENED: f64 = 0.25;
/// Part of the skew that trips a gantry.
const OF_SKEW: f64 = 0.5;
/// Part of the speed of an axis that ends one.
const OF_SPEED: f64 = 0.9;

/// The machine homes. Each motor then goes 20 mm (20°) there and back, twelve times, while its drive is shaken by up to
/// 1 mm; from what its grating tells come gain and delay of the drive, and the highest gains with a gain margin of 6 dB, a phase
/// margin of 45° and a sensitivity of 2 at most, with notches at resonances. At last it swings 1 mm (1°) to both sides where it
/// stands, for the feed-forward of its friction. Everything must be free to move.
#[derive(Debug, Args)]
pub struct Commission {
    /// Machine file
    #[arg(long, value_name = "FILE")]
    machine: PathBuf,
    /// Motors [default: all that it has]
    #[arg(long, value_delimiter = ',', value_name = "X1,X2,…")]
    motors: Vec<String>,
    #[command(flatten)]
    boards: BoardArgs,
    /// Machine file with what was found; may be the same, whose old values then stand beside the new ones [default: it is
    /// only told]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Commission {
    /// Measures, designs and writes.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let motors = self.motors(&machine)?;
        if let Some(output) = &self.output {
            // Before anything moves.
            let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
            if folder.is_some_and(|folder| !folder.is_dir()) {
                bail!("cannot write {}: there is no such folder", output.display());
            }
        }
        let excitations = motors
            .iter()
            .flat_map(|motor| excitations(&machine, *motor))
            .collect();
        let run = ExcitationRun { excitations };
        let softened = softened(&machine);
        let of = (&softened, &*self.machine);
        let job = self
            .boards
            .bare_job(of, Work::Excite(&run), "commissioning".to_owned());
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        if ended.error.is_some() {
            return exit_code(ended.error);
        }
        self.write(&machine, &motors, &ended.taught.captured)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Indices of the motors.
    fn motors(&self, machine: &MachineFile) -> anyhow::Result<Vec<usize>> {
        let fitted: Vec<_> = (0..MOTORS)
            .filter(|motor| machine.motion.motors[*motor].is_some())
            .collect();
        if self.motors.is_empty() {
            return Ok(fitted);
        }
        let index = |name: &String| {
            let found = fitted.iter().find(|motor| MOTOR_NAMES[**motor] == name);
            found.copied().with_context(|| {
                let names: Vec<_> = fitted.iter().map(|motor| MOTOR_NAMES[*motor]).collect();
                format!(
                    "--motors: the machine has no motor {name}; it has {}",
                    names.join(", ")
                )
            })
        };
        self.motors.iter().map(index).collect()
    }

    fn write(
        &self,
        machine: &MachineFile,
        motors: &[usize],
        captured: &[CapturedMotion],
    ) -> anyhow::Result<()> {
        let file = || format!("machine file {}", self.machine.display());
        let mut text = std::fs::read_to_string(&self.machine).with_context(file)?;
        let mut refused = Vec::new();
        for motor in motors {
            let name = MOTOR_NAMES[*motor];
            match loop_of(machine, *motor, captured) {
                Ok(found) => {
                    tell(name, machine, *motor, &found);
                    text = rewrite(&text, name, &found.of_loop).with_context(file)?;
                }
                Err(error) => {
                    outln!("{name}: left as it is: {error:#}");
                    refused.push(name);
                }
            }
        }
        if let Some(output) = &self.output {
            MachineFile::parse(&output.display().to_string(), &text)
                .context("what was found makes no machine file, and none is written")?;
            std::fs::write(output, text).with_context(|| format!("cannot write {}", output.display()))?;
            outln!("{}", output.display());
        }
        if !refused.is_empty() {
            bail!("not commissioned: {}", refused.join(", "));
        }
        Ok(())
    }
}

/// The machine with loops that are too slow to ring, whatever its gains are: in a loop that swings by itself nothing is measured.
fn softened(machine: &MachineFile) -> MachineFile {
    let mut softened = machine.clone();
    for motor in softened.motion.motors.iter_mut().flatten() {
        motor.kp *= SOFTENED;
        motor.ki *= SOFTENED * SOFTENED;
        motor.kd = 0.0;
    }
    softened
}

/// What motor `index` is told.
fn excitations(machine: &MachineFile, index: usize) -> Vec<Excitation> {
    let axis = machine.motion.axes[MOTOR_AXIS[index]].as_ref();
    let (speed, acceleration) = axis.map_or((0.0, 0.0), |axis| (axis.max_velocity, axis.max_acceleration));
    // To one side there is half of the travel at least.
    let room = axis.map_or(0.0, |axis| {
        (axis.travel_max - axis.travel_min) / 2.0 - 2.0 * TRAVEL
    });
    let way = WAY.min(room).max(0.0);
    let (speed, acceleration) = (OF_SPEED * speed, OF_ACCELERATION * acceleration);
    let turning = Excitation {
        motor: index as u8,
        excited: Excited::Reference,
        amplitude: turns(speed, acceleration).min(askew(machine, index)),
        from_hz: TURNS_HZ,
        to_hz: TURNS_HZ,
        settle_periods: SETTLE_PERIODS,
        way: 0.0,
        max_travel: TRAVEL,
        max_speed: speed,
    };
    let on_the_way = plan(way, acceleration).into_iter().map(|planned| Excitation {
        excited: Excited::Command,
        amplitude: planned.amplitude,
        from_hz: planned.from_hz,
        to_hz: planned.to_hz,
        way,
        ..turning
    });
    on_the_way.chain([turning]).collect()
}

/// How far motor `index` may go to either side of where it stands alone (mm or °): of a gantry, without tripping its skew.
fn askew(machine: &MachineFile, index: usize) -> f64 {
    match &machine.motion.gantry {
        Some(gantry) if MOTOR_AXIS[index] == MOTOR_AXIS[0] => OF_SKEW * gantry.skew_trip_mm,
        _ => f64::INFINITY,
    }
}

/// What was found of a motor; its friction, or why that stays as it was.
struct Found {
    of_loop: Loop,
    friction: Result<FrictionConfig, NoFriction>,
}

fn loop_of(machine: &MachineFile, index: usize, captured: &[CapturedMotion]) -> anyhow::Result<Found> {
    let motor = machine.motion.motors[index]
        .as_ref()
        .context("the machine has none")?;
    let own = captured
        .iter()
        .filter(|captured| usize::from(captured.excitation.motor) == index);
    let (on_the_way, turning): (Vec<_>, Vec<_>) =
        own.partition(|captured| captured.excitation.excited == Excited::Command);
    let captures: Vec<_> = on_the_way
        .into_iter()
        .map(|captured| Capture {
            planned: Planned {
                from_hz: captured.excitation.from_hz,
                to_hz: captured.excitation.to_hz,
                amplitude: captured.excitation.amplitude,
            },
            way: captured.excitation.way,
            samples: captured.samples.clone(),
        })
        .collect();
    let response = Response::of(&captures, motor)?;
    let mut of_loop = design(&response, motor, &Requirements::default())?;
    let samples = turning.first().map_or(&[][..], |captured| &captured.samples);
    let friction = friction(&response, samples, motor, of_loop.lag.delay_s);
    if let Ok(found) = &friction {
        of_loop.motor.friction = Some(*found);
    }
    Ok(Found { of_loop, friction })
}

fn tell(
    name: &str,
    machine: &MachineFile,
    index: usize,
    Found {
        of_loop: found,
        friction,
    }: &Found,
) {
    let before = machine.motion.motors[index]
        .as_ref()
        .map_or(0.0, |motor| motor.kp);
    outln!(
        "{name}: drive gain {:.4}, delay {:.2} ms",
        found.lag.gain,
        found.lag.delay_s * 1e3
    );
    outln!("    before  kp {before:6.1} 1/s  {}", margins(&found.before));
    outln!(
        "    now     kp {:6.1} 1/s  {}",
        found.motor.kp,
        margins(&found.margins)
    );
    for notch in &found.motor.notches {
        outln!(
            "    notch at {:.1} Hz, damping {}, depth {:.2}",
            notch.frequency_hz,
            notch.damping,
            notch.depth
        );
    }
    match friction {
        Err(error) => outln!("    friction left as it is: {error}"),
        Ok(friction) => {
            let unit = match AXIS_UNIT[MOTOR_AXIS[index]] {
                1.0 => "mm/s",
                _ => "°/s",
            };
            outln!(
                "    friction {:.3} {unit}, turned round at {:.2} {unit}, taken over in {:.1} ms",
                friction.coulomb,
                friction.reversal_speed,
                friction.decay_s * 1e3,
            );
        }
    }
}

fn margins(margins: &Margins) -> String {
    format!(
        "gain margin {:5.1} dB, phase margin {:5.1}°, sensitivity {:4.2}, crossover {:5.1} Hz",
        margins.gain_db, margins.phase_deg, margins.peak, margins.crossover_hz
    )
}
