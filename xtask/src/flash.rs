//! Writes a firmware to a board.

use crate::cargo::run_command;
use crate::firmware::{self, Board, Firmware};
use anyhow::{Result, bail, ensure};
use std::process::{Command, ExitCode, Stdio};

/// probe-rs's name of the chip.
const CHIP: &str = "STM32H723ZGTx";

/// Builds `firmware` and writes it to the board at the only debug probe.
pub fn run(firmware: Firmware, board: Board) -> Result<ExitCode> {
    if board == Board::Mps2An500 {
        bail!("{board} is emulated and has no flash to write: use `cargo xtask emulate`");
    }
    let found = Command::new("probe-rs")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    ensure!(
        found.is_ok_and(|status| status.success()),
        "probe-rs is missing: install it (https://probe.rs), connect the board by USB, and try again"
    );
    let [image] = firmware::build([firmware], board)?;
    for step in ["download", "reset"] {
        let mut command = Command::new("probe-rs");
        command.args([step, "--chip", CHIP]);
        if step == "download" {
            command.arg("--verify").arg(&image);
        }
        run_command(command, &format!("probe-rs {step}"))?;
    }
    Ok(ExitCode::SUCCESS)
}
