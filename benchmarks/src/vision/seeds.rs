//! Work that is shared among the cores, with its progress printed.

use anyhow::Result;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two words about how far it is.
const WORD: Duration = Duration::from_secs(15);

/// Seeds, and what was made of them.
type Made<T> = Vec<(u64, Vec<T>)>;

/// What `task` makes of the seeds below `count`, in their order; progress is printed as "seams: 12 of 200".
pub(super) fn of_seeds<T: Send>(
    what: &str,
    count: u64,
    task: impl Fn(u64) -> Result<Vec<T>> + Sync,
) -> Result<Vec<T>> {
    let (next, done) = (AtomicU64::new(0), AtomicU64::new(0));
    let told = Mutex::new(Instant::now());
    let worker = || {
        let mut all = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= count {
                return Ok(all);
            }
            all.push((seed, task(seed)?));
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Ok(mut told) = told.try_lock()
                && told.elapsed() >= WORD
            {
                eprintln!("{what}: {done} of {count}");
                *told = Instant::now();
            }
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let results: Vec<Result<Made<T>>> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(worker)).collect();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined
            .map(|result| result.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    let mut all: Made<T> = Vec::new();
    for result in results {
        all.extend(result?);
    }
    all.sort_by_key(|(seed, _)| *seed);
    Ok(all.into_iter().flat_map(|(_, made)| made).collect())
}
