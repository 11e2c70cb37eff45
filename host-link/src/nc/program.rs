//! A program after reading: paths of the tip from rest to rest.

use shared::protocol::PathAction;

/// What an NC program does.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Paths in their order; the first one is a rapid and leads from wherever the machine stands.
    pub paths: Vec<ProgramPath>,
}

/// One path from rest to rest. It starts where the last one ended.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramPath {
    /// The machine stands for this long before it \[s\] (G4).
    pub dwell_before_s: f64,
    /// Rapid or feed.
    pub motion: Motion,
    /// Where it leads, at least one place; several are points of one smooth curve.
    pub targets: Vec<Target>,
    /// What happens on the way, in the order of the program.
    pub events: Vec<ProgramEvent>,
}

/// How fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// G0: as fast as the axes allow, in a straight line of the tip.
    Rapid,
    /// G1 with the speed of the tip \[mm/min\].
    Feed(f64),
}

/// A programmed place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The place.
    pub tip: Tip,
    /// Line of the program.
    pub line: u32,
}

/// Tip, head and V slides in program coordinates, which are world coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tip {
    /// X Y Z of the virtual tip D \[mm\].
    pub position_mm: [f64; 3],
    /// A B C of the head \[deg\].
    pub angles_deg: [f64; 3],
    /// Extension of V1 and V2 that keeps the defocus \[mm\].
    pub extension_mm: [f64; 2],
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
