//! `seamwright jog`: moves one axis, the tip or a slide by hand.

use super::boards::{BoardArgs, exit_code};
use crate::terminal::Operator;
use anyhow::bail;
use clap::Args;
use config::machine::MachineFile;
use host_link::spool::Spooling;
use host_link::{Jog, JogWay};
use job::Work;
use shared::io::{AXIS_NAMES, SLIDE_NAMES};
use std::path::PathBuf;
use std::process::ExitCode;

/// Names of the directions of the tool.
const TOOL_NAMES: [&str; 3] = ["T", "B", "N"];

/// The machine homes and jogs: until Ctrl-C, to the end of the travel, or by a step. Then its drives go off. It moves only while this
/// program asks for it every 50 ms: 150 ms after it has stopped asking, whatever the reason, the boards stop it.
#[derive(Debug, Args)]
pub struct JogCommand {
    /// What moves: an axis alone (X … C), the tip along the work (work-X) or the tool (tool-T along travel, tool-B to the left,
    /// tool-N away from the work), the tool about the tip (turn-A), a slide (U1 … V2)
    #[arg(value_name = "WHAT", value_parser = way)]
    way: JogWay,
    /// How fast, and by its sign where to [mm/s or °/s]
    #[arg(value_name = "SPEED", allow_negative_numbers = true)]
    speed: f64,
    /// How far [mm or °] [default: as far as it goes]
    #[arg(long, value_name = "DISTANCE")]
    step: Option<f64>,
    /// Machine file
    #[arg(long, value_name = "FILE")]
    machine: PathBuf,
    #[command(flatten)]
    boards: BoardArgs,
}

impl JogCommand {
    /// Homes and jogs.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        if !(self.speed.is_finite() && self.speed != 0.0) {
            bail!(
                "SPEED: {} is no speed; give mm/s or °/s, negative for the other direction",
                self.speed
            );
        }
        if let Some(step) = self.step
            && !(step.is_finite() && step > 0.0)
        {
            bail!("--step: {step} is no distance; the direction is the sign of SPEED");
        }
        let machine = MachineFile::read(&self.machine)?;
        self.boards.check(&machine)?;
        let mut job = self
            .boards
            .bare_job((&machine, &self.machine), Work::ByHand, "by hand".to_owned());
        job.spooling = Spooling::nothing();
        let operator = Operator::Jogs(Jog::now(self.way, self.speed, self.step));
        match self.boards.run(&job, operator, None)? {
            Ok(ended) => exit_code(ended.error),
            Err(code) => Ok(code),
        }
    }
}

/// What a name stands for.
fn way(name: &str) -> Result<JogWay, String> {
    let (frame, direction) = name.split_once('-').unwrap_or(("", name));
    let of = |names: &[&str]| {
        let index = names.iter().position(|name| name.eq_ignore_ascii_case(direction));
        index.ok_or_else(|| format!("{direction} is none of {}", names.join(", ")))
    };
    match frame {
        "" => of(&AXIS_NAMES).map(JogWay::Axis).or_else(|_| {
            let slide = of(&SLIDE_NAMES).map(JogWay::Slide);
            slide.map_err(|_| format!("{name} is neither an axis (X to C) nor a slide (U1, V1, U2, V2)"))
        }),
        "work" => of(&AXIS_NAMES[..3]).map(JogWay::Work),
        "tool" => of(&TOOL_NAMES).map(JogWay::Tool),
        "turn" => of(&AXIS_NAMES[3..]).map(|axis| JogWay::Turn(3 + axis)),
        _ => Err(format!("{frame} is none of work, tool, turn")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_moves() {
        for (name, expected) in [
            ("X", JogWay::Axis(0)),
            ("c", JogWay::Axis(5)),
            ("v2", JogWay::Slide(3)),
            ("work-Z", JogWay::Work(2)),
            ("tool-n", JogWay::Tool(2)),
            ("turn-A", JogWay::Turn(3)),
        ] {
            assert_eq!(way(name), Ok(expected), "{name}");
        }
        assert_eq!(way("work-A").unwrap_err(), "A is none of X, Y, Z");
        assert_eq!(way("side-X").unwrap_err(), "side is none of work, tool, turn");
        assert!(way("U3").unwrap_err().starts_with("U3 is neither"));
    }
}
