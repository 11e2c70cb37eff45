//! Names of files that give way to what is taught anew.

use std::path::{Path, PathBuf};

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
