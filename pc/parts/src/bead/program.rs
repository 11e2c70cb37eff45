//! The NC program of a bead: layer upon layer, each one path.

use super::speed::FeedStep;
use super::stations::Station;
use super::{Bead, CLEARANCE};
use crate::PartContext;
use nc::text::{NcText, decimal, words};
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::AXIS_UNIT;

/// A layer, ready to be written.
pub(super) struct Pass {
    pub(super) stations: Vec<Station>,
    /// Feeds on the way; the first one from the start.
    pub(super) feeds: Vec<FeedStep>,
}

/// The axes, standing off by `lift` along the torch, which is vertical while the positioner lies flat.
fn axes(station: &Station, lift: f64, fitted: &[bool; AXES]) -> String {
    let mut people: [f64; AXES] = std::array::from_fn(|i| station.axes[i] / AXIS_UNIT[i]);
    people[2] += lift;
    words(
        (0..AXES)
            .filter(|&i| fitted[i])
            .map(|i| (AXIS_NAMES[i], people[i])),
    )
}

/// The tip in the frame of the part and the rotary axes.
fn tip(station: &Station, fitted: &[bool; AXES]) -> String {
    let value = |i: usize| {
        if i < 3 {
            station.tip[i]
        } else {
            station.axes[i] / AXIS_UNIT[i]
        }
    };
    words(
        (0..AXES)
            .filter(|&i| i < 3 || fitted[i])
            .map(|i| (AXIS_NAMES[i], value(i))),
    )
}

/// Writes the program; `bead` is where the arc burns on the route.
pub(super) fn write(
    part: &Bead,
    passes: &[Pass],
    [start, end]: [f64; 2],
    context: &PartContext,
    notes: &[String],
) -> String {
    let fitted = context.machine.motion.kinematics.fitted();
    let safe = context.machine.planning.safe_height_mm;
    let mut nc = NcText::default();
    nc.line("%");
    nc.comment(context.title);
    nc.comment(&format!("machine {}", context.machine.name));
    for note in notes {
        nc.comment(note);
    }
    nc.comment("X Y Z: tip in the frame of the part [mm], A B C: axes [deg]; after G53 all are axes");
    nc.block("G21 G17 G90 G94 G40 G500 G64");
    nc.block("G43.4");
    for (index, pass) in passes.iter().enumerate() {
        let [first, last] = [0, pass.stations.len() - 1].map(|i| &pass.stations[i]);
        nc.comment(&format!("layer {}", index + 1));
        // Only the first approach comes from afar.
        let lift = if index == 0 { safe - first.tip.z } else { CLEARANCE };
        nc.block(&format!("G53 G0 {}", axes(first, lift, &fitted)));
        nc.block(&format!("G0 {}", tip(first, &fitted)));
        nc.block(&format!("M67 E0 Q{}", decimal(part.power_w, 1)));
        let mut feeds = pass.feeds.iter().peekable();
        for (target, pair) in pass.stations.windows(2).enumerate() {
            // What is switched, is at the start of the motion that leaves the point before.
            let left = pair[0].t;
            if left == start {
                nc.comment("bead");
                nc.block("M62 P0");
            }
            if left == end {
                nc.comment("run-out");
                nc.block("M63 P0");
            }
            let feed = feeds.next_if(|step| step.target == target);
            let feed = feed.map_or_else(String::new, |step| format!(" F{}", decimal(step.mm_min, 1)));
            nc.block(&format!("G1 {}{feed}", tip(&pair[1], &fitted)));
        }
        let up = if index + 1 == passes.len() {
            safe
        } else {
            last.tip.z + CLEARANCE
        };
        nc.block(&format!("G0 Z{}", decimal(up, 5)));
    }
    nc.block("M2");
    nc.line("%");
    nc.finish()
}
