//! On the PC. The program cannot count itself: callgrind does from outside, so its records hold no instructions.

use anyhow::{Context, Result};
use benchmarks::MACHINES_FILE;
use benchmarks::meter::{Meter, measured};

struct Outside;

impl Meter for Outside {
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        measured(call);
        0
    }
}

/// Runs the benchmark that the command line names.
pub fn run() -> Result<()> {
    let name = std::env::args()
        .nth(1)
        .context("which benchmark? give its name")?;
    let file = MACHINES_FILE.to_str()?;
    let file = std::fs::read(file)
        .with_context(|| format!("cannot read {file}, which `cargo xtask bench` writes"))?;
    let mut text = String::new();
    benchmarks::run(&name, &file, &mut Outside, &mut text)?;
    print!("{text}");
    Ok(())
}
