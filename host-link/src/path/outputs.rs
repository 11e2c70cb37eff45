//! M62, M63 and M67 on the machine that is there.

use super::{PathError, Planner};
use crate::nc::ProgramEvent;
use shared::io::SIDES;
use shared::protocol::{PathAction, PathEvent};

impl Planner {
    /// Beams and tracking must be there, and a beam gives only so much.
    pub(super) fn check_outputs(&self, events: &[ProgramEvent]) -> Result<(), PathError> {
        for event in events {
            let line = event.line;
            let missing = |output: String| PathError::NoOutput {
                line,
                output,
                machine: self.name.clone(),
            };
            let power = |side: u8| {
                let power = self.largest_power[usize::from(side)];
                power.ok_or_else(|| missing(format!("beam {}", side + 1)))
            };
            match event.action {
                PathAction::Beam { side, .. } => {
                    power(side)?;
                }
                PathAction::Power { side, watt } => {
                    let largest = power(side)?;
                    if watt > largest {
                        return Err(PathError::Power {
                            line,
                            side,
                            watt,
                            largest,
                        });
                    }
                }
                PathAction::Tracking { .. } if !self.tracks => {
                    return Err(missing("seam tracking".to_owned()));
                }
                PathAction::Tracking { .. } | PathAction::Speed { .. } => {}
            }
        }
        Ok(())
    }
}

/// What must be switched again where a path is cut before target `first`, because the boards begin every path with
/// everything off.
pub(super) fn carried(events: &[ProgramEvent], first: usize) -> Vec<PathEvent> {
    let (mut powers, mut gates, mut tracks) = ([None; SIDES], [false; SIDES], false);
    for event in events.iter().filter(|event| event.with_target < first) {
        match event.action {
            PathAction::Power { side, watt } => powers[usize::from(side)] = Some(watt),
            PathAction::Beam { side, on } => gates[usize::from(side)] = on,
            PathAction::Tracking { on } => tracks = on,
            // The speed of every block is known by its own.
            PathAction::Speed { .. } => {}
        }
    }
    let mut actions = Vec::new();
    for (side, (power, gate)) in (0..).zip(powers.into_iter().zip(gates)) {
        actions.extend(power.map(|watt| PathAction::Power { side, watt }));
        actions.extend(gate.then_some(PathAction::Beam { side, on: true }));
    }
    actions.extend(tracks.then_some(PathAction::Tracking { on: true }));
    actions
        .into_iter()
        .map(|action| PathEvent { s_mm: 0.0, action })
        .collect()
}
