//! Modules of the crate use one another one way only: what stands below never knows what stands above it.

use std::fs;
use std::path::{Path, PathBuf};

/// From the ground up; modules of one floor do not use each other.
const FLOORS: [&[&str]; 8] = [
    &[
        "execution_time",
        "parameter",
        "alive_supervision",
        "ticks",
        "units",
    ],
    &["geometry", "io"],
    &["kinematics", "state"],
    &["control"],
    &["config", "trajectory"],
    &["protocol"],
    &["motion", "tracking"],
    // The crate's own face.
    &["lib"],
];

fn floor(module: &str) -> usize {
    let floor = FLOORS.iter().position(|floor| floor.contains(&module));
    floor.unwrap_or_else(|| panic!("{module} has no floor in this test"))
}

fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            into.push(path);
        }
    }
}

/// Names of modules after every `crate::` of the code of a file.
fn used(text: &str) -> impl Iterator<Item = &str> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.flat_map(|line| line.split("crate::").skip(1)).map(|after| {
        after
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .next()
            .unwrap()
    })
}

#[test]
fn modules_use_only_those_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut arrows = 0;
    let mut wrong = Vec::new();
    for file in files {
        let place = file.strip_prefix(&root).unwrap().with_extension("");
        let module = place.iter().next().unwrap().to_str().unwrap();
        let text = fs::read_to_string(&file).unwrap();
        for name in used(&text) {
            assert!(
                !name.is_empty(),
                "{}: name the module after `crate::` in the same line",
                place.display()
            );
            if name == module {
                continue;
            }
            arrows += 1;
            if floor(name) >= floor(module) {
                wrong.push(format!("{} uses {name}", place.display()));
            }
        }
    }
    assert!(arrows > 200, "only {arrows} uses found");
    assert!(
        wrong.is_empty(),
        "arrows that run the wrong way:\n{}",
        wrong.join("\n")
    );
}
