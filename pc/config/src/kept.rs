//! Files that a power cut or a mistake must not lose.

use std::fs::File;
use std::io::{Error as IoError, Write};
use std::path::{Path, PathBuf};

/// Puts `text` in the place of the file at `path`; whatever happens, one of both is there. What the system allows with the file
/// stays.
///
/// # Errors
/// As of the system.
pub fn replace(path: &Path, text: &str) -> Result<(), IoError> {
    let new = beside(path, "new");
    let mut file = File::create(&new)?;
    if let Ok(before) = path.metadata() {
        file.set_permissions(before.permissions())?;
    }
    file.write_all(text.as_bytes())?;
    file.sync_data()?;
    std::fs::rename(&new, path)
}

/// Keeps `text`, which was in the file at `path`, beside it as a version: `NAME.0001`, `NAME.0002` and so on. No file is written
/// over.
///
/// # Errors
/// As of the system.
pub fn keep_version(path: &Path, text: &str) -> Result<PathBuf, IoError> {
    let version = next_version(path);
    let mut file = File::create_new(&version)?;
    file.write_all(text.as_bytes())?;
    file.sync_data()?;
    Ok(version)
}

/// Versions of the file at `path` that are kept beside it, by their numbers, oldest first.
pub fn versions(path: &Path) -> Vec<(u32, PathBuf)> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let number = |file: &Path| -> Option<u32> {
        let beside = file.file_name()?.to_str()?;
        let digits = beside.strip_prefix(&*name)?.strip_prefix('.')?;
        let is_number = digits.len() >= 4 && digits.bytes().all(|digit| digit.is_ascii_digit());
        is_number.then(|| digits.parse().ok()).flatten()
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut found: Vec<(u32, PathBuf)> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter_map(|file| Some((number(&file)?, file)))
        .collect();
    found.sort();
    found
}

/// Where [`keep_version`] would keep the next version, as long as nobody else does.
pub fn next_version(path: &Path) -> PathBuf {
    let last = versions(path).last().map_or(0, |(number, _)| *number);
    beside(path, &format!("{:04}", last.saturating_add(1)))
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(ending);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_go_on_from_the_last_one_and_nothing_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("m.toml");
        std::fs::write(&file, "three").unwrap();
        for other in ["m.toml.0041", "m.toml.new", "m.toml.12", "m.plant.toml.0099"] {
            std::fs::write(folder.path().join(other), "other").unwrap();
        }
        assert_eq!(next_version(&file), folder.path().join("m.toml.0042"));
        assert_eq!(
            keep_version(&file, "three").unwrap(),
            folder.path().join("m.toml.0042")
        );
        let numbers: Vec<u32> = versions(&file).iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, [41, 42]);
        let other = std::fs::read_to_string(folder.path().join("m.toml.0041")).unwrap();
        assert_eq!(other, "other");
    }

    #[test]
    fn what_replaces_a_file_is_there_whole_with_the_rights_of_the_one_before() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("m.toml");
        std::fs::write(&file, "before").unwrap();
        #[cfg(unix)]
        let mode = {
            use std::os::unix::fs::PermissionsExt;
            std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o640)).unwrap();
            || file.metadata().unwrap().permissions().mode() & 0o777
        };
        replace(&file, "after").unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "after");
        #[cfg(unix)]
        assert_eq!(mode(), 0o640);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
