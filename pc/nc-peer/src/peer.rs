//! The peer: LinuxCNC's interpreter, by its program `rs274`.
//!
//! It prints canonical commands with four decimals. What is run is a copy in which these are nine: the format `%.4f`
//! is replaced by `%.9f` wherever it stands, which changes what is printed and nothing else. Its Python module has all
//! digits, but tells nothing of outputs, and crashes at tool changes.
//!
//! A program is accepted if `rs274` ends with success, which it does if the interpreter has come to M2, M30 or `%`
//! without an error.

use crate::canon;
use crate::ours::Outcome;
use crate::process::{self, Ended};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// The program of the package `linuxcnc-uspace`.
const PROGRAM: &str = "/usr/bin/rs274";
/// What is printed, and what instead.
const FORMATS: [&[u8; 4]; 2] = [b"%.4f", b"%.9f"];
/// Tools are numbered up to here, without length.
pub const TOOLS: u32 = 99;
/// Longest time of a program.
const LIMIT: Duration = Duration::from_secs(10);

/// The peer in a folder of its own, in which it writes.
pub struct Peer {
    folder: PathBuf,
}

impl Peer {
    /// Puts the copy of the peer's program, a tool table and whatever else it needs into `folder`.
    pub fn new(folder: &Path) -> Result<Self> {
        let folder = folder.to_owned();
        let bytes = fs::read(PROGRAM)
            .with_context(|| format!("{PROGRAM} is missing: install the package linuxcnc-uspace"))?;
        let peer = Self { folder };
        fs::write(peer.program(), widened(bytes)?)?;
        fs::set_permissions(peer.program(), fs::Permissions::from_mode(0o755))?;
        fs::write(peer.tools(), tool_table())?;
        peer.check()?;
        Ok(peer)
    }

    /// What it says of a program; none if it takes too long.
    pub fn read(&self, file: &Path) -> Result<Option<Outcome>> {
        let Some(Ended { success, out, err }) = self.run(file)? else {
            return Ok(None);
        };
        Ok(Some(if success {
            Outcome::Accepted(canon::read(&out)?)
        } else {
            refusal(&err)
        }))
    }

    fn run(&self, file: &Path) -> Result<Option<Ended>> {
        // Parameters are written back: every program begins without any.
        let parameters = self.folder.join("parameters");
        fs::write(&parameters, "")?;
        let mut command = Command::new(self.program());
        command.arg("-g").arg("-t").arg(self.tools());
        command.arg("-v").arg(parameters).arg(file);
        // It keeps tools in a file of the home folder.
        command.env("HOME", &self.folder).env_remove("INI_FILE_NAME");
        command.current_dir(file.parent().unwrap_or(Path::new(".")));
        process::run(&mut command, LIMIT)
    }

    /// Whether it prints as it should.
    fn check(&self) -> Result<()> {
        let file = self.folder.join("check.ngc");
        fs::write(&file, "G21 G1 X1.23456789 F100\nM2\n")?;
        let said = self.run(&file)?.map(|ended| ended.out).unwrap_or_default();
        ensure!(
            said.contains("STRAIGHT_FEED(1.234567890, "),
            "{PROGRAM} prints in another way than that of LinuxCNC 2.9: install that version"
        );
        Ok(())
    }

    fn program(&self) -> PathBuf {
        self.folder.join("rs274")
    }

    fn tools(&self) -> PathBuf {
        self.folder.join("tools")
    }
}

/// The diameter of a tool; none of tool 1, which `rs274` has in the machine at the beginning, where that of LinuxCNC has none.
pub fn diameter_mm(number: u32) -> f64 {
    f64::from((number - 1) % 10) * 0.75
}

/// The tools, in the format of LinuxCNC.
fn tool_table() -> String {
    (1..=TOOLS)
        .map(|number| {
            // The machine of the peer's program has inches.
            let diameter = diameter_mm(number) / 25.4;
            format!("T{number} P{number} Z0 D{diameter:.12}\n")
        })
        .collect()
}

/// The same program with more decimals.
fn widened(mut bytes: Vec<u8>) -> Result<Vec<u8>> {
    let [before, after] = FORMATS;
    let mut at = 0;
    let mut count = 0;
    while let Some(found) = bytes[at..]
        .windows(before.len())
        .position(|window| window == before)
    {
        at += found;
        bytes[at..at + after.len()].copy_from_slice(after);
        count += 1;
    }
    ensure!(
        count > 0,
        "{PROGRAM} prints in another way than that of LinuxCNC 2.9"
    );
    Ok(bytes)
}

/// The error in what was said: the first line is not one, the last one is the block.
fn refusal(said: &str) -> Outcome {
    let lines = said
        .lines()
        .filter(|line| !line.is_empty() && *line != "executing");
    let lines: Vec<&str> = lines.collect();
    let problem = lines.first().map_or("it ended without a word", |line| *line);
    let place = lines.get(1).copied().unwrap_or_default();
    Outcome::Refused {
        problem: problem.to_owned(),
        place: place.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_widened_in_place() {
        let wide = widened(b"a %.4f, %.4f z".to_vec()).expect("formats");
        assert_eq!(wide, b"a %.9f, %.9f z");
        assert!(widened(b"%d".to_vec()).is_err());
    }

    #[test]
    fn a_refusal_is_the_first_sentence() {
        let refused = refusal("executing\nUnknown m code used: M100\nM100\n");
        let (problem, place) = ("Unknown m code used: M100".to_owned(), "M100".to_owned());
        assert_eq!(refused, Outcome::Refused { problem, place });
    }
}
