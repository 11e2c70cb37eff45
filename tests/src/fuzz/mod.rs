//! Random and mutated requests and datagrams against both controllers, on simulated boards.
//!
//! Cases begin at moments of the shipped jobs, and continue with what the PC said then: some of it changed in
//! one number, or in any byte, some of it twice or not at all, and between it what belongs elsewhere. At
//! every tick the outputs are judged. Messages are changed in their postcard bytes, so that this file knows
//! none of them by name.

mod case;
mod corpus;
mod judge;
mod random;
mod wire;

pub use case::{Case, Tally};
pub use corpus::{Message, Said, Session, seldom};
pub use random::Random;

use std::cell::RefCell;
use std::fmt;
use std::time::{Duration, Instant};

thread_local! {
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Where the last panic of this thread was.
fn last_panic() -> Option<String> {
    PANIC.take()
}

/// From now on panics print nothing: they are reported with their case.
pub fn quiet() {
    std::panic::set_hook(Box::new(|info| {
        PANIC.set(info.location().map(|place| format!("at {place}")));
    }));
}

/// Something that must not be.
#[derive(Debug)]
pub struct Failure {
    /// Which run, and which case of it.
    pub seed: u64,
    /// See `seed`.
    pub case: u64,
    text: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "case {} of seed {}: {}", self.case, self.seed, self.text)
    }
}

/// One case; a failure with the fewest steps that lead to it.
pub fn run_case(sessions: &[Session], seed: u64, case: u64, tally: &mut Tally) -> Result<(), Failure> {
    let this = Case::new(&mut Random::new(seed, case), sessions);
    if this.run(tally).is_ok() {
        return Ok(());
    }
    let Some((steps, what)) = this.shrink() else {
        return Ok(());
    };
    let (session, moment) = (&this.session.name, this.moment);
    let mut text = format!("{what}\n  from moment {moment} of {session}:\n");
    for step in steps {
        text += &format!("    {step:?}\n");
    }
    Err(Failure { seed, case, text })
}

/// Cases from `first` on until there were `messages`, or the time is over.
pub fn run(
    sessions: &[Session],
    seed: u64,
    first: u64,
    messages: u64,
    within: Duration,
    mut progress: impl FnMut(u64, &Tally),
) -> Result<Tally, Failure> {
    let (began, mut tally) = (Instant::now(), Tally::default());
    for case in first.. {
        if tally.messages() >= messages || began.elapsed() >= within {
            break;
        }
        progress(case, &tally);
        run_case(sessions, seed, case, &mut tally)?;
    }
    Ok(tally)
}
