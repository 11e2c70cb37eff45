//! NC programs: RS274/NGC text in the dialect known from LinuxCNC, in mm, degrees and mm/min.
//!
//! ```text
//! text → lexer → words with their places → parser → blocks → interpreter → Program
//! ```
//!
//! Understood: N words, `/` block delete, `%`, comments `( )` and `;`, G0 G1 G17 G21 G40 G43.4 G49 G54 G61.1
//! G64 G90 G94, F, M2 M30, M62 M63 (P0 P1: beam gates 1 and 2, P2: tracking), M67 (E0 E1: power of the
//! beams in W, Q), X Y Z of the tip, A B C of the head, `V1=` `V2=`: the extension of the V slides that keeps
//! the defocus \[mm\]. All else is an error with its line and column, never skipped.

mod error;
mod interpreter;
mod lexer;
mod parser;
mod program;

pub use error::{NcError, Place, Problem};
pub use interpreter::{Options, interpret};
pub use program::{Motion, Program, ProgramEvent, ProgramPath, Target, Tip};
