//! A program after reading: motions from rest to rest, as their words say them.

use shared::geometry::Turn;
use shared::io::{AXES, SIDES};
use shared::protocol::PathAction;

/// What an NC program does.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Paths in their order; the first one leads from wherever the machine stands.
    pub paths: Vec<ProgramPath>,
}

/// One path, which starts where the last one ended.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramPath {
    /// The machine stands for this long before it \[s\] (G4).
    pub dwell_before_s: f64,
    /// Rapid or feed.
    pub motion: Motion,
    /// Where it leads, at least one place; a rapid leads to one.
    pub targets: Vec<Target>,
    /// Feeds on the way, the first one from the first target on; none of a rapid.
    pub feeds: Vec<ProgramFeed>,
    /// What happens on the way, in the order of the program.
    pub events: Vec<ProgramEvent>,
}

/// How fast.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// G0: as fast as the axes allow.
    Rapid,
    /// G1, G2, G3: with the speed of the tip that F says.
    Feed,
}

/// The motion of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// On which way.
    pub way: Way,
    /// Where to.
    pub words: Words,
    /// Line of the program.
    pub line: u32,
}

/// The way to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// G0, G1: of the tip; straight, or on the smooth curve of its path.
    Line,
    /// G2, G3: of the tip, on an arc about Z.
    Arc(Turn, ArcForm),
    /// G53 G0: of the axes, straight in axis space.
    Axes,
}

/// What makes an arc of its two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcForm {
    /// I J: from the start to the centre \[mm\].
    Centre([f64; 2]),
    /// R \[mm\]: the shorter arc of this radius, the longer one if it is negative.
    Radius(f64),
}

/// The words of a block that say where to (mm, degrees); what is not said stays as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Words {
    /// X Y Z of the tip in the frame of the work, and A B C of the machine; with G53 all of them of the machine.
    pub axes: [Option<f64>; AXES],
    /// V1 V2: extension that keeps the defocus.
    pub extension: [Option<f64>; SIDES],
}

/// The feed from a motion on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgramFeed {
    /// Index of the target whose motion it starts with.
    pub with_target: usize,
    /// Speed of the tip \[mm/min\].
    pub mm_min: f64,
}

/// Something that happens at the start of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgramEvent {
    /// Index of the target whose motion it starts with.
    pub with_target: usize,
    /// What happens.
    pub action: PathAction,
    /// Line of the program.
    pub line: u32,
}
