//! What docs and comments refer to is there.

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// The root of the workspace.
fn root() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().expect("the root of the workspace").to_owned()
}

/// Every file of the project whose name has one of the `extensions`, and its text.
fn files(extensions: &[&str]) -> Vec<(PathBuf, String)> {
    let mut folders = vec![root()];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of the project") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            if path.is_dir() {
                if !(name.starts_with('.') || name == "target" || name == "report") {
                    folders.push(path);
                }
            } else if extensions
                .iter()
                .any(|end| path.extension() == Some(end.as_ref()))
            {
                let text = std::fs::read_to_string(&path).expect("text");
                found.push((path, text));
            }
        }
    }
    found
}

/// Headings of a Markdown text, without those in blocks of code.
fn headings(text: &str) -> Vec<&str> {
    let prose = text.split("```").step_by(2).flat_map(str::lines);
    let headings = prose.filter(|line| line.starts_with('#'));
    headings.map(|line| line.trim_start_matches('#').trim()).collect()
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
    heading
        .to_lowercase()
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

/// The first of a reference's sections and those that follow it: "0.6, 0.7" or "1.1–1.3".
fn sections(reference: &str) -> Vec<&str> {
    let is_part = |c: char| c.is_ascii_digit() || ".,– ".contains(c);
    if reference.starts_with("C,") || reference.starts_with("C)") {
        return vec!["C"];
    }
    let end = reference.find(|c| !is_part(c)).unwrap_or(reference.len());
    let parts = reference[..end].split([',', '–', ' ']);
    parts
        .map(|part| part.trim_end_matches('.'))
        .filter(|part| !part.is_empty())
        .collect()
}

#[test]
fn sections_of_the_mathematics_that_comments_name_are_there() {
    let mathematics = std::fs::read_to_string(root().join("docs/mathematics.md")).expect("the document");
    let numbers = headings(&mathematics)
        .into_iter()
        .filter_map(|heading| heading.split(' ').next());
    let there: BTreeSet<&str> = numbers.map(|number| number.trim_end_matches('.')).collect();
    let mut references = 0;
    for (path, text) in files(&["rs", "toml"]) {
        for (index, line) in text.lines().enumerate() {
            for reference in line.split("mathematics ").skip(1) {
                for section in sections(reference) {
                    references += 1;
                    assert!(
                        there.contains(section),
                        "{}, line {}: docs/mathematics.md has no section {section}",
                        path.display(),
                        index + 1
                    );
                }
            }
        }
    }
    assert!(references > 150, "{references}");
}

#[test]
fn links_of_the_docs_lead_to_files_and_headings() {
    for (path, text) in files(&["md"]) {
        let prose: String = text.split("```").step_by(2).collect();
        let links = prose
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.starts_with("http")) {
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                _ => normal(&path.parent().expect("a folder").join(file)),
            };
            assert!(target.exists(), "{}: there is no {link}", path.display());
            if heading.is_empty() || target.is_dir() {
                continue;
            }
            let text = std::fs::read_to_string(&target).expect("text");
            let anchors = headings(&text).into_iter().map(anchor);
            assert!(
                anchors.into_iter().any(|anchor| anchor == heading),
                "{}: there is no heading {link}",
                path.display()
            );
        }
    }
}

/// `path` without "..".
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        if part == Component::ParentDir {
            normal.pop();
        } else {
            normal.push(part);
        }
    }
    normal
}
