//! Both interpreters over many programs, on all cores.

use crate::compare::{Difference, first_difference};
use crate::ours::Outcome;
use crate::peer::Peer;
use crate::worker::{Answer, Worker};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// Longest time of a program in our interpreter.
const LIMIT: Duration = Duration::from_secs(10);

/// What both say of a program.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Its index.
    pub index: usize,
    pub ours: Judgement,
    pub peer: Judgement,
    /// If both accept it.
    pub difference: Option<Difference>,
    /// Ours panicked, hung or crashed.
    pub broken: bool,
}

impl Pair {
    /// Whether it is understood differently, or not at all.
    pub fn fails(&self) -> bool {
        self.broken || self.difference.is_some()
    }
}

/// What an interpreter says of a program, without what it does.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    Accepted,
    Refused { problem: String, place: String },
}

impl Judgement {
    pub fn accepted(&self) -> bool {
        *self == Self::Accepted
    }

    fn failed(problem: &str) -> Self {
        Self::Refused {
            problem: problem.to_owned(),
            place: String::new(),
        }
    }

    /// Of a program in `folder`, whose name is not told.
    fn of(outcome: &Outcome, folder: &str) -> Self {
        match outcome {
            Outcome::Accepted(_) => Self::Accepted,
            Outcome::Refused { problem, place } => Self::Refused {
                problem: problem.replace(folder, ""),
                place: place.clone(),
            },
        }
    }
}

/// Reads all of `files`; the pairs come in their order. `folder` is for what the peer needs.
pub fn all(files: &[PathBuf], folder: &Path) -> Result<Vec<Pair>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let pairs = Mutex::new(Vec::new());
    // Before any thread starts a program: one that is being written cannot be started, and a process that is just being
    // started holds all files open.
    let peers = (0..cores)
        .map(|core| {
            let folder = folder.join(format!("peer-{core}"));
            std::fs::create_dir_all(&folder)?;
            Peer::new(&folder)
        })
        .collect::<Result<Vec<_>>>()?;
    let work = |peer: &Peer| -> Result<()> {
        let mut worker = Worker::new(LIMIT);
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(file) = files.get(index) else {
                return Ok(());
            };
            let pair = pair(index, file, peer, &mut worker);
            let pair = pair.with_context(|| format!("program {}", file.display()))?;
            if let Ok(mut pairs) = pairs.lock() {
                pairs.push(pair);
            }
        }
    };
    thread::scope(|scope| {
        let threads: Vec<_> = peers.iter().map(|peer| scope.spawn(move || work(peer))).collect();
        threads.into_iter().try_for_each(|thread| {
            thread
                .join()
                .unwrap_or_else(|_| anyhow::bail!("a thread panicked"))
        })
    })?;
    let mut pairs = pairs.into_inner().unwrap_or_default();
    pairs.sort_by_key(|pair: &Pair| pair.index);
    Ok(pairs)
}

fn pair(index: usize, file: &Path, peer: &Peer, worker: &mut Worker) -> Result<Pair> {
    let theirs = peer.read(file)?;
    let ours = worker.read(file)?;
    let difference = match (&ours, &theirs) {
        (Answer::Outcome(Outcome::Accepted(ours)), Some(Outcome::Accepted(theirs))) => {
            first_difference(ours, theirs)
        }
        _ => None,
    };
    let folder = file.parent().unwrap_or(Path::new("")).display().to_string() + "/";
    Ok(Pair {
        index,
        broken: !matches!(ours, Answer::Outcome(_)),
        ours: match &ours {
            Answer::Outcome(outcome) => Judgement::of(outcome, &folder),
            Answer::Panic(said) => Judgement::failed(&format!("PANIC: {said}")),
            Answer::Hang => Judgement::failed("HANG"),
            Answer::Crash => Judgement::failed("CRASH: out of stack or memory"),
        },
        peer: match &theirs {
            Some(outcome) => Judgement::of(outcome, &folder),
            None => Judgement::failed("it took too long"),
        },
        difference,
    })
}
