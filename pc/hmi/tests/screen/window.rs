//! The program in a window, on a display without a screen, tapped as a display is.

use emulator::bound_to_parent;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, MOTION_NOTIFY_EVENT};
use x11rb::protocol::xtest::ConnectionExt;
use x11rb::rust_connection::RustConnection;

/// Longest wait for the display and for the window.
const PATIENCE: Duration = Duration::from_secs(120);
/// The colours of Stop, and of what begins a job: blue, green, red, as the display keeps them.
const STOP: [u8; 3] = [20, 20, 200];
const GOOD: [u8; 3] = [120, 200, 90];
/// Pixels in a row of the display.
const WIDTH: usize = 1280;
/// The display is looked at so often.
const POLL: Duration = Duration::from_millis(100);
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

/// What a display shows, and taps on it.
struct Panel {
    picture: PathBuf,
    connection: RustConnection,
    root: u32,
}

impl Panel {
    fn of(display: &str, folder: &Path) -> Self {
        let (connection, screen) = x11rb::connect(Some(display)).expect("a display");
        let root = connection.setup().roots[screen].root;
        Self {
            picture: folder.join("Xvfb_screen0"),
            connection,
            root,
        }
    }

    /// Pixels of `colour`, and their middle.
    fn find(&self, colour: [u8; 3]) -> (usize, [i16; 2]) {
        let picture = std::fs::read(&self.picture).unwrap_or_default();
        // Of the format that xwd writes: a header, colours of 12 bytes, then four bytes a pixel.
        let number = |at: usize| {
            let bytes = picture.get(at..at + 4)?;
            Some(u32::from_be_bytes(bytes.try_into().ok()?) as usize)
        };
        let begin = number(0)
            .zip(number(76))
            .map_or(0, |(header, colours)| header + 12 * colours);
        let pixels = picture.get(begin..).unwrap_or_default().chunks_exact(4);
        let found = pixels.enumerate().filter(|(_, pixel)| pixel.starts_with(&colour));
        let (mut count, mut x, mut y) = (0, 0, 0);
        for (index, _) in found {
            (count, x, y) = (count + 1, x + index % WIDTH, y + index / WIDTH);
        }
        let middle = [x, y].map(|sum| i16::try_from(sum / count.max(1)).expect("on the display"));
        (count, middle)
    }

    /// Waits for a button of `colour` while `program` runs; its middle.
    fn until(&self, program: &mut Running, colour: [u8; 3]) -> [i16; 2] {
        let end = Instant::now() + PATIENCE;
        loop {
            let (count, middle) = self.find(colour);
            if count >= AT_LEAST {
                return middle;
            }
            assert_eq!(program.0.try_wait().expect("its state"), None, "it has ended");
            assert!(Instant::now() < end, "nothing of {colour:?} is on the screen");
            std::thread::sleep(POLL);
        }
    }

    /// Taps there, as a finger does: it takes a moment.
    fn tap(&self, [x, y]: [i16; 2]) {
        for (what, button) in [
            (MOTION_NOTIFY_EVENT, 0),
            (BUTTON_PRESS_EVENT, 1),
            (BUTTON_RELEASE_EVENT, 1),
        ] {
            let sent = self
                .connection
                .xtest_fake_input(what, button, 0, self.root, x, y, 0);
            sent.expect("a display")
                .check()
                .expect("a display that can be tapped");
            std::thread::sleep(POLL);
        }
    }
}

/// By taps in a real window: the program that was loaded is started, asked for, and welded to its end.
#[test]
fn a_weld_is_started_by_two_taps_in_the_window_and_finishes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_server, display) = display(folder.path());
    let mut command = bound_to_parent(env!("CARGO_BIN_EXE_seamwright-hmi"));
    command.args([
        "../../programs/t-seam-400.ngc",
        "--machine",
        "../../machines/dual-beam-gantry.toml",
        "--programs",
        "../../programs",
        "--pace",
        "1000",
    ]);
    command.arg("--reports").arg(folder.path());
    command.arg("--settings").arg(folder.path().join("hmi.toml"));
    command
        .env("DISPLAY", &display)
        .env_remove("WAYLAND_DISPLAY")
        .env("LIBGL_ALWAYS_SOFTWARE", "1");
    let mut program = start(&mut command);
    let panel = Panel::of(&display, folder.path());
    panel.until(&mut program, STOP);
    // Start is green as soon as the program is loaded; what is behind the question is darker.
    let start = panel.until(&mut program, GOOD);
    panel.tap(start);
    let end = Instant::now() + PATIENCE;
    let ask = loop {
        let ask = panel.until(&mut program, GOOD);
        if ask != start {
            break ask;
        }
        assert!(Instant::now() < end, "nothing is asked");
        std::thread::sleep(POLL);
    };
    panel.tap(ask);
    let report = folder.path().join("0001-t-seam-400").join("report.json");
    let end = Instant::now() + PATIENCE;
    while !report.exists() {
        assert_eq!(program.0.try_wait().expect("its state"), None, "it has ended");
        assert!(Instant::now() < end, "there is no report");
        std::thread::sleep(POLL);
    }
}
