//! Any number of operators who say anything at any time: `operator-words COUNT [FIRST]`. Exits with 1 where a place
//! was left out without being named.

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::time::Instant;
use system_tests::meddled;

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).map(|number| number.parse::<u64>());
    let (Some(Ok(count)), Ok(first)) = (numbers.next(), numbers.next().unwrap_or(Ok(0))) else {
        eprintln!("say how many sequences, and the number of the first one if that is not 0");
        return ExitCode::from(2);
    };
    let began = Instant::now();
    let mut fates: BTreeMap<_, u64> = BTreeMap::new();
    let (mut wrong, mut words) = (0, 0);
    for seed in first..first + count {
        let meddled = meddled(seed);
        words += meddled.said.len();
        match meddled.fate() {
            Ok(fate) => *fates.entry(fate).or_default() += 1,
            Err(reason) => {
                wrong += 1;
                println!("sequence {seed}: {reason}");
            }
        }
        if (seed - first + 1).is_multiple_of(100) {
            println!("{} of {count}: {fates:?}, {wrong} wrong", seed - first + 1);
        }
    }
    let seconds = began.elapsed().as_secs_f64();
    println!("{count} sequences, {words} words, {seconds:.0} s: {fates:?}, {wrong} wrong");
    ExitCode::from(u8::from(wrong > 0))
}
