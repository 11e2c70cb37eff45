//! NC programs: RS274/NGC text in the dialect known from LinuxCNC.
//!
//! ```text
//! text → reader (lines, loops, subroutines) → block (words with their values) → interpreter → Program
//! ```
//!
//! What is understood stands in `docs/nc.md`; all else is an error with its line and column, never skipped.
//!
//! Reading knows no machine: which axes, beams and spindle it has, and where words that are not said leave the tip,
//! is the matter of `cam::path`.

mod answers;
mod arc;
mod block;
mod branches;
mod claims;
mod codes;
mod compensation;
mod cycles;
mod direction;
mod effort;
mod error;
mod explain;
mod expression;
mod flow;
mod foreign;
mod frame;
mod grbl;
mod hints;
mod interpreter;
mod laser;
mod levels;
mod line_parts;
mod lookup;
mod mirror;
mod modal;
mod motion;
mod nurbs;
mod offsets;
mod outputs;
mod parameters;
mod pieces;
mod polar;
mod probing;
mod program;
mod reader;
mod reading;
mod saved_modes;
mod scanner;
mod settings;
mod setup;
mod siemens;
mod source;
mod subroutines;
mod tapping;
#[cfg(test)]
mod tests;
pub mod text;
mod tilt;
mod tool_length;
mod waits;

pub use answers::Answer;
pub use error::{NcError, Problem, SourcePosition};
pub use explain::{Told, explain, explain_file};
pub use laser::Laser;
pub use offsets::{CoordinateSystem, SYSTEMS};
pub use probing::{Found, Probe, ProbeInput, Probed};
pub use program::{
    ArcForm, ArcWay, Blend, ControlPoint, FeedRate, Motion, Move, Notice, NurbsWay, PathControl, Plane,
    Program, ProgramAction, ProgramEvent, ProgramPath, Target, Way, Words,
};
pub use reading::{KEPT, RemainingBlocks, interpret, interpret_file};
pub use setup::{Options, Setup, TipAndAxes, Tool};
pub use waits::{InputEvent, Until, Wait};
