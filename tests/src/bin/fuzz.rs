//! Sends both controllers random and mutated messages, and judges what they do; run by `cargo xtask fuzz`.

use anyhow::{Result, bail};
use clap::Parser;
use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use system_tests::fuzz::{self, Session, Tally};

/// A case takes milliseconds; one that takes so long does not end.
const LONGEST: Duration = Duration::from_secs(60);
/// Between two lines of progress.
const PROGRESS: Duration = Duration::from_secs(20);

/// Random and mutated requests and datagrams against both controllers, on simulated boards
#[derive(Parser)]
struct Arguments {
    /// Requests and datagrams in all
    #[arg(long, default_value_t = 1_000_000)]
    count: u64,
    /// Which of 2^64 runs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only this case of it, as a failure names it
    #[arg(long)]
    case: Option<u64>,
    /// Go on after a failure
    #[arg(long)]
    keep_going: bool,
}

fn main() -> Result<()> {
    let Arguments {
        count,
        seed,
        case,
        keep_going,
    } = Arguments::parse();
    println!("seed {seed}: doing the shipped jobs, to begin from");
    let sessions = Session::all();
    fuzz::quiet();
    let current = Arc::new(AtomicU64::new(case.unwrap_or(0)));
    watch(seed, Arc::clone(&current));
    if let Some(case) = case {
        fuzz::run_case(&sessions, seed, case, &mut Tally::default()).map_err(anyhow::Error::msg)?;
        println!("case {case} of seed {seed}: nothing is wrong");
        return Ok(());
    }
    let (began, mut told) = (Instant::now(), Instant::now());
    let (mut all, mut failures, mut first) = (Tally::default(), 0, 0);
    while all.messages() < count {
        let before = all;
        let mut seen = Tally::default();
        let result = fuzz::run(
            &sessions,
            seed,
            first,
            count - before.messages(),
            Duration::MAX,
            |case, tally| {
                current.store(case, Ordering::Relaxed);
                (first, seen) = (case, *tally);
                if told.elapsed() >= PROGRESS {
                    told = Instant::now();
                    println!("{} messages", before.messages() + tally.messages());
                }
            },
        );
        match result {
            Ok(tally) => all.add(&tally),
            Err(failure) => {
                println!("{failure}");
                failures += 1;
                all.add(&seen);
                first += 1;
                if !keep_going {
                    bail!("again by: cargo xtask fuzz --seed {seed} --case {}", failure.case);
                }
            }
        }
    }
    let seconds = began.elapsed().as_secs();
    println!(
        "{} requests, {} of them accepted, {} datagrams and {} of bytes that are no message, over {} s of both boards, \
         in {seconds} s: {failures} failures",
        all.requests,
        all.accepted,
        all.datagrams,
        all.malformed,
        all.ticks / 1000
    );
    if failures > 0 {
        bail!("{failures} failures");
    }
    Ok(())
}

/// Ends the program where a case does not end.
fn watch(seed: u64, current: Arc<AtomicU64>) {
    thread::spawn(move || {
        let (mut last, mut since) = (u64::MAX, Instant::now());
        loop {
            thread::sleep(Duration::from_secs(1));
            let case = current.load(Ordering::Relaxed);
            if case != last {
                (last, since) = (case, Instant::now());
            } else if since.elapsed() > LONGEST {
                println!(
                    "case {case} of seed {seed} does not end: cargo xtask fuzz --seed {seed} --case {case}"
                );
                exit(1);
            }
        }
    });
}
