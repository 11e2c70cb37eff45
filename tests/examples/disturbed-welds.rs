//! The shipped weld through the disturbed scene at 9 m/min, on simulated boards, for any number of seeds of its noise and
//! disturbances: how each ended, if it did not weld to the end, and the largest deviation with a beam on.
//! `cargo run --release -p system-tests --example disturbed-welds -- COUNT [FIRST]`.

use std::process::ExitCode;
use system_tests::range::with_beam_on;
use system_tests::weld_disturbed_by;
use world::simulated::SimulatedBoards;

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).map(|number| number.parse::<u64>());
    let (Some(Ok(count)), Ok(first)) = (numbers.next(), numbers.next().unwrap_or(Ok(1))) else {
        eprintln!("say how many welds, and the seed of the first one if that is not 1");
        return ExitCode::from(2);
    };
    let mut welded = 0;
    let mut worst: f64 = 0.0;
    for seed in first..first + count {
        let ended = weld_disturbed_by(seed, &mut SimulatedBoards::default());
        worst = with_beam_on(&ended).into_iter().fold(worst, f64::max);
        match &ended.error {
            None => welded += 1,
            Some(error) => println!("seed {seed}: {error}"),
        }
    }
    println!("{welded} of {count} welded to the end; at most {worst:.4} mm beside the seam with a beam on");
    ExitCode::SUCCESS
}
