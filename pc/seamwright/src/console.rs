//! Output of the program: results on standard output, progress and errors on standard error.
//!
//! A reader may leave (`| head -1`), a disk may be full, a terminal may be gone, and the machine moves: nothing here
//! panics, as `println!` does. What standard error does not take is lost. What standard output does not take is an
//! error too, at the end: [`exit`].

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// Most characters of a text of a program that are printed.
const LONGEST_TEXT: usize = 200;

/// The first error of standard output.
static LOST: Mutex<Option<io::Error>> = Mutex::new(None);

/// Writes to standard output.
pub fn write_out(text: Arguments) {
    keep(&LOST, io::stdout().write_fmt(text));
}

/// Writes a line to standard error.
pub fn write_err(text: Arguments) {
    // In one piece, so that lines of other programs stay apart from it. There is nowhere to report that it
    // failed.
    let _ = io::stderr().write_all(format!("{text}\n").as_bytes());
}

/// What the program returns that would return `code`: a failure where standard output did not take everything. A
/// reader who has left has seen what they wanted.
pub fn exit(code: ExitCode) -> ExitCode {
    keep(&LOST, io::stdout().flush());
    let lost = LOST.lock().unwrap_or_else(PoisonError::into_inner).take();
    match lost {
        Some(error) => {
            write_err(format_args!(
                "seamwright: cannot write to standard output: {error}"
            ));
            if code == ExitCode::SUCCESS {
                ExitCode::FAILURE
            } else {
                code
            }
        }
        None => code,
    }
}

/// Text of a program that does nothing to a terminal.
pub fn shown(text: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    let mut shown: String = text.chars().take(LONGEST_TEXT).map(plain).collect();
    if text.chars().nth(LONGEST_TEXT).is_some() {
        shown.push('…');
    }
    shown
}

/// Remembers the first error that matters.
fn keep(lost: &Mutex<Option<io::Error>>, written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        let mut lost = lost.lock().unwrap_or_else(PoisonError::into_inner);
        lost.get_or_insert(error);
    }
}

/// As `print!`, but for an output that takes nothing.
macro_rules! out {
    ($($text:tt)*) => { $crate::console::write_out(format_args!($($text)*)) };
}

/// As `println!`, but for an output that takes nothing.
macro_rules! outln {
    () => { $crate::console::write_out(format_args!("\n")) };
    ($($text:tt)*) => { $crate::console::write_out(format_args!("{}\n", format_args!($($text)*))) };
}

/// As `eprintln!`, but for an output that takes nothing.
macro_rules! errln {
    ($($text:tt)*) => { $crate::console::write_err(format_args!($($text)*)) };
}

pub(crate) use {errln, out, outln};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_counts_and_a_reader_who_has_left_is_none() {
        let lost = Mutex::new(None);
        keep(&lost, Ok(()));
        keep(&lost, Err(ErrorKind::BrokenPipe.into()));
        assert!(lost.lock().unwrap().is_none());
        keep(&lost, Err(ErrorKind::StorageFull.into()));
        keep(&lost, Err(ErrorKind::Other.into()));
        let first = lost.lock().unwrap().as_ref().map(io::Error::kind);
        assert_eq!(first, Some(ErrorKind::StorageFull));
    }

    #[test]
    fn what_is_shown_of_a_line_is_short_and_without_control_characters() {
        assert_eq!(shown("G1\tX1\u{1b}[2J"), "G1 X1 [2J");
        let long = "X".repeat(LONGEST_TEXT + 1);
        assert_eq!(shown(&long), format!("{}…", "X".repeat(LONGEST_TEXT)));
    }
}
