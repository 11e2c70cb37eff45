//! A pair of boards on the model of the real one.

use emulator::{Session, bound_to_parent};
use std::env;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Stdio};
use std::thread;

/// Environment variables with the program, and with the folder of both images.
const PROGRAM: &str = "SEAMWRIGHT_VIRTUAL_NUCLEO";
const IMAGES: &str = "SEAMWRIGHT_NUCLEO_IMAGES";
/// How the line begins in which it tells where its boards are to be found.
const SESSION: &str = "session: ";
/// What embassy-stm32 does once, without harm (virtual-nucleo/README.md).
const KNOWN: &str = "IFCR of SPI3";

/// Boards that run. They are ended with this, and then have to have found nothing.
pub struct Model {
    child: Child,
    output: BufReader<ChildStdout>,
    pub session: Session,
}

impl Model {
    /// Whether the tests are to run on it.
    pub fn is_wanted() -> bool {
        env::var_os(PROGRAM).is_some()
    }

    /// Boots boards that are wired to `machine`, with a folder of their own.
    pub fn boot(folder: &Path, machine: &str, arguments: &[&str]) -> Self {
        let [program, images] = [PROGRAM, IMAGES].map(|variable| {
            let told = env::var_os(variable).map(PathBuf::from);
            told.unwrap_or_else(|| {
                panic!("{variable} is not set; run these tests by `cargo xtask test --boards virtual-nucleo`")
            })
        });
        let image = |firmware: &str| images.join(format!("firmware-{firmware}-nucleo-h723zg"));
        let mut child = bound_to_parent(program)
            .args([image("motion"), image("tracker")])
            .args(["--machine", machine, "--folder"])
            .arg(folder)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| panic!("virtual-nucleo: {error}"));
        let mut output = BufReader::new(child.stdout.take().expect("is piped"));
        let mut line = String::new();
        output.read_line(&mut line).expect("its output");
        let file = line.trim_end().strip_prefix(SESSION);
        let file = file.unwrap_or_else(|| panic!("virtual-nucleo says {line:?}"));
        Self {
            child,
            output,
            session: Session::read(Path::new(file)).unwrap_or_else(|error| panic!("{error}")),
        }
    }

    /// Checks that they still run.
    #[track_caller]
    pub fn check(&mut self) {
        let ended = self.child.try_wait().expect("a child");
        assert!(ended.is_none(), "virtual-nucleo has ended: {ended:?}");
    }

    /// Ends the boards, and checks that nothing was found.
    fn end(&mut self) {
        drop(self.child.stdin.take());
        let mut said = String::new();
        self.output.read_to_string(&mut said).expect("its output");
        self.child.wait().expect("it ends");
        println!("{said}");
        let mut boards = 0;
        for line in said.lines() {
            if line.ends_with(", 0 resets") {
                boards += 1;
            } else {
                assert!(line.contains(KNOWN), "{line}");
            }
        }
        assert_eq!(boards, 2, "{said}");
    }
}

impl Drop for Model {
    fn drop(&mut self) {
        if thread::panicking() {
            // Errors mean it has ended already.
            let _ = self.child.kill();
            let _ = self.child.wait();
        } else {
            self.end();
        }
    }
}
