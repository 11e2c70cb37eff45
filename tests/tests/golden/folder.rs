//! The folder of golden files in use.

use super::FILES;
use std::io;
use std::path::{Path, PathBuf};

/// `GOLDEN_DIR`, seen from the root of the workspace, or else the files shipped with the tests.
pub fn folder() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    match std::env::var_os("GOLDEN_DIR") {
        Some(path) => tests.parent().expect("the root of the workspace").join(path),
        None => tests.join("golden"),
    }
}

/// Names of all JSON files in `folder`, without `.json`, in order.
fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "json") {
            names.push(path.file_stem().expect("a name").to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

/// What is wrong with the files of `folder`, nothing if all is well.
fn faults(folder: &Path) -> io::Result<Vec<String>> {
    let names = names(folder)?;
    let unknown = names
        .iter()
        .filter(|name| !FILES.contains(&name.as_str()))
        .map(|name| format!("{name}.json is of no known name"));
    let missing = FILES
        .iter()
        .filter(|file| !names.iter().any(|name| name == *file))
        .map(|file| format!("{file}.json is missing"));
    Ok(unknown.chain(missing).collect())
}

#[test]
fn every_file_is_known_and_every_known_file_is_there() {
    let folder = folder();
    let faults = faults(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    assert!(faults.is_empty(), "{}: {}", folder.display(), faults.join(", "));
}

#[test]
fn a_stray_file_and_missing_ones_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in FILES.iter().skip(1).chain(&["stray"]) {
        std::fs::write(folder.path().join(name).with_extension("json"), "{}").expect("a file");
    }
    let faults = faults(folder.path()).expect("a list of faults");
    let missing = format!("{}.json is missing", FILES[0]);
    assert_eq!(faults, ["stray.json is of no known name", missing.as_str()]);
}
