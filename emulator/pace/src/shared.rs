//! Shared memory of the plugins of both boards and the program on the PC: how far each of them has come.

use std::fs::OpenOptions;
use std::io;
use std::os::fd::AsRawFd;
use std::path::Path;
use std::sync::atomic::{AtomicI64, Ordering};

/// Length of the shared file.
const LENGTH: usize = 4096;

/// The page; all zero before the first board starts.
#[derive(Default)]
#[repr(C)]
struct Page {
    /// Wall time at which the common time was zero \[ns\]; zero before the first board starts.
    epoch: AtomicI64,
    boards: [Progress; 2],
    /// The program on the PC; it writes the file.
    pc: Progress,
}

/// How far one of them has come.
#[derive(Default)]
#[repr(C)]
struct Progress {
    /// Common time it has reached, for the PC: up to which it has handled everything \[ns\].
    reached: AtomicI64,
    /// Wall time of that \[ns\]; zero before it starts and after it has ended.
    seen: AtomicI64,
}

impl Progress {
    /// How far it has come, unless it is not there or has given no sign of life within `patience` ns.
    fn reached(&self, now: i64, patience: i64) -> Option<i64> {
        let seen = self.seen.load(Ordering::Relaxed);
        (seen != 0 && now - seen < patience).then(|| self.reached.load(Ordering::Relaxed))
    }
}

/// One board's view of the page.
pub struct Shared {
    page: &'static Page,
    slot: usize,
}

impl Shared {
    /// A page of its own: the board runs alone.
    pub fn alone() -> Self {
        Self {
            page: Box::leak(Box::default()),
            slot: 0,
        }
    }

    /// Maps the page in `file`.
    pub fn map(file: &Path, slot: usize) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(file)?;
        if file.metadata()?.len() < LENGTH as u64 {
            return Err(io::Error::other(format!("is shorter than {LENGTH} bytes")));
        }
        // SAFETY: a new mapping of a file long enough, never unmapped. Page-aligned, and every access to it, by
        // any process, is atomic; all bit patterns are values.
        let page = unsafe {
            let address = libc::mmap(
                std::ptr::null_mut(),
                LENGTH,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_SHARED,
                file.as_raw_fd(),
                0,
            );
            if address == libc::MAP_FAILED {
                return Err(io::Error::last_os_error());
            }
            &*address.cast::<Page>()
        };
        Ok(Self { page, slot })
    }

    /// The common epoch; the first to ask sets it to `now`.
    pub fn epoch(&self, now: i64) -> i64 {
        match self
            .page
            .epoch
            .compare_exchange(0, now, Ordering::Relaxed, Ordering::Relaxed)
        {
            Ok(_) => now,
            Err(epoch) => epoch,
        }
    }

    /// Moves the common epoch to `epoch`, never back.
    pub fn delay_epoch(&self, epoch: i64) {
        self.page.epoch.fetch_max(epoch, Ordering::Relaxed);
    }

    /// Tells how far this board has come.
    pub fn publish(&self, reached: i64, now: i64) {
        let own = &self.page.boards[self.slot];
        own.reached.store(reached, Ordering::Relaxed);
        own.seen.store(now, Ordering::Relaxed);
    }

    /// How far the other board has come, unless it is not there or has given no sign of life within
    /// `patience` ns.
    pub fn peer(&self, now: i64, patience: i64) -> Option<i64> {
        self.page.boards[1 - self.slot].reached(now, patience)
    }

    /// As [`Self::peer`], for the program on the PC.
    pub fn pc(&self, now: i64, patience: i64) -> Option<i64> {
        self.page.pc.reached(now, patience)
    }
}
