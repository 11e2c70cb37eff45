//! Which machine the emulated boards are wired to: that of the machine file.

use anyhow::{Context, Result};
use std::path::Path;

/// Name of the machine of `file`: that of its kinematics. Whether the rest of the file makes sense is seamwright's to
/// judge.
pub fn name(file: &Path) -> Result<String> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("cannot read machine file {}", file.display()))?;
    name_in(&text).with_context(|| format!("machine file {}", file.display()))
}

fn name_in(text: &str) -> Result<String> {
    let file: toml::Table = text.parse()?;
    let kinematics = file.get("kinematics").and_then(toml::Value::as_table);
    let name = kinematics.and_then(|kinematics| kinematics.keys().next());
    name.cloned()
        .context("there is no table [kinematics.NAME], which gives the kind of machine")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cargo::root;

    #[test]
    fn shipped_machines_are_called_as_their_files() {
        for name in plant_file::names() {
            let file = root().join("machines").join(name).with_extension("toml");
            assert_eq!(super::name(&file).expect("a shipped file"), name);
        }
    }

    #[test]
    fn a_file_that_names_no_machine_is_refused() {
        assert!(name_in("name = 3").is_err());
        assert!(name_in("[kinematics]").is_err());
        assert!(name_in("kinematics = [").is_err());
        assert!(name(Path::new("no/such.toml")).is_err());
    }
}
