//! The machine that the boards are wired to: the file `plant` in the folder that QEMU runs in, in postcard.

use crate::semihosting;
use plant::{LONGEST, PlantConfig};

/// The machine. A board without one, or with one that it does not understand, ends: it must not run on another machine than
/// its user means.
pub fn wired() -> PlantConfig {
    let mut buffer = [0; LONGEST];
    let config =
        semihosting::read_file(c"plant", &mut buffer).and_then(|bytes| postcard::from_bytes(bytes).ok());
    config.unwrap_or_else(|| {
        semihosting::say("this board has no plant file, or one of another version\n");
        panic!("no plant")
    })
}
