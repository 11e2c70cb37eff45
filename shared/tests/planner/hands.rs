//! Many random programs with hands at the controls, on every machine: so many that they are a command of their own
//! (`cargo xtask bench hands`). The same programs as in [`random`](super::random), but for their seeds; all that fails is
//! told, not only the first.

use super::bench::{self, Bench};
use super::random::{any_acts, check, frame, moves};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{RngSeed, TestCaseError, TestRunner};
use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU32, Ordering};

/// Environment: how many programs, and the seed of the first.
const PROGRAMS: &str = "HANDS_PROGRAMS";
const SEED: &str = "HANDS_SEED";

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect(name))
}

fn value<S: Strategy>(strategy: &S, runner: &mut TestRunner) -> S::Value
where
    S::Value: Debug,
{
    strategy.new_tree(runner).expect("nothing is filtered").current()
}

/// The program of a `seed`, with hands at the controls, and what is wrong with how it runs.
fn one(seed: u64) -> Result<(), String> {
    let mut runner = TestRunner::new(ProptestConfig {
        rng_seed: RngSeed::Fixed(seed),
        ..ProptestConfig::default()
    });
    let bench: Bench = match seed % 6 {
        0 => bench::dual_beam(),
        1 => bench::pipe_welder(),
        2 => bench::ac_head(),
        3 => bench::wire_arc(),
        4 => bench::stir_gantry(),
        _ => bench::axes(&value(&frame(), &mut runner)),
    };
    let (moves, acts) = (value(&moves(), &mut runner), value(&any_acts(), &mut runner));
    let result = catch_unwind(AssertUnwindSafe(|| check(&bench, &moves, &acts)));
    let wrong = match result {
        Ok(Ok(())) => return Ok(()),
        Ok(Err(TestCaseError::Fail(reason) | TestCaseError::Reject(reason))) => reason.to_string(),
        Err(_) => "it panics".to_owned(),
    };
    Err(format!("seed {seed}: {wrong}"))
}

#[test]
#[ignore = "as many programs as HANDS_PROGRAMS says, 1000 otherwise, from seed HANDS_SEED on: minutes"]
fn many() {
    let (programs, first) = (number(PROGRAMS, 1000), number(SEED, 0));
    let failed = AtomicU32::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    std::thread::scope(|scope| {
        for thread in 0..threads {
            let failed = &failed;
            scope.spawn(move || {
                for seed in (first..first + programs).filter(|seed| seed % threads == thread) {
                    if let Err(wrong) = one(seed) {
                        println!("{wrong}");
                        failed.fetch_add(1, Ordering::Relaxed);
                    }
                }
            });
        }
    });
    let failed = failed.into_inner();
    println!("{failed} of {programs} programs failed");
    assert_eq!(failed, 0);
}
