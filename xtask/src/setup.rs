//! Installs what building and emulating need, if it is missing. Says what it does; does nothing twice.

use crate::cargo::{root, run_command, target_directory};
use crate::firmware::TARGET;
use anyhow::{Context, Result, bail, ensure};
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What the project needs beside cargo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// Rust's core library for the boards.
    ArmTarget,
    /// Rust's library for the PC's programs on Windows.
    WindowsTarget,
    /// Rust's library for browsers.
    WasmTarget,
    /// A browser, for tests.
    Chromium,
    /// Formatter and linter.
    Components,
    /// The emulator.
    Qemu,
    /// What counts instructions on the PC.
    Valgrind,
    /// The library of GigE Vision cameras, and its simulated camera.
    Aravis,
    /// What runs the post-processor of FreeCAD.
    Python,
    /// What changes the code, to see whether a test notices.
    Mutants,
    /// Another interpreter of NC programs, and the programs that come with it.
    LinuxCnc,
    /// What draws the operator's screen, in a window or without one, letters of every language that it speaks, and a display for tests.
    Screen,
    /// What Unicorn, the core of the virtual NUCLEO, is built with.
    UnicornBuild,
}

/// Windows on the PC, as compilers call it.
pub const WINDOWS: &str = "x86_64-pc-windows-gnu";
/// Browsers, as compilers call them.
pub const WASM: &str = "wasm32-unknown-unknown";
/// Version of cargo-mutants whose flags and files are known here.
const MUTANTS: &str = "27.1.0";

/// For everything but counting, changing the code, comparing interpreters and the tests in a browser.
pub const ALL: [Tool; 9] = [
    Tool::ArmTarget,
    Tool::WindowsTarget,
    Tool::WasmTarget,
    Tool::Components,
    Tool::Qemu,
    Tool::Aravis,
    Tool::Python,
    Tool::Screen,
    Tool::UnicornBuild,
];
/// For emulated boards.
pub const EMULATION: [Tool; 2] = [Tool::ArmTarget, Tool::Qemu];
/// For virtual boards.
pub const VIRTUAL: [Tool; 2] = [Tool::ArmTarget, Tool::UnicornBuild];
/// For the tests of the virtual board.
pub const VIRTUAL_TESTS: [Tool; 3] = [Tool::ArmTarget, Tool::UnicornBuild, Tool::Components];
/// For the tests in a browser.
pub const BROWSER: [Tool; 4] = [Tool::WasmTarget, Tool::Aravis, Tool::Screen, Tool::Chromium];
/// For counting instructions.
pub const COUNTING: [Tool; 3] = [Tool::ArmTarget, Tool::Qemu, Tool::Valgrind];

/// Installs those of `wants` that are missing.
pub fn run(wants: &[Tool]) -> Result<()> {
    for tool in wants {
        match tool {
            Tool::ArmTarget => rust_target(TARGET)?,
            Tool::WindowsTarget => rust_target(WINDOWS)?,
            Tool::WasmTarget => rust_target(WASM)?,
            Tool::Chromium => debian(
                &["chromium"],
                || runs("chromium", &["--version"]),
                "install Chromium by hand, as `chromium`",
            )?,
            Tool::Components => components()?,
            Tool::Qemu => debian(
                &["qemu-system-arm"],
                || runs("qemu-system-arm", &["--version"]),
                "install QEMU for Arm by hand, version 7.2 or later with plugins",
            )?,
            Tool::Valgrind => debian(
                &["valgrind"],
                || runs("valgrind", &["--version"]),
                "install valgrind by hand",
            )?,
            // The library is there if a build finds it; libaravis-dev needs libusb to be found and does not ask for it.
            Tool::Aravis => debian(
                &["pkg-config", "libaravis-dev", "libusb-1.0-0-dev", "aravis-tools"],
                || {
                    runs("pkg-config", &["--cflags", "aravis-0.8 >= 0.8.25"])
                        && runs("arv-fake-gv-camera-0.8", &["--help"])
                },
                "install Aravis 0.8.25 or later by hand, with its tools",
            )?,
            Tool::Python => debian(
                &["python3"],
                || runs("python3", &["--version"]),
                "install Python 3.8 or later by hand",
            )?,
            Tool::Mutants => mutants()?,
            Tool::LinuxCnc => debian(
                &["linuxcnc-uspace"],
                || Path::new("/usr/bin/rs274").exists() && runs("dpkg", &["-L", "linuxcnc-uspace"]),
                "LinuxCNC 2.9 is in Debian 12 and later",
            )?,
            Tool::Screen => debian(
                &[
                    "mesa-vulkan-drivers",
                    "libgl1-mesa-dri",
                    "libegl1",
                    "libxkbcommon-x11-0",
                    "fontconfig",
                    "fonts-droid-fallback",
                    "xvfb",
                ],
                has_screen,
                "install drivers of Vulkan and OpenGL (Mesa's draw without a graphics card), and a font for Chinese, by hand",
            )?,
            Tool::UnicornBuild => debian(
                &["cmake", "g++", "libclang-dev"],
                || runs("cmake", &["--version"]) && runs("c++", &["--version"]) && has_libclang(),
                "install cmake, a C++ compiler and libclang by hand, and set LIBCLANG_PATH to the folder of libclang",
            )?,
        }
    }
    Ok(())
}

/// Whether programs can draw, have letters for Chinese (U+710A, to weld, among them), and a display for tests.
fn has_screen() -> bool {
    let any = |folder: &str, ending: &str| {
        let files = fs::read_dir(folder).into_iter().flatten().flatten();
        files
            .into_iter()
            .any(|file| file.file_name().to_string_lossy().ends_with(ending))
    };
    let vulkan = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"]
        .iter()
        .any(|folder| any(folder, ".json"));
    let fonts = Command::new("fc-list")
        .arg(":charset=710a")
        .stderr(Stdio::null())
        .output();
    let display = runs("Xvfb", &["-help"]);
    vulkan && display && fonts.is_ok_and(|output| !output.stdout.is_empty())
}

/// Whether the generator of bindings finds libclang: where it is told, or where Debian puts it.
fn has_libclang() -> bool {
    let in_debian = || {
        let versions = fs::read_dir("/usr/lib").into_iter().flatten().flatten();
        versions
            .filter(|entry| entry.file_name().to_string_lossy().starts_with("llvm-"))
            .any(|entry| entry.path().join("lib/libclang.so").exists())
    };
    env::var_os("LIBCLANG_PATH").is_some() || in_debian()
}

fn rust_target(name: &str) -> Result<()> {
    let installed = || Ok::<_, anyhow::Error>(sysroot()?.join("lib/rustlib").join(name).is_dir());
    if installed()? {
        return Ok(());
    }
    rustup(&["target", "add", name])?;
    ensure!(
        installed()?,
        "rustup has added {name} to another toolchain than {}",
        sysroot()?.display()
    );
    Ok(())
}

/// Installs cargo-mutants into the target folder.
fn mutants() -> Result<()> {
    if mutants_program()?.exists() {
        return Ok(());
    }
    let folder = tools()?.display().to_string();
    let arguments = [
        "install",
        "--locked",
        "--version",
        MUTANTS,
        "--root",
        &folder,
        "cargo-mutants",
    ];
    let line = format!("cargo {}", arguments.join(" "));
    eprintln!("set-up: {line}");
    let mut command = Command::new("cargo");
    command.args(arguments).current_dir(root());
    run_command(command, &line)
}

/// The program of cargo-mutants.
pub fn mutants_program() -> Result<PathBuf> {
    Ok(tools()?.join("bin").join("cargo-mutants"))
}

/// Folder of programs that are installed for this project only.
fn tools() -> Result<PathBuf> {
    Ok(target_directory()?.join("tools"))
}

fn components() -> Result<()> {
    let missing: Vec<&str> = [("rustfmt", "fmt"), ("clippy", "clippy")]
        .into_iter()
        .filter(|(_, command)| !runs("cargo", &[command, "--version"]))
        .map(|(component, _)| component)
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    rustup(&[&["component", "add"], &missing[..]].concat())
}

/// Installs `packages` of Debian unless what they bring is `present`; `by_hand` says what else to do.
fn debian(packages: &[&str], present: impl Fn() -> bool, by_hand: &str) -> Result<()> {
    if present() {
        return Ok(());
    }
    let names = packages.join(" ");
    ensure!(
        Path::new("/etc/debian_version").exists(),
        "{names} is missing and this is not Debian: {by_hand}"
    );
    let mut prefix = Vec::new();
    if !is_root() {
        ensure!(
            runs("sudo", &["--version"]),
            "{names} is missing, and installing it needs root or sudo: {by_hand}"
        );
        prefix.push("sudo");
    }
    let install = [&["install", "--yes", "--no-install-recommends"], packages].concat();
    for step in [&["update"][..], &install] {
        let words = [&prefix[..], &["apt-get"], step].concat();
        let line = words.join(" ");
        eprintln!("set-up: {line}");
        let mut command = Command::new(words[0]);
        command
            .args(&words[1..])
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(Stdio::null());
        run_command(command, &line)?;
    }
    ensure!(present(), "{names} is installed, but does not work: {by_hand}");
    Ok(())
}

fn rustup(arguments: &[&str]) -> Result<()> {
    let line = format!("rustup {}", arguments.join(" "));
    if !runs("rustup", &["--version"]) {
        bail!("rustup is missing; install for the compiler in use what `{line}` would install");
    }
    eprintln!("set-up: {line}");
    let mut command = Command::new("rustup");
    command.args(arguments).current_dir(root());
    run_command(command, &line)
}

fn sysroot() -> Result<PathBuf> {
    let output = Command::new("rustc")
        .args(["--print", "sysroot"])
        .current_dir(root())
        .output()
        .context("cannot run rustc")?;
    ensure!(
        output.status.success(),
        "rustc does not report where it is installed"
    );
    Ok(PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()))
}

fn is_root() -> bool {
    Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

fn runs(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .current_dir(root())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}
