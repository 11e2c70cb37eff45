//! Outputs, spindle, coolant and tool in words.

use crate::probing::Probe;
use crate::program::ProgramAction;
use crate::waits::Wait;
use shared::geometry::Turn;
use shared::protocol::{Channel, PathAction};

/// What an event does; `welds` are the names of the weld data called so far.
pub(super) fn action(action: &ProgramAction, welds: &[String]) -> String {
    let on_off = |on: bool| if on { "on" } else { "off" };
    match action {
        ProgramAction::Output(PathAction::Beam { side, on }) => {
            format!(
                "gate of beam {} {}",
                side + 1,
                if *on { "opens" } else { "closes" }
            )
        }
        ProgramAction::Output(PathAction::Power { side, watt }) => {
            format!("power of beam {}: {watt} W (of a spindle r/min)", side + 1)
        }
        ProgramAction::Output(PathAction::Tracking { on }) => format!("seam tracking {}", on_off(*on)),
        ProgramAction::Output(PathAction::Output { output, on }) => {
            format!("output {} {}", output + 1, on_off(*on))
        }
        ProgramAction::Output(PathAction::Level { channel, value, .. }) => match channel {
            Channel::Power(side) => format!("power of beam {}: {value} W", side + 1),
            Channel::Analog(output) => format!("analog output {}: {value}", output + 1),
        },
        ProgramAction::Output(PathAction::BySpeed { full_mm_s, .. }) => match full_mm_s * 60.0 {
            0.0 => "the power does not follow the speed".to_owned(),
            mm_min => format!("the power follows the speed, full at {mm_min} mm/min"),
        },
        // No program says it; weld data does.
        ProgramAction::Output(PathAction::AtRest { .. }) => "weld data".to_owned(),
        ProgramAction::WeldOn(index) => {
            let name = welds.get(*index).map_or("", String::as_str);
            format!("a weld begins, with the weld data \"{name}\"")
        }
        ProgramAction::WeldOff => "the weld ends".to_owned(),
        ProgramAction::SpindleSpeed(speed) => format!("speed of the spindle: {speed} r/min"),
        ProgramAction::SpindleOn(Turn::Clockwise) => "spindle turns clockwise".to_owned(),
        ProgramAction::SpindleOn(Turn::CounterClockwise) => "spindle turns counter-clockwise".to_owned(),
        ProgramAction::SpindleOff => "spindle stops".to_owned(),
        ProgramAction::Coolant { mist, flood } => {
            let said = [("mist", mist), ("flood", flood)];
            let said = said
                .into_iter()
                .filter_map(|(name, on)| on.map(|on| format!("{name} {}", on_off(on))));
            said.collect::<Vec<_>>().join(", ")
        }
        ProgramAction::ChangeTool(number) => format!("tool {number} must be in the machine"),
    }
}

/// What ends a motion with the probe.
pub(super) fn probe(probe: &Probe) -> String {
    let Probe {
        input, away, must, ..
    } = probe;
    let what = if *away { "comes free" } else { "touches" };
    let must = if *must { "must" } else { "may" };
    format!(
        "ends where the probe (input {}) {what}, which it {must}",
        input + 1
    )
}

/// What the machine waits for.
pub(super) fn wait(wait: &Wait) -> String {
    let said = wait.text.as_ref().map(|text| format!(": \"{text}\""));
    format!("waits at rest {}{}", wait.until, said.unwrap_or_default())
}
