//! NC programs: RS274/NGC text in the dialect known from LinuxCNC, in mm, degrees and mm/min.
//!
//! ```text
//! text → lexer → words with their places → parser → blocks → interpreter → Program
//! ```
//!
//! What is understood stands in `docs/nc.md`; all else is an error with its line and column, never skipped.
//!
//! Reading knows no machine: which axes, beams and spindle it has, and where words that are not said leave the tip,
//! is the matter of `cam::path`.

mod arc;
mod claims;
mod codes;
mod error;
mod interpreter;
mod lexer;
mod modal;
mod nurbs;
mod outputs;
mod parser;
mod program;
mod reading;
mod source;
#[cfg(test)]
mod tests;
pub mod text;

pub use error::{NcError, Problem, SourcePosition};
pub use interpreter::Options;
pub use program::{
    ArcForm, ArcWay, Blend, ControlPoint, FeedRate, Motion, Move, NurbsWay, PathControl, Plane, Program,
    ProgramAction, ProgramEvent, ProgramPath, Target, Way, Words,
};
pub use reading::{KEPT, RemainingBlocks, interpret, interpret_file};
