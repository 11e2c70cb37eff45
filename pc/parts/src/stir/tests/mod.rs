//! Friction-stir parts: from the shipped one to what is refused, and what a run is worth.

mod contour;
mod judge;
mod program;

use super::*;
use crate::Part;
use cam::path::{PlannedPath, Planner};
use nc::{Motion, Options, interpret};
use std::path::{Path, PathBuf};

/// A shipped file.
fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// The text of a shipped file, with something `new` in place of something `old`.
fn changed(name: &str, old: &str, new: &str) -> String {
    let text = std::fs::read_to_string(shipped(name)).unwrap();
    assert!(text.contains(old), "{name} has no {old}");
    text.replace(old, new)
}

fn machine_with(old: &str, new: &str) -> MachineFile {
    MachineFile::parse("m.toml", &changed("machines/stir-gantry.toml", old, new)).unwrap()
}

fn machine() -> MachineFile {
    machine_with("", "")
}

fn part_of(text: &str) -> Stir {
    match toml::from_str(text).unwrap() {
        Part::Stir(part) => *part,
        other => panic!("{other:?}"),
    }
}

/// The shipped part with something `new` in place of something `old`.
fn part_with(old: &str, new: &str) -> Stir {
    part_of(&changed("programs/stir-contour.toml", old, new))
}

/// The shipped part with another contour.
fn part_along(start: &str, contour: &str) -> Stir {
    let text = std::fs::read_to_string(shipped("programs/stir-contour.toml")).unwrap();
    let (head, _) = text.split_once("start =").unwrap();
    part_of(&format!("{head}start = {start}\ncontour = [{contour}]\n"))
}

fn context(machine: &MachineFile) -> PartContext<'_> {
    PartContext {
        machine,
        directory: Path::new(""),
        title: "stir-contour",
    }
}

fn plan(part: &Stir, machine: &MachineFile) -> anyhow::Result<Plan> {
    part.plan(&context(machine))
}

/// The planned paths of a part, from the park position.
fn planned(part: &Stir, machine: &MachineFile) -> Vec<PlannedPath> {
    let program = plan(part, machine).unwrap().program;
    let read = interpret(&program, Options::default()).unwrap();
    let from = machine.planning.park_axes();
    let paths = Planner::build(machine).unwrap().program(&read, &from, None);
    paths.unwrap_or_else(|error| panic!("{error}\n{program}"))
}

/// Those along the contour.
fn along(paths: &[PlannedPath]) -> Vec<&PlannedPath> {
    let level = |path: &&PlannedPath| {
        path.motion == Motion::Feed && path.path().at(0.0).unwrap().first[2].abs() < 0.5
    };
    paths.iter().filter(level).collect()
}

/// A full circle of radius 30 that begins at `angle` from its centre \[°\].
fn circle(angle: f64, turn: &str) -> Stir {
    let (sin, cos) = angle.to_radians().sin_cos();
    let start = format!("[{:.6}, {:.6}]", 400.0 + 30.0 * cos, 225.0 + 30.0 * sin);
    part_along(
        &start,
        &format!("{{ arc_to = {start}, centre = [400.0, 225.0], turn = \"{turn}\" }}"),
    )
}
