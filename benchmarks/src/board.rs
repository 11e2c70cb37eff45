//! On the emulated board, where time is instructions executed: each call is counted by itself.

use benchmarks::meter::{Meter, measured};
use benchmarks::{Failure, MACHINES_FILE, SHIFT};
use board_mps2_an500::benchmark::{self, COMMAND_LINE, Console, TICK_NS};
use core::fmt::Write;
use shared::trajectory::BoardPlanner;
use thiserror::Error;

/// Longest file of machines \[bytes\].
const LONGEST: usize = 16 * 1024;

struct Timer;

impl Meter for Timer {
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        let start = benchmark::now_ticks();
        measured(call);
        let ns = (benchmark::now_ticks() - start) * TICK_NS;
        // To the nearest: an instruction is many ticks long.
        ((ns + (1 << (SHIFT - 1))) >> SHIFT) as u32
    }
}

/// Runs the benchmark that the command line names.
fn run(planner: &mut BoardPlanner) -> Result<(), Stopped> {
    let mut line = [0; COMMAND_LINE];
    let mut buffer = [0; LONGEST];
    let line = benchmark::command_line(&mut line).ok_or(Stopped::NoName)?;
    let name = line.split(' ').nth(1).ok_or(Stopped::NoName)?;
    if name == STACK_OVERFLOW {
        overflow(0);
        return Err(Stopped::NoEnd);
    }
    let file = benchmark::read_file(MACHINES_FILE, &mut buffer).ok_or(Stopped::NoFile)?;
    Ok(benchmarks::run(name, file, &mut Timer, &mut Console, planner)?)
}

/// Not a benchmark: runs the stack over its end, which is to end the board in its handler of faults.
const STACK_OVERFLOW: &str = "stack-overflow";

/// Calls itself until the stack has no end any more, or 128 KB and more are used.
#[inline(never)]
fn overflow(depth: u32) -> u32 {
    let frame = core::hint::black_box([depth; 64]);
    if depth > 4096 {
        return depth;
    }
    overflow(depth + 1) + core::hint::black_box(frame)[0]
}

#[derive(Debug, Error)]
enum Stopped {
    #[error("the stack did not run over its end")]
    NoEnd,
    #[error("QEMU was told no benchmark")]
    NoName,
    #[error("the file of machines is missing or too long")]
    NoFile,
    #[error(transparent)]
    Failed(#[from] Failure),
}

// What the attribute makes of this function is unsafe code; the function is not.
#[allow(unsafe_code)]
#[cortex_m_rt::entry]
fn main() -> ! {
    static mut PLANNER: BoardPlanner = BoardPlanner::new();
    benchmark::start();
    let code = match run(PLANNER) {
        Ok(()) => 0,
        Err(error) => {
            // The console takes everything.
            let _ = writeln!(Console, "error: {error}");
            1
        }
    };
    benchmark::exit(code)
}
