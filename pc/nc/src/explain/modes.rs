//! Modes and coordinate systems that a block changes, in words.

use super::before::Before;
use super::words::{coordinates, figure};
use crate::codes::Code;
use crate::interpreter::Interpreter;
use crate::offsets::{CoordinateSystem, Coordinates, NO_SYSTEM};
use crate::program::{Blend, PathControl, Plane};
use shared::geometry::Turn;

/// What is not as it was before, a phrase each; without the mode of motion where the block `moves`.
pub(super) fn changes(before: &Before, after: &Interpreter, moves: bool) -> Vec<String> {
    let mut changes = modal(before, after, moves);
    changes.extend(offsets(before, after));
    match (before.drills, after.modal_drilling.is_some()) {
        (false, true) => changes.push("drills a hole after every motion (MCALL)".to_owned()),
        (true, false) => changes.push("drills no more holes after motions".to_owned()),
        _ => {}
    }
    let [tool, _] = after.tool_numbers;
    if tool != before.tools[0] {
        changes.push(format!("tool {tool} is selected for M6"));
    }
    let length = after.tools.length;
    if length != before.tool_length {
        changes.push(format!(
            "the tip is {} mm beyond that of the machine file",
            figure(length)
        ));
    }
    let beside = after.compensation.left();
    if beside != before.beside {
        changes.push(match beside {
            Some(left) if left > 0.0 => {
                format!("the tip goes {} mm to the left of the contour", figure(left))
            }
            Some(left) => format!("the tip goes {} mm to the right of the contour", figure(-left)),
            None => "the tip goes to programmed places again".to_owned(),
        });
    }
    let speed = after.spindle.speed();
    let of_beam = after.setup.laser.is_some();
    if speed != before.spindle_speed {
        changes.push(match of_beam {
            true => format!("S of the beam from here: {}", figure(speed)),
            false => format!("spindle speed from here: {} r/min", figure(speed)),
        });
    }
    if of_beam && after.spindle.turns() != before.turns {
        let burns = match after.spindle.turns() {
            Some(Turn::Clockwise) => "burns in motions that feed, with the power of S",
            Some(Turn::CounterClockwise) => {
                "burns in motions that feed, with the power of S in proportion to the speed"
            }
            None => "is off",
        };
        changes.push(format!("from here the beam {burns}"));
    }
    for (code, (old, new)) in ["G28", "G30"].iter().zip(before.homes.iter().zip(&after.homes)) {
        if old != new {
            let axes = of_fitted(new, after);
            changes.push(format!("{code} from here leads the axes to {axes}"));
        }
    }
    if after.saved.len() > before.saved {
        changes.push("modes are saved".to_owned());
    }
    changes
}

fn modal(before: &Before, after: &Interpreter, moves: bool) -> Vec<String> {
    let (old, new) = (&before.modal, &after.modal);
    let mut changes = Vec::new();
    let mut change = |changed: bool, text: String| {
        if changed {
            changes.push(text);
        }
    };
    let name = |code: Option<Code>| code.map_or("none until the next code", Code::name);
    change(
        old.motion != new.motion && !moves,
        format!("motion: {}", name(new.motion)),
    );
    let tip = if new.tip {
        "the tip"
    } else {
        "not understood before G43.4"
    };
    change(old.tip != new.tip, format!("X Y Z are {tip}"));
    let letters = if new.vectors {
        "the direction of the tool (G43.5)"
    } else {
        "not understood"
    };
    change(
        old.vectors != new.vectors,
        format!("I J K of straight motions are {letters}"),
    );
    change(
        old.plane != new.plane,
        format!("arcs go about {}", plane(new.plane)),
    );
    change(
        old.control != new.control,
        format!("path: {}", control(&new.control)),
    );
    let unit = if new.inches { "inches (G20)" } else { "mm (G21)" };
    change(old.inches != new.inches, format!("lengths are {unit}"));
    let steps = |on: bool| if on { "steps" } else { "absolute" };
    change(
        old.incremental != new.incremental,
        format!("coordinates are {}", steps(new.incremental)),
    );
    let centres = steps(!new.absolute_centres);
    change(
        old.absolute_centres != new.absolute_centres,
        format!("I J K are {centres}"),
    );
    let level = if new.to_retract_level {
        "their retract level R"
    } else {
        "where they began"
    };
    change(
        old.to_retract_level != new.to_retract_level,
        format!("cycles end at {level}"),
    );
    let mode = if new.inverse_time() {
        "1/F minutes of its block (G93)"
    } else if new.per_revolution() {
        "the way of a revolution of the spindle (G95)"
    } else {
        "a speed (G94)"
    };
    let [was, is] = [old, new].map(|modal| (modal.inverse_time(), modal.per_revolution()));
    change(was != is, format!("F is {mode}"));
    if let Some(feed) = new.feed_mm() {
        let unit = if new.per_revolution() { "mm/r" } else { "mm/min" };
        change(
            old.feed_mm() != Some(feed),
            format!("feed from here: {} {unit}", figure(feed)),
        );
    }
    changes
}

fn plane(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "Z (G17)",
        Plane::Zx => "Y (G18)",
        Plane::Yz => "X (G19)",
    }
}

fn control(control: &PathControl) -> String {
    match control {
        PathControl::ExactPath => "exact (G61)".to_owned(),
        PathControl::ExactStop => "exact, with a stop after every block (G61.1)".to_owned(),
        PathControl::Blend(Blend { tolerance, smoothing }) => {
            let tolerance = tolerance.map(|p| format!(", within {} mm", figure(p)));
            let smoothing = smoothing.map(|q| format!(", short lines smoothed by {} mm at most", figure(q)));
            let [tolerance, smoothing] = [tolerance, smoothing].map(Option::unwrap_or_default);
            format!("at the best speed (G64){tolerance}{smoothing}")
        }
    }
}

fn offsets(before: &Before, after: &Interpreter) -> Vec<String> {
    let (old, new) = (&before.offsets, &after.offsets);
    let mut changes = Vec::new();
    for (index, (was, is)) in old.systems.iter().zip(&new.systems).enumerate() {
        if was != is {
            changes.push(format!("{}: {}", system_name(index), system(is, after)));
        }
    }
    if old.active != new.active {
        let text = system(new.system(), after);
        changes.push(format!("coordinate system {}: {text}", system_name(new.active)));
    }
    if old.frame != new.frame {
        let origin = of_fitted(&new.frame.offset, after);
        let turned = match new.frame.turned_about_z() {
            Some(degrees) => format!("turned by {} deg about Z", figure(degrees)),
            None => {
                let [x, y, z] = new
                    .frame
                    .axes()
                    .map(|[x, y, z]| format!("[{}, {}, {}]", figure(x), figure(y), figure(z)));
                format!("X leads to {x}, Y to {y}, Z to {z}")
            }
        };
        changes.push(format!(
            "frame (TRANS and the like, a tilted plane): origin at {origin}, {turned}"
        ));
    }
    let local = new.local_now();
    if old.local_now() != local {
        changes.push(format!("local offset (G52, G92): {}", of_fitted(&local, after)));
    }
    changes
}

/// Where a coordinate system is.
pub(crate) fn system(system: &CoordinateSystem, after: &Interpreter) -> String {
    let origin = of_fitted(&system.offset, after);
    match system.rotation {
        0.0 => format!("origin at {origin}"),
        turned => format!("origin at {origin}, turned by {} deg about Z", figure(turned)),
    }
}

/// G54 to G59.3 by its index.
pub(crate) fn system_name(index: usize) -> &'static str {
    match index {
        NO_SYSTEM => Code::NoSystem.name(),
        index => Code::System(index as u8 + 1).name(),
    }
}

/// Coordinates of the axes that there are; X Y Z always are.
fn of_fitted(at: &Coordinates, after: &Interpreter) -> String {
    let fitted = after.setup.fitted;
    coordinates(
        &std::array::from_fn(|axis| (axis < 3 || fitted[axis]).then_some(at[axis])),
        false,
    )
}
