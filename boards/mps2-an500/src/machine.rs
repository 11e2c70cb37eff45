//! The machine that the motion board is wired to. It is named on the command line of QEMU:
//! `arg=machine=NAME`.

use crate::semihosting::{self, COMMAND_LINE};
use plant::MotionPlant;

/// Before the name of the machine.
const KEY: &str = "machine=";

/// The machine that was named, or [`plant::DEFAULT_MACHINE`] if none was. A name that no machine has ends the
/// board: it must not run on another machine than its user means.
pub fn wired() -> MotionPlant {
    let mut buffer = [0; COMMAND_LINE];
    let line = semihosting::command_line(&mut buffer).unwrap_or_default();
    match line.split(' ').find_map(|word| word.strip_prefix(KEY)) {
        None => MotionPlant::default(),
        Some(name) => MotionPlant::of(name).unwrap_or_else(|| {
            semihosting::say("this board has no plant for a machine called ");
            semihosting::say(name);
            semihosting::say("\n");
            panic!("no plant for a machine called {name}")
        }),
    }
}
