//! Whether QEMU has served the network of its board.
//!
//! Frames to a board are received by QEMU's main thread, those from it are sent by the thread of its processor. On a
//! busy host, or one whose processors are taken away for a while, the main thread may wait to be run while the
//! processor's thread goes on: by the board's time, frames are then late by as much. This tells that the main thread
//! has been ready to run, or has run, without coming to rest once.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

/// Wall time that the main thread may take for what has arrived \[ns\]. A frame takes some 50 µs; a permit of the beams
/// is valid for 10 ms of the board's time.
const SERVED_WITHIN_NS: i64 = 500_000;
/// Wall time after which a thread that does not rest is not waited for again until it has rested \[ns\].
const PATIENCE_NS: i64 = 1_000_000_000;

/// The thread that serves the network.
pub struct Network {
    /// Its `stat` and `status` in /proc.
    files: Option<[File; 2]>,
    busy: Option<Busy>,
}

/// A thread that was seen ready to run.
#[derive(Clone, Copy)]
struct Busy {
    /// How often it had come to rest.
    rests: u64,
    /// Wall time at which it was first seen \[ns\].
    since: i64,
}

impl Network {
    /// The one that the main thread of this process serves.
    pub fn of_main_thread() -> Self {
        Self::of_thread(std::process::id())
    }

    /// The one that a thread of this process serves. A host that does not tell of its threads is taken to serve all in time.
    fn of_thread(thread: u32) -> Self {
        let open = |name| File::open(format!("/proc/self/task/{thread}/{name}"));
        Self {
            files: open("stat").and_then(|stat| Ok([stat, open("status")?])).ok(),
            busy: None,
        }
    }

    /// Whether frames may have been waiting for too long at `now` \[ns\].
    pub fn is_behind(&mut self, now: i64) -> bool {
        self.busy = self.rests_if_busy().ok().flatten().map(|rests| match self.busy {
            Some(busy) if busy.rests == rests => busy,
            _ => Busy { rests, since: now },
        });
        self.busy
            .is_some_and(|busy| (SERVED_WITHIN_NS..PATIENCE_NS).contains(&(now - busy.since)))
    }

    /// How often the thread has come to rest, if it does not rest now.
    fn rests_if_busy(&self) -> io::Result<Option<u64>> {
        let Some([stat, status]) = &self.files else {
            return Ok(None);
        };
        // Five times as quick to read as `status`, and mostly enough.
        let mut buffer = [0; 4096];
        if !is_ready(read(stat, &mut buffer)?) {
            return Ok(None);
        }
        Ok(rests(read(status, &mut buffer)?))
    }
}

fn read<'a>(file: &File, buffer: &'a mut [u8]) -> io::Result<&'a str> {
    let length = file.read_at(buffer, 0)?;
    str::from_utf8(&buffer[..length]).map_err(io::Error::other)
}

/// Whether a thread runs or waits to be run, by its `stat`: `number (name) state …`, where the name may hold anything.
fn is_ready(stat: &str) -> bool {
    stat.rsplit_once(") ")
        .is_some_and(|(_, state)| state.starts_with('R'))
}

/// How often a thread has given up its processor by itself, by its `status`.
fn rests(status: &str) -> Option<u64> {
    let line = |line: &str| line.strip_prefix("voluntary_ctxt_switches:")?.trim().parse().ok();
    status.lines().find_map(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc::channel;
    use std::thread;

    const LATER: i64 = SERVED_WITHIN_NS;

    #[test]
    fn the_state_is_read_behind_the_name() {
        assert!(is_ready("12 (a) R) S (b) R 1 12 12 0"));
        assert!(!is_ready("12 (R) S 1 12 12 0"));
        assert!(!is_ready(""));
        let status = "State:\tR (running)\nvoluntary_ctxt_switches:\t17\nnonvoluntary_ctxt_switches:\t4\n";
        assert_eq!(rests(status), Some(17));
        assert_eq!(rests("State:\tR (running)\n"), None);
    }

    #[test]
    fn a_thread_is_behind_that_does_not_rest() {
        let over = Arc::new(AtomicBool::new(false));
        let (sender, started) = channel();
        let spins = thread::spawn({
            let over = Arc::clone(&over);
            move || {
                sender.send(gettid()).expect("the test waits");
                while !over.load(Ordering::Relaxed) {}
            }
        });
        let mut network = Network::of_thread(started.recv().expect("it runs"));
        // From its first rest-free look on it is busy; what it did before does not count.
        while network.busy.is_none() {
            network.is_behind(0);
        }
        assert!(!network.is_behind(LATER - 1));
        assert!(network.is_behind(LATER));
        assert!(!network.is_behind(PATIENCE_NS));
        over.store(true, Ordering::Relaxed);
        spins.join().expect("no panic");
        assert!(!network.is_behind(LATER), "it has ended");
    }

    #[test]
    fn a_thread_that_rests_is_not_behind() {
        let (over, wait) = channel::<()>();
        let (sender, started) = channel();
        let rests = thread::spawn(move || {
            sender.send(gettid()).expect("the test waits");
            let _ = wait.recv();
        });
        let mut network = Network::of_thread(started.recv().expect("it runs"));
        while network.rests_if_busy().expect("a thread that runs").is_some() {}
        assert!(!network.is_behind(0));
        assert!(!network.is_behind(LATER));
        drop(over);
        rests.join().expect("no panic");
    }

    fn gettid() -> u32 {
        // SAFETY: no pointer.
        let thread = unsafe { libc::gettid() };
        thread.try_into().expect("a thread's number")
    }
}
