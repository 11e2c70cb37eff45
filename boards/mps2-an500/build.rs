//! Puts the board's memory regions and interrupt names where the linker finds them.

use std::path::PathBuf;
use std::{env, fs};

/// Vectors in the order of [the interrupt numbers](src/device.rs), each the name a firmware binds.
const INTERRUPTS: [&str; 4] = ["PATH_TICK", "ETHERNET", "SOFT_0", "SOFT_1"];

fn main() {
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy("regions.x", out.join("regions.x")).expect("OUT_DIR is writable");

    // One timer ticks for both firmwares, under the name each knows it by.
    let mut device =
        String::from("PROVIDE(SERVO_TICK = CONTROL_TICK);\nPROVIDE(CONTROL_TICK = DefaultHandler);\n");
    for name in INTERRUPTS {
        device += &format!("PROVIDE({name} = DefaultHandler);\n");
    }
    fs::write(out.join("device.x"), device).expect("OUT_DIR is writable");

    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=regions.x");
    println!("cargo:rerun-if-changed=../../memory.x");
}
