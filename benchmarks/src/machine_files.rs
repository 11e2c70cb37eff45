//! Machine files into the [form](crate::machine) that both programs read. On the PC only.

use crate::machine::Machine;
use anyhow::{Context, Result};
use serde::Deserialize;
use shared::io::AXIS_NAMES;
use shared::kinematics::{AxisConfig, KinematicsConfig};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Longest machine \[bytes\].
const LONGEST: usize = 1024;

/// The part of a machine file that is read here; the rest is seamwright's.
#[derive(Deserialize)]
struct Document {
    kinematics: KinematicsConfig,
    axes: BTreeMap<String, AxisConfig>,
}

/// All machine files of a folder, packed, in the order of their names.
pub fn pack(folder: &Path) -> Result<Vec<u8>> {
    let cannot = || format!("cannot read the machine files of {}", folder.display());
    let entries = fs::read_dir(folder).with_context(cannot)?;
    let mut files = entries
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<Vec<PathBuf>>>()
        .with_context(cannot)?;
    let name = |file: &PathBuf| file.to_string_lossy().into_owned();
    files.retain(|file| name(file).ends_with(".toml") && !name(file).ends_with(".plant.toml"));
    files.sort();
    let mut packed = Vec::new();
    for file in files {
        let machine = read(&file).with_context(|| format!("machine file {}", file.display()))?;
        packed.extend_from_slice(postcard::to_slice(&machine, &mut [0; LONGEST])?);
    }
    Ok(packed)
}

fn read(file: &Path) -> Result<Machine> {
    let mut document: Document = toml::from_str(&fs::read_to_string(file)?)?;
    Ok(Machine {
        kinematics: document.kinematics,
        axes: AXIS_NAMES.map(|name| document.axes.remove(name)),
    })
}
