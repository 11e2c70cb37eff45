//! `seamwright commission`: sets the position loops of a machine by what its drives answer.

use super::boards::{BoardArgs, exit_code};
use crate::console::outln;
use crate::terminal::Operator;
use anyhow::{Context, bail};
use clap::Args;
use commission::{CapturedMotion, Found, Margins, excitations, measured, rewrite_all, softened, swinging};
use config::machine::MachineFile;
use job::{ExcitationRun, JobError, Work, stopped};
use report::{Ended, prepare, write_motor};
use shared::config::MotionConfig;
use shared::io::{MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use shared::kinematics::AXIS_UNIT;
use std::path::PathBuf;
use std::process::ExitCode;

/// The machine homes. Each motor then goes 20 mm (20°) there and back, nineteen times, while its drive is shaken by up to
/// 1 mm, and is shaken by some counts where it stands; from what its grating tells come gain and delay of the drive, and the highest
/// gains with a gain margin of 6 dB, a phase margin of 45° and a sensitivity of 2 at most, with notches at resonances. It also swings
/// 1 mm (1°) to both sides where it stands, for the feed-forward of its friction. Everything must be free to move.
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
    /// Folder for a plot (SVG) of each motor: its response with its coherence, its open loop before and now [default: none is drawn]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
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
        if let Some(report) = &self.report {
            prepare(report)?;
        }
        let soft = softened(&machine.motion);
        let ended = match self.measure(&machine, soft.clone(), &motors)? {
            Ok(ended) => ended,
            Err(code) => return Ok(code),
        };
        if ended.error.is_some() {
            return exit_code(ended.error);
        }
        let mut captured = ended.taught.captured;
        let again = swinging(&machine.motion, &motors, &captured);
        if !again.is_empty() {
            let names: Vec<_> = again.iter().map(|motor| MOTOR_NAMES[*motor]).collect();
            outln!("measured again, in slower loops: {}", names.join(", "));
            let ended = match self.measure(&machine, softened(&soft), &again)? {
                Ok(ended) => ended,
                Err(code) => return Ok(code),
            };
            match ended.error {
                Some(JobError::Interrupted) => return exit_code(Some(JobError::Interrupted)),
                // What is known of the others is kept.
                Some(error) => outln!("{error}"),
                None => {
                    captured.retain(|captured| !again.contains(&usize::from(captured.excitation.motor)));
                    captured.extend(ended.taught.captured);
                }
            }
        }
        self.write(&machine, &motors, &captured)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Excites `motors` of the `machine` in its `softened` loops, and says of one that tripped why it did.
    fn measure(
        &self,
        machine: &MachineFile,
        softened: MotionConfig,
        motors: &[usize],
    ) -> anyhow::Result<Result<Ended, ExitCode>> {
        let excitations = motors
            .iter()
            .flat_map(|motor| excitations(&machine.motion, *motor))
            .collect();
        let run = ExcitationRun { excitations };
        let softened = MachineFile {
            motion: softened,
            ..machine.clone()
        };
        let of = (&softened, &*self.machine);
        let job = self
            .boards
            .bare_job(of, Work::Excite(&run), "commissioning".to_owned());
        let ended = self.boards.run(&job, Operator::LooksOn, None)?;
        if let Ok(ended) = &ended
            && let Some(error) = &ended.error
            && let Some((motor, why)) = stopped(&machine.motion, error, &ended.record)
        {
            outln!("{}: {why}", MOTOR_NAMES[motor]);
        }
        Ok(ended)
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
        let text = std::fs::read_to_string(&self.machine).with_context(file)?;
        let (mut loops, mut refused) = (Vec::new(), Vec::new());
        for motor in motors {
            let name = MOTOR_NAMES[*motor];
            let before = machine.motion.motors[*motor].as_ref();
            let found = Found::of(&machine.motion, before, *motor, captured);
            if let (Some(report), Some(before)) = (&self.report, before) {
                let plot = report.join(format!("{name}.svg"));
                let title = format!("{name}: {}", self.machine.display());
                let lines = measured(before, *motor, captured).unwrap_or_default();
                write_motor(&plot, &title, &lines, found.as_ref().ok())?;
            }
            match found {
                Ok(found) => {
                    tell(name, machine, *motor, &found);
                    loops.push((*motor, found.of_loop));
                }
                Err(error) => {
                    outln!("{name}: left as it is: {error}");
                    refused.push(name);
                }
            }
        }
        let loops: Vec<_> = loops.iter().map(|(motor, found)| (*motor, found)).collect();
        let text = rewrite_all(&text, &machine.motion, motors, &loops).with_context(file)?;
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

fn tell(
    name: &str,
    machine: &MachineFile,
    index: usize,
    Found {
        of_loop: found,
        friction,
        ..
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
    if let Some(held) = &found.held {
        outln!("    the margins allow more, a machine file does not: {held}");
    }
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
