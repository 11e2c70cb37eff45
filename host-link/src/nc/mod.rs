//! NC programs: RS274/NGC text in the dialect known from LinuxCNC, in mm, degrees and mm/min.
//!
//! ```text
//! text → lexer → words with their places → parser → blocks → interpreter → Program
//! ```
//!
//! Understood: N words, `/` block delete, `%`, comments `( )` and `;`, G0 G1 G2 G3 (I J or R), G4 P \[s\], G17 G21
//! G40 G43.4 G49 G53 G54 G61.1 G64 G90 G94, F, M2 M30, M62 M63 (P0 P1: beam gates 1 and 2, P2: tracking), M67
//! (E0 E1: power of the beams in W, Q), X Y Z of the tip in the frame of the work, A B C of the rotary axes,
//! `V1=` `V2=`: the extension of the V slides that keeps the defocus \[mm\]. With G53 G0, X Y Z A B C are the
//! machine's axes, which move in axis space. All else is an error with its line and column, never skipped.
//!
//! Reading knows no machine: which axes it has, and where words that are not said leave the tip, is the matter
//! of [`crate::path`].

mod error;
mod interpreter;
mod lexer;
mod outputs;
mod parser;
mod program;
#[cfg(test)]
mod tests;

pub use error::{NcError, Place, Problem};
pub use interpreter::{Options, interpret};
pub use program::{ArcForm, Motion, Program, ProgramEvent, ProgramFeed, ProgramPath, Target, Way, Words};
