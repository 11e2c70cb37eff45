//! Files of what was taught, which a power cut or a new start must not lose.

use std::fs::File;
use std::io::{Error as IoError, Write};
use std::path::{Path, PathBuf};

/// Puts `text` in the place of the file at `path`; whatever happens, one of both is there.
pub fn replace(path: &Path, text: &str) -> Result<(), IoError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let new = path.with_file_name(name);
    let mut file = File::create(&new)?;
    file.write_all(text.as_bytes())?;
    file.sync_data()?;
    std::fs::rename(&new, path)
}

/// A name beside `path` that no file has: taught.1.csv, taught.2.csv…
pub fn free_name(path: &Path) -> PathBuf {
    let extension = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    (1..)
        .map(|n: u32| path.with_extension(format!("{n}.{extension}")))
        .find(|candidate| !candidate.exists())
        .unwrap_or_else(|| path.with_extension("old"))
}
