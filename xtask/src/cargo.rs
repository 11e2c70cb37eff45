//! Calls of cargo, in the workspace, with the toolchain this program was built by.

use anyhow::{Context, Result, ensure};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Root of the workspace.
pub fn root() -> PathBuf {
    let xtask = env::var_os("CARGO_MANIFEST_DIR")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    xtask.parent().map_or_else(|| xtask.clone(), Path::to_owned)
}

/// The target folder: this program lies two folders deep in it.
pub fn target_directory() -> Result<PathBuf> {
    let program = env::current_exe().context("cannot find this program's own file")?;
    let folder = program
        .ancestors()
        .nth(2)
        .context("this program was not built by cargo")?;
    Ok(folder.to_owned())
}

/// A cargo command at the root of the workspace, building into the one target folder.
pub fn cargo(arguments: &[&str]) -> Result<Command> {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .args(arguments)
        .current_dir(root())
        .env("CARGO_TARGET_DIR", target_directory()?);
    Ok(command)
}

/// Runs a cargo command to its end.
pub fn run(arguments: &[&str]) -> Result<()> {
    run_command(cargo(arguments)?, &format!("cargo {}", arguments.join(" ")))
}

/// Runs a command to its end; `what` names it in the error.
pub fn run_command(mut command: Command, what: &str) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot run {what}"))?;
    ensure!(status.success(), "{what} failed ({status})");
    Ok(())
}
