//! Keeps emulated boards from running away from the program on the PC that talks with them.
//!
//! The boards' pace plugins share a page; a program that takes part writes into it how far it has come. A
//! board then waits for a program whose processor is busy elsewhere, as it waits for the other board.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::time::Duration;

/// Bytes of the page: epoch, then (reached, seen) of both boards and of the PC, each a native i64.
const BOARDS_AT: u64 = 8;
const PC_AT: u64 = 40;
/// Wall time without a sign of life after which a board is taken to have died \[ns\], as the boards' plugins
/// see it.
const PATIENCE_NS: i64 = 1_000_000_000;

/// A program's part in the pace of the boards; it ends when this is dropped.
#[derive(Debug)]
pub struct Pace {
    page: File,
}

impl Pace {
    /// Takes part in the pace of the boards of [`crate::Session::pace`].
    pub fn join(page: &Path) -> io::Result<Self> {
        Ok(Self {
            page: OpenOptions::new().read(true).write(true).open(page)?,
        })
    }

    /// Everything that the boards have sent so far has been handled.
    pub fn handled(&self) -> io::Result<()> {
        let (least_reached, now) = least_reached(&self.page)?;
        self.write(least_reached, now)
    }

    fn write(&self, reached: i64, seen: i64) -> io::Result<()> {
        self.page.write_all_at(&reached.to_ne_bytes(), PC_AT)?;
        self.page.write_all_at(&seen.to_ne_bytes(), PC_AT + 8)
    }
}

/// How far the slower of the boards that run has come in their common time, and when that was reported last
/// \[ns\].
fn least_reached(page: &File) -> io::Result<(i64, i64)> {
    let mut bytes = [0; 32];
    page.read_exact_at(&mut bytes, BOARDS_AT)?;
    let number = |index: usize| {
        let bytes = bytes[8 * index..8 * index + 8].try_into();
        i64::from_ne_bytes(bytes.expect("eight bytes of 32"))
    };
    let boards = [(number(0), number(1)), (number(2), number(3))];
    let now = boards[0].1.max(boards[1].1);
    // A board that has died is waited for no more.
    let alive = boards.iter().filter(|(_, seen)| now - seen <= PATIENCE_NS);
    let least_reached = alive.map(|(reached, _)| *reached).min();
    Ok((least_reached.unwrap_or(0), now))
}

/// The time of the boards, which goes slower than that of the wall on a busy computer. Looking at it does not take part
/// in their pace.
#[derive(Debug)]
pub struct BoardTime {
    page: File,
}

impl BoardTime {
    /// The time of the boards of [`crate::Session::pace`].
    pub fn of(page: &Path) -> io::Result<Self> {
        Ok(Self {
            page: File::open(page)?,
        })
    }

    /// How far the slower one has come.
    pub fn now(&self) -> io::Result<Duration> {
        let (reached, _) = least_reached(&self.page)?;
        Ok(Duration::from_nanos(reached.try_into().unwrap_or(0)))
    }
}

impl Drop for Pace {
    fn drop(&mut self) {
        // Without it the boards wait once more, for a second.
        let _ = self.write(0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slower_board_is_followed_and_the_end_is_told() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("page");
        let mut page = vec![0; 4096];
        for (place, number) in [7_i64, 100, 1_000, 90, 1_005].into_iter().enumerate() {
            page[8 * place..8 * place + 8].copy_from_slice(&number.to_ne_bytes());
        }
        std::fs::write(&path, &page).expect("a temporary file");
        let pc = || {
            let bytes = std::fs::read(&path).expect("the file");
            [40, 48].map(|at| i64::from_ne_bytes(bytes[at..at + 8].try_into().expect("eight bytes")))
        };
        let pace = Pace::join(&path).expect("the file");
        pace.handled().expect("the file");
        assert_eq!(pc(), [90, 1_005]);
        let time = BoardTime::of(&path).expect("the file");
        assert_eq!(time.now().expect("the file"), Duration::from_nanos(90));
        drop(pace);
        assert_eq!(pc(), [0, 0]);
    }
}
