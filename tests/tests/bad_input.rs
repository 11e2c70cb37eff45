//! A hundred thousand inputs of each kind with something wrong in them: each is read or refused, and those that are
//! read are planned or refused, some of them; nothing panics, nothing takes long or much memory.
//!
//! The same inputs in every run. One that fails is written beside the test's program; it belongs into a test of its own.

use allocation_counter::measure;
use nix::time::{ClockId, clock_gettime};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use system_tests::bad_input::{Kind, Sample, mutated, samples};
use system_tests::fuzz::Random;

/// Inputs of each kind.
const INPUTS: u64 = 100_000;
/// Longest that one may take, of processor time \[s\], so that other work does not matter.
const LONGEST_S: f64 = 2.0;
/// Most memory that one may take \[bytes\].
const MOST_MEMORY: u64 = 500_000_000;
/// One that takes as long as this by the clock on the wall will not come back.
const HANGS: Duration = Duration::from_secs(100);
/// Longest that a refusal may be \[characters\].
const LONGEST_ERROR: usize = 2000;

/// What became of the inputs.
#[derive(Debug, Default)]
struct Tally {
    refused: u64,
    read: u64,
    planned: u64,
    plan_refused: u64,
    longest_s: f64,
    most_memory: u64,
}

/// Processor time of this thread \[s\].
fn processor_s() -> f64 {
    let time = clock_gettime(ClockId::CLOCK_THREAD_CPUTIME_ID).expect("the system has it");
    Duration::from(time).as_secs_f64()
}

/// Ends the test's program when the input `now` stays the same for long.
fn watch(kind: Kind, now: &'static AtomicU64) {
    std::thread::spawn(move || {
        let (mut last, mut since) = (u64::MAX, Instant::now());
        loop {
            std::thread::sleep(Duration::from_millis(500));
            let input = now.load(Ordering::Relaxed);
            if input != last {
                (last, since) = (input, Instant::now());
            } else if input < INPUTS && since.elapsed() > HANGS {
                eprintln!("{kind:?} {input} hangs");
                std::process::abort();
            }
        }
    });
}

/// The input with this number, and the sample that it comes from.
fn input(kind: Kind, samples: &[Sample], number: u64) -> (&Sample, Vec<u8>) {
    let mut random = Random::new(kind as u64, number);
    let sample = random.of(samples);
    let other = random.of(samples);
    let bytes = mutated(&mut random, kind, &sample.bytes, &other.bytes);
    (sample, bytes)
}

/// Tries all inputs of a kind; one of so `many_read` is planned, too. At least `least_read` percent must be read: else
/// this would be about refusals only.
fn try_all(kind: Kind, many_read: u64, least_read: u64, now: &'static AtomicU64) {
    watch(kind, now);
    let samples = samples(kind);
    for sample in &samples {
        let read = sample.reader.read(&sample.bytes);
        assert!(read.is_ok(), "{} is no sample: {read:?}", sample.name);
    }
    let mut tally = Tally::default();
    let mut wrong = Vec::new();
    for number in 0..INPUTS {
        now.store(number, Ordering::Relaxed);
        let (sample, bytes) = input(kind, &samples, number);
        let began = processor_s();
        let mut result = Ok((Ok(()), None));
        let memory = measure(|| {
            result = catch_unwind(AssertUnwindSafe(|| {
                let read = sample.reader.read(&bytes);
                let plans = read.is_ok() && tally.read.is_multiple_of(many_read);
                let planned = plans.then(|| sample.reader.plan(&bytes));
                (read, planned)
            }));
        });
        let seconds = processor_s() - began;
        tally.longest_s = tally.longest_s.max(seconds);
        tally.most_memory = tally.most_memory.max(memory.bytes_max);
        let mut fail = |what: &str| {
            let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{kind:?}-{number}"));
            std::fs::write(&file, &bytes).expect("written");
            wrong.push(format!("{what}: {} as {:?}", file.display(), sample.reader));
        };
        if seconds > LONGEST_S {
            fail(&format!("{seconds:.1} s"));
        }
        if memory.bytes_max > MOST_MEMORY {
            fail(&format!("{} MB", memory.bytes_max / 1_000_000));
        }
        let said = |error: &String| error.is_empty() || error.len() > LONGEST_ERROR;
        match result {
            Err(_) => fail("a panic"),
            Ok((read, planned)) => {
                for error in [&read, planned.as_ref().unwrap_or(&Ok(()))] {
                    if error.as_ref().is_err_and(said) {
                        fail(&format!("an error of {:?}", error));
                    }
                }
                match read {
                    Ok(()) => tally.read += 1,
                    Err(_) => tally.refused += 1,
                }
                match planned {
                    Some(Ok(())) => tally.planned += 1,
                    Some(Err(_)) => tally.plan_refused += 1,
                    None => {}
                }
            }
        }
    }
    now.store(INPUTS, Ordering::Relaxed);
    println!("{kind:?}: {tally:?}");
    assert!(
        wrong.is_empty(),
        "{} of {INPUTS}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(tally.read * 100 > INPUTS * least_read, "{tally:?}");
}

macro_rules! kinds {
    ($($name:ident: $kind:ident, $many_read:literal, $least_read:literal;)+) => {
        $(
            #[test]
            fn $name() {
                static NOW: AtomicU64 = AtomicU64::new(u64::MAX);
                try_all(Kind::$kind, $many_read, $least_read, &NOW);
            }
        )+
    };
}

// Planning takes a hundred times as long as reading.
kinds! {
    programs_with_something_wrong: Nc, 60, 10;
    tables_with_something_wrong: Csv, 100, 10;
    settings_with_something_wrong: Toml, 150, 10;
    curves_with_something_wrong: Json, 100, 10;
    pictures_with_something_wrong: Png, 40, 5;
    messages_with_something_wrong: Framing, 1, 10;
}
