//! The page for browsers: built for WebAssembly, and packed into a folder that `seamwright-hmi` serves.

use crate::cargo::{self, target_directory};
use crate::setup::WASM;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// Builds it into `folder`, or else beside the `seamwright-hmi` of a release, which takes it from there; gives back the folder.
pub fn build(folder: Option<&Path>) -> Result<PathBuf> {
    let folder = match folder {
        Some(folder) => std::path::absolute(folder)?,
        None => target_directory()?.join("release").join("browser"),
    };
    eprintln!("building the page for browsers");
    let build = ["build", "--quiet", "--package", "seamwright-browser"];
    cargo::run(&[&build[..], &["--target", WASM, "--profile", "browser"]].concat())?;
    let built = target_directory()?
        .join(WASM)
        .join("browser")
        .join("browser.wasm");
    let [built, into] = [&built, &folder].map(|path| path.to_str().context("a path that is no text"));
    let pack = ["run", "--quiet", "--package", "seamwright-page", "--"];
    cargo::run(&[&pack[..], &[built?, into?]].concat())?;
    Ok(folder)
}
