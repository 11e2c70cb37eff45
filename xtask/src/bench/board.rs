//! The board's program in QEMU, with an instruction taking the same time always.

use super::{Counts, bounded};
use anyhow::{Result, bail};
use benchmarks::SHIFT;
use std::path::Path;
use std::time::Duration;

const EMULATOR: &str = "qemu-system-arm";
/// It takes seconds.
const LIMIT: Duration = Duration::from_secs(300);

/// What the board says, and QEMU ends with, when its handler of faults runs although the stack ran over.
const OVERFLOW_SAID: &str = "the stack overflowed";
const OVERFLOW_STATUS: &str = "exit status: 101";

/// Runs the stack over its end: the handler of faults has to run all the same.
pub fn overflow_stack(image: &Path, folder: &Path) -> Result<()> {
    let Err(end) = say(image, "stack-overflow", folder) else {
        bail!("the board continued after its stack overflowed");
    };
    let end = end.to_string();
    if end.contains(OVERFLOW_SAID) && end.contains(OVERFLOW_STATUS) {
        return Ok(());
    }
    bail!("the handler of faults did not run: {end}")
}

/// Runs the benchmark called `name` in `folder`.
pub fn run(image: &Path, name: &str, folder: &Path) -> Result<Counts> {
    Counts::read(&say(image, name, folder)?)
}

/// The same; what it says.
pub fn say(image: &Path, name: &str, folder: &Path) -> Result<String> {
    let icount = format!("shift={SHIFT},sleep=off");
    let semihosting = format!("enable=on,target=native,arg=benchmarks,arg={name}");
    let image = image.display().to_string();
    let arguments = [
        ["-machine", "mps2-an500"],
        ["-display", "none"],
        ["-monitor", "none"],
        ["-serial", "null"],
        ["-nic", "none"],
        ["-icount", &icount],
        ["-semihosting-config", &semihosting],
        ["-kernel", &image],
    ];
    let arguments: Vec<String> = arguments.concat().into_iter().map(str::to_owned).collect();
    bounded::run(EMULATOR, &arguments, folder, "board.console", LIMIT)
}
