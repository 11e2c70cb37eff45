//! Outputs, spindle, coolant and tool in words.

use crate::program::ProgramAction;
use shared::geometry::Turn;
use shared::protocol::PathAction;

/// What an event does.
pub(super) fn action(action: &ProgramAction) -> String {
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
        ProgramAction::Pause => "the machine waits for the operator".to_owned(),
    }
}
