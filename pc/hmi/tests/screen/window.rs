//! The program in a window, on a display without a screen.

use emulator::bound_to_parent;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for the display and for the window.
const PATIENCE: Duration = Duration::from_secs(120);
/// The colour of Stop: blue, green, red, as the display keeps them.
const STOP: [u8; 3] = [20, 20, 200];
/// Pixels of it, of a button of 140 × 60 with letters on it.
const AT_LEAST: usize = 4000;

/// A process that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start(command: &mut Command) -> Running {
    Running(
        command
            .spawn()
            .unwrap_or_else(|error| panic!("{command:?}: {error}")),
    )
}

/// A display whose picture is a file in `folder`; its number.
fn display(folder: &Path) -> (Running, String) {
    let mut command = bound_to_parent("Xvfb");
    command.args([
        "-displayfd",
        "1",
        "-screen",
        "0",
        "1280x800x24",
        "-nolisten",
        "tcp",
        "-fbdir",
    ]);
    command.arg(folder).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut server = start(&mut command);
    let told = BufReader::new(server.0.stdout.take().expect("a pipe"))
        .lines()
        .next();
    let number = told.expect("a line").expect("readable");
    (server, format!(":{number}"))
}

#[test]
fn the_program_opens_a_window_and_draws_stop_in_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_server, display) = display(folder.path());
    let mut command = bound_to_parent(env!("CARGO_BIN_EXE_seamwright-hmi"));
    command.args([
        "--machine",
        "../../machines/dual-beam-gantry.toml",
        "--programs",
        "../../programs",
    ]);
    command.arg("--reports").arg(folder.path());
    command
        .env("DISPLAY", display)
        .env_remove("WAYLAND_DISPLAY")
        .env("LIBGL_ALWAYS_SOFTWARE", "1");
    let mut program = start(&mut command);
    let end = Instant::now() + PATIENCE;
    let drawn = || {
        // After a header, four bytes a pixel.
        let picture = std::fs::read(folder.path().join("Xvfb_screen0")).unwrap_or_default();
        picture
            .chunks_exact(4)
            .filter(|pixel| pixel.starts_with(&STOP))
            .count()
    };
    while drawn() < AT_LEAST {
        assert_eq!(program.0.try_wait().expect("its state"), None, "it has ended");
        assert!(Instant::now() < end, "there is no Stop on the screen");
        std::thread::sleep(Duration::from_millis(100));
    }
}
