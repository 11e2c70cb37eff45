//! Programs to read: those of the peer's package, or of a folder. They are read in copies of their folders, so that
//! nothing is written where they are.

use anyhow::{Context, Result, ensure};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGE: &str = "linuxcnc-uspace";
const EXTENSIONS: [&str; 3] = ["ngc", "nc", "tap"];
/// What only lathes have, and threads.
const LATHE: [u32; 9] = [7, 8, 33, 70, 71, 72, 76, 95, 96];

/// A program.
#[derive(Clone, Debug)]
pub struct Source {
    /// Where it is.
    pub original: PathBuf,
    /// The copy that is read.
    pub copy: PathBuf,
    pub lathe: bool,
}

/// Those that the peer's package has installed.
pub fn installed() -> Result<Vec<PathBuf>> {
    let list = Command::new("dpkg").args(["-L", PACKAGE]).output();
    let list = list.context("cannot run dpkg, which lists the peer's programs")?;
    ensure!(list.status.success(), "{PACKAGE} is not installed: install it");
    let files = String::from_utf8_lossy(&list.stdout);
    let files = files.lines().map(PathBuf::from);
    let mut files: Vec<PathBuf> = files.filter(|file| is_program(file) && file.is_file()).collect();
    files.sort();
    Ok(files)
}

/// Those of a folder and of the folders in it.
pub fn of_folder(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(of_folder(&path)?);
        } else if is_program(&path) {
            files.push(path.canonicalize()?);
        }
    }
    files.sort();
    Ok(files)
}

/// Copies the folders of programs into `to`.
pub fn copied(files: &[PathBuf], to: &Path) -> Result<Vec<Source>> {
    let mut folders: HashMap<PathBuf, PathBuf> = HashMap::new();
    let mut sources = Vec::new();
    for file in files {
        let folder = file.parent().unwrap_or(Path::new("/"));
        if !folders.contains_key(folder) {
            let copy = to.join(folders.len().to_string());
            copy_programs(folder, &copy)?;
            folders.insert(folder.to_owned(), copy);
        }
        let name = file.file_name().unwrap_or_default();
        let copy = folders[folder].join(name);
        let text = fs::read(&copy)?;
        sources.push(Source {
            original: file.clone(),
            lathe: in_lathe_folder(file) || is_lathe(&String::from_utf8_lossy(&text)),
            copy,
        });
    }
    Ok(sources)
}

fn copy_programs(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let path = entry?.path();
        if path.is_file() && is_program(&path) {
            // The content only: it may be for reading only.
            fs::write(to.join(path.file_name().unwrap_or_default()), fs::read(&path)?)?;
        }
    }
    Ok(())
}

fn is_program(file: &Path) -> bool {
    let extension = file.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension))
}

fn in_lathe_folder(file: &Path) -> bool {
    let mut folders = file.ancestors().skip(1).filter_map(Path::file_name);
    folders.any(|name| name.to_string_lossy().contains("lathe"))
}

/// Whether one of the codes stands in it, outside of comments.
fn is_lathe(text: &str) -> bool {
    text.lines().any(|line| {
        let mut code = String::new();
        let mut comment = false;
        for c in line.chars() {
            match c {
                ';' if !comment => break,
                '(' => comment = true,
                ')' => comment = false,
                c if !comment && !c.is_whitespace() => code.push(c.to_ascii_uppercase()),
                _ => {}
            }
        }
        let numbers = code.split('G').skip(1).map(|rest| {
            let digits = rest.chars().take_while(char::is_ascii_digit);
            digits.collect::<String>().parse::<u32>()
        });
        numbers.flatten().any(|number| LATHE.contains(&number))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lathe_programs_are_told_by_their_codes_and_folders() {
        for text in ["g07", "N1 X1 G 33.1 K1", "G0 X1\nG96 D100 (x)"] {
            assert!(is_lathe(text), "{text}");
        }
        for text in ["G0 X7", "(G7)", "; G33", "G73 G80", "G0 (G95"] {
            assert!(!is_lathe(text), "{text}");
        }
        assert!(in_lathe_folder(Path::new("/a/lathe_macros/b/c.ngc")));
        assert!(!in_lathe_folder(Path::new("/a/b/lathe.ngc")));
    }

    #[test]
    fn programs_are_copied_with_those_beside_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).expect("a folder");
        for name in ["a.ngc", "b.tap", "c.txt"] {
            fs::write(inner.join(name), "M2\n").expect("a file");
        }
        let files = of_folder(folder.path()).expect("files");
        let to = tempfile::tempdir().expect("a folder");
        let sources = copied(&files, to.path()).expect("copies");
        assert_eq!((files.len(), sources.len()), (2, 2));
        assert!(sources.iter().all(|source| source.copy.is_file()));
    }
}
