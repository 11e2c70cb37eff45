//! Work that is shared among the processor's cores.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// What `task` makes of 0 to `count` − 1, in that order.
pub(super) fn in_parallel<T: Send>(count: usize, task: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count {
                return done;
            }
            done.push((k, task(k)));
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(count);
    let mut all: Vec<(usize, T)> = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(worker)).collect();
        let mut all = worker();
        for other in others {
            match other.join() {
                Ok(done) => all.extend(done),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        all
    });
    all.sort_by_key(|(k, _)| *k);
    all.into_iter().map(|(_, made)| made).collect()
}

#[cfg(test)]
mod tests {
    use super::in_parallel;

    #[test]
    fn results_are_in_order() {
        assert_eq!(
            in_parallel(100, |k| k * k),
            (0..100).map(|k| k * k).collect::<Vec<_>>()
        );
        assert!(in_parallel(0, |k| k).is_empty());
    }
}
