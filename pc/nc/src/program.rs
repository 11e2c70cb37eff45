//! A program after reading: motions from rest to rest, with the values of their words.

use super::answers::Again;
use super::block::Block;
use super::error::SourcePosition;
use super::offsets::{CoordinateSystem, SYSTEMS};
use super::probing::Probe;
use super::reading::RemainingBlocks;
use super::waits::{Until, Wait};
use shared::geometry::Turn;
use shared::io::{AXES, SIDES};
use shared::protocol::PathAction;

/// Letters of the six axis words, in the order of [`shared::io::AXIS_NAMES`].
pub(crate) const AXIS_WORDS: [&str; AXES] = shared::io::AXIS_NAMES;
/// Names of the extensions.
pub(crate) const EXTENSION_WORDS: [&str; SIDES] = ["V1", "V2"];

/// What an NC program does.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Paths in their order; the first one leads from wherever the machine stands.
    pub paths: Vec<ProgramPath>,
    /// Where the tip is when the program begins, if it relies on that (mm, degrees), and where it first does.
    pub assumes: Option<([f64; AXES], SourcePosition)>,
    /// Loops, conditions, subroutines or a probe: lines are not run in their order, or depend on what is found.
    pub branches: bool,
    /// Names of the weld data that it calls, by the numbers of [`ProgramAction::WeldOn`].
    pub welds: Vec<String>,
    /// Where G54 to G59.3 are when it ends.
    pub systems: Box<[CoordinateSystem; SYSTEMS]>,
    /// What a person should know of how it was read, and what it says itself (MSG, DEBUG, PRINT).
    pub notices: Vec<Notice>,
    /// How it is read again, if it asks the machine anything.
    pub(super) again: Option<Box<Again>>,
}

impl Program {
    /// Its waits, in the order of the program.
    pub fn waits(&self) -> impl Iterator<Item = &Wait> {
        self.paths.iter().flat_map(|path| &path.waits_before)
    }

    /// The tool that must be in the machine where the program, which has changed it before, is started at `line`.
    pub fn changed_tool_at(&self, line: u32) -> Option<u32> {
        let before = self.waits().take_while(|wait| wait.place.line < line);
        let tools = before.filter_map(|wait| match wait.until {
            Until::ToolIn(tool) => Some(tool),
            Until::Continued | Until::Input { .. } | Until::Read { .. } => None,
        });
        tools.last()
    }
}

/// A sentence about a program, or of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Where.
    pub place: SourcePosition,
    /// What.
    pub text: String,
}

/// One path, which starts where the last one ended.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramPath {
    /// The machine waits for these before it, one after the other; then it stands.
    pub waits_before: Vec<Wait>,
    /// The machine stands for this long before it \[s\] (G4).
    pub dwell_before_s: f64,
    /// Rapid, feed or none.
    pub motion: Motion,
    /// Where it leads; a rapid leads to one place, a feed to at least one, a stand to none. Of a long path the
    /// first ones.
    pub targets: Vec<Target>,
    /// What happens on the way, in the order of the program.
    pub events: Vec<ProgramEvent>,
    /// An input ends it before its end: a path of one straight motion, or one that has moved nothing.
    pub probe: Option<Probe>,
    /// Neither the feed override nor the speed that an operator wants of welds changes its feed: a thread is tapped.
    pub fixed_feed: bool,
    /// The blocks of a long path that are not in `targets`; they are read again when they are needed.
    pub rest: Option<RemainingBlocks>,
}

/// The motion of one block of a path, with what happens at its start.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Where it leads.
    pub target: Target,
    /// In the order of the program.
    pub events: Vec<ProgramEvent>,
}

/// How fast.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// G0: as fast as the axes allow.
    Rapid,
    /// G1, G2, G3, G5.2, G6.2: with the speed of the tip that F says.
    Feed,
    /// No motion: M3, M4, M5, M64, M65 and M68 before a G4 or the end of the program take effect at rest.
    Stand,
}

/// The motion of one block, or of all blocks of a NURBS.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// On which way.
    pub way: Way,
    /// Where to.
    pub words: Words,
    /// How fast; none of a rapid.
    pub feed: Option<FeedRate>,
    /// How the way there is followed, and how it continues.
    pub control: PathControl,
    /// Where the program says so.
    pub place: SourcePosition,
}

/// F of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FeedRate {
    /// G94: speed of the tip \[mm/min\].
    PerMinute(f64),
    /// G93: the block takes one part in so many of a minute \[1/min\].
    InverseTime(f64),
}

/// How closely the programmed way is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathControl {
    /// G61: exactly; slower, or with a stop, where the machine could not.
    ExactPath,
    /// G61.1: exactly, and with a stop at the end of the block.
    ExactStop,
    /// G64: at the best speed.
    Blend(Blend),
}

/// What G64 says \[mm\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Blend {
    /// P: not further off than this.
    pub tolerance: Option<f64>,
    /// Q: runs of short lines are smoothed so far off them at most, and not at all if it is 0; as far as the tolerance
    /// allows where it is not said.
    pub smoothing: Option<f64>,
}

impl Blend {
    /// How far off the tip may be where no P says it \[mm\].
    pub const DEFAULT_TOLERANCE_MM: f64 = 0.05;
}

impl Default for PathControl {
    fn default() -> Self {
        Self::Blend(Blend::default())
    }
}

/// The way to a target.
#[derive(Clone, Debug, PartialEq)]
pub enum Way {
    /// G0, G1: of the tip; straight, or on the smooth curve of its path.
    Line,
    /// G2, G3: of the tip, on an arc or helix.
    Arc(ArcWay),
    /// G5.2, G6.2: of the tip, on a NURBS curve.
    Nurbs(Box<NurbsWay>),
    /// G53 G0: of the axes, straight in axis space.
    Axes,
    /// The tip stands for so long, as part of the path \[s\]: a beam may burn meanwhile. No program says it; weld data does.
    Wait(f64),
}

/// What makes an arc of its two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcWay {
    /// Axis that it goes about, of length 1; that of a plane where it is along one.
    pub about: [f64; 3],
    /// Seen from the end of the axis.
    pub turn: Turn,
    /// Centre or radius.
    pub form: ArcForm,
    /// Full turns beyond the first one (P less one).
    pub more_turns: u32,
}

/// Plane of arcs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Plane {
    /// G17: X to Y about Z.
    #[default]
    Xy,
    /// G18: Z to X about Y.
    Zx,
    /// G19: Y to Z about X.
    Yz,
}

impl ArcWay {
    /// The plane of X, Y and Z that it goes in, if it is one of these.
    pub fn plane(&self) -> Option<Plane> {
        let planes = [Plane::Xy, Plane::Zx, Plane::Yz];
        planes.into_iter().find(|plane| plane.normal() == self.about)
    }
}

impl Plane {
    /// The axis that arcs go about, of length 1.
    pub fn normal(self) -> [f64; 3] {
        let mut normal = [0.0; 3];
        normal[self.axis()] = 1.0;
        normal
    }

    /// Index of the axis that arcs go about.
    pub fn axis(self) -> usize {
        match self {
            Self::Xy => 2,
            Self::Zx => 1,
            Self::Yz => 0,
        }
    }

    /// Indices of its own axes; a positive turn leads from the first to the second.
    pub(crate) fn axes(self) -> [usize; 2] {
        match self {
            Self::Xy => [0, 1],
            Self::Zx => [2, 0],
            Self::Yz => [1, 2],
        }
    }
}

/// Centre or radius of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcForm {
    /// I J K: from the start to the centre \[mm\].
    Centre([f64; 3]),
    /// R \[mm\]: the shorter arc of this radius, the longer one if it is negative.
    Radius(f64),
}

/// A NURBS curve that begins where the tip stands and ends at its last control point.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsWay {
    /// One more than the degree.
    pub order: usize,
    /// Control points, at least as many as the order. The first is where the tip stands.
    pub points: Vec<ControlPoint>,
    /// As many as control points and order together; as many as the order are equal at both ends.
    pub knots: Vec<f64>,
}

/// One control point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlPoint {
    /// X Y Z \[mm\]; what is not said is as at the point before.
    pub position: [Option<f64>; 3],
    /// Its weight, above zero.
    pub weight: f64,
    /// Where the program says so.
    pub place: SourcePosition,
}

/// The words of a block that say where to (mm, degrees); what is not said stays as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Words {
    /// X Y Z of the tip in the frame of the work, and A B C of the machine; with G53 all of them of the machine.
    pub axes: [Option<f64>; AXES],
    /// V1 V2: extension that keeps the defocus.
    pub extension: [Option<f64>; SIDES],
}

impl Words {
    /// What `block` says of where to, with its numbers as they are written.
    pub(crate) fn of(block: &Block) -> Self {
        let value = |name: &str| block.word(name).map(|word| word.value);
        Self {
            axes: AXIS_WORDS.map(value),
            extension: EXTENSION_WORDS.map(value),
        }
    }
}

/// Something that happens at the start of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgramEvent {
    /// Index of the target whose motion it starts with; 0 in a stand.
    pub with_target: usize,
    /// So far behind the start of that motion \[mm\]; 0 of what a program says itself.
    pub after_mm: f64,
    /// What happens.
    pub action: ProgramAction,
    /// The code that asks for it.
    pub code: &'static str,
    /// Where the program says so.
    pub place: SourcePosition,
}

/// What an event does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ProgramAction {
    /// M62 to M68: an output that the program names.
    Output(PathAction),
    /// S \[r/min\], of the machine's spindle.
    SpindleSpeed(f64),
    /// M3, M4: the spindle turns, seen from its motor to the tool.
    SpindleOn(Turn),
    /// M5: it stops.
    SpindleOff,
    /// M7, M8, M9: mist and flood; none stays as it is.
    Coolant {
        /// M7.
        mist: Option<bool>,
        /// M8.
        flood: Option<bool>,
    },
    /// M6: the tool of this number must be in the machine.
    ChangeTool(u32),
    /// WELDON: a weld begins, with the data of this number in [`Program::welds`].
    WeldOn(usize),
    /// WELDOFF: it ends.
    WeldOff,
}
