//! Keeps the boards' time at or behind the wall's, and behind a program on the PC that takes part.
//!
//! The page is that of the emulated boards: an epoch, then (reached, seen) of both boards and of the PC, each a native
//! i64 in nanoseconds.

use crate::time::Time;
use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};
use thiserror::Error;

const BOARDS_AT: u64 = 8;
const PC_AT: u64 = 40;
const LENGTH: u64 = 4096;
/// Boards' time that they may be ahead of what the PC has handled.
const LEAD: Time = Time::ms(3);
/// Wall time without a sign of life after which the PC is not waited for.
const PATIENCE: Duration = Duration::from_secs(1);
/// Delay against the wall that is caught up; more is forgiven.
const LATE: Duration = Duration::from_micros(250);
const BETWEEN_LOOKS: Duration = Duration::from_micros(50);

/// The page cannot be used.
#[derive(Debug, Error)]
#[error("the page of the boards' pace, {}: {source}", path.display())]
pub struct PaceError {
    path: PathBuf,
    source: io::Error,
}

/// The pace of a pair.
#[derive(Debug)]
pub struct Pace {
    path: PathBuf,
    page: File,
    /// Wall time per board time.
    stretch: f64,
    /// Where the wall's clock counts from, and where in it the boards' time is 0, which moves on when they fall behind.
    origin: Instant,
    epoch: Duration,
    /// The boards' time at the first look.
    begin: Option<Time>,
}

impl Pace {
    /// Makes the page at `path`; `rate` is the boards' time per wall time at most.
    pub fn new(path: &Path, rate: f64) -> Result<Self, PaceError> {
        let open = || {
            let page = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(true)
                .open(path)?;
            page.set_len(LENGTH)?;
            Ok(page)
        };
        Ok(Self {
            page: open().map_err(|source| PaceError {
                path: path.to_owned(),
                source,
            })?,
            path: path.to_owned(),
            stretch: 1.0 / rate,
            origin: Instant::now(),
            epoch: Duration::ZERO,
            begin: None,
        })
    }

    /// Tells that both boards have come to `now`, and returns when they may go on.
    pub fn wait(&mut self, now: Time) -> Result<(), PaceError> {
        self.try_wait(now).map_err(|source| PaceError {
            path: self.path.clone(),
            source,
        })
    }

    fn try_wait(&mut self, now: Time) -> io::Result<()> {
        let begin = *self.begin.get_or_insert(now);
        let since_epoch = Duration::from_secs_f64((now - begin).seconds() * self.stretch);
        let late = self.origin.elapsed().saturating_sub(self.epoch + since_epoch);
        if late > LATE {
            self.epoch += late;
        }
        let reached = now.as_ns() as i64;
        loop {
            let wall = self.origin.elapsed();
            let seen = wall.as_nanos() as i64;
            let mut bytes = [0; 32];
            for (place, number) in [reached, seen, reached, seen].into_iter().enumerate() {
                bytes[8 * place..8 * place + 8].copy_from_slice(&number.to_ne_bytes());
            }
            self.page.write_all_at(&bytes, BOARDS_AT)?;
            let due = self.epoch + since_epoch;
            if wall < due {
                thread::sleep(due - wall);
            } else if self.is_ahead_of_pc(reached, seen)? {
                thread::sleep(BETWEEN_LOOKS);
            } else {
                return Ok(());
            }
        }
    }

    fn is_ahead_of_pc(&self, reached: i64, seen: i64) -> io::Result<bool> {
        let mut bytes = [0; 16];
        self.page.read_exact_at(&mut bytes, PC_AT)?;
        let (first, second) = bytes.split_at(8);
        let number = |bytes: &[u8]| bytes.try_into().map(i64::from_ne_bytes).unwrap_or(0);
        let (pc_reached, pc_seen) = (number(first), number(second));
        let alive = pc_seen > 0 && seen - pc_seen <= PATIENCE.as_nanos() as i64;
        Ok(alive && reached - pc_reached > LEAD.as_ns() as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boards_do_not_run_away_from_the_wall_or_from_the_pc() {
        let path = std::env::temp_dir().join(format!("virtual-nucleo-pace-{}", std::process::id()));
        let mut pace = Pace::new(&path, 1.0).expect("a temporary file");
        pace.wait(Time::ms(5)).expect("the page");
        let begin = Instant::now();
        pace.wait(Time::ms(25)).expect("the page");
        assert!(begin.elapsed() >= Duration::from_millis(19));
        let mut bytes = [0; 32];
        pace.page.read_exact_at(&mut bytes, BOARDS_AT).expect("the page");
        assert_eq!(bytes[..8], 25_000_000_i64.to_ne_bytes());
        // A PC that has come to 1 ms only, and is alive.
        let seen = pace.origin.elapsed().as_nanos() as i64;
        assert!(
            !pace.is_ahead_of_pc(25_000_000, seen).expect("the page"),
            "no PC takes part"
        );
        for (number, at) in [(1_000_000_i64, PC_AT), (seen, PC_AT + 8)] {
            pace.page
                .write_all_at(&number.to_ne_bytes(), at)
                .expect("the page");
        }
        assert!(pace.is_ahead_of_pc(25_000_000, seen).expect("the page"));
        assert!(
            !pace
                .is_ahead_of_pc(25_000_000, seen + 2_000_000_000)
                .expect("the page"),
            "it is silent"
        );
        std::fs::remove_file(path).expect("the file");
    }
}
