//! The shipped leaf, wrong curves, speeds, and made-up runs.

mod plans;
mod runs;
mod speeds;
mod wrong;

use crate::{Part, PartContext, Plan};
use cam::path::{PlannedPath, Planner};
use config::machine::MachineFile;
use nc::{Motion, Options, interpret};
use std::path::{Path, PathBuf};

/// A quarter of a circle of 30 mm about the origin, from X30 to Y30.
const QUARTER: &str = "\
[bead]
lead_mm = 5.0
power_w = 1500.0
window_mm_s = [4.0, 16.0]
[bead.nurbs]
degree = 2
control_points_mm = [[30.0, 0.0, 0.0], [30.0, 30.0, 0.0], [0.0, 30.0, 0.0]]
weights = [1.0, 0.7071067811865476, 1.0]
knots = [0, 0, 0, 1, 1, 1]
";

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn machine() -> MachineFile {
    MachineFile::read(&shipped("machines/wire-arc.toml")).unwrap()
}

fn leaf() -> String {
    std::fs::read_to_string(shipped("programs/leaf.toml")).unwrap()
}

/// Plans a part for a machine; what it names lies with the shipped programs.
fn plan(part: &str, machine: &MachineFile) -> anyhow::Result<Plan> {
    let part: Part = toml::from_str(part)?;
    let directory = shipped("programs");
    let context = PartContext {
        machine,
        directory: &directory,
        title: "leaf",
    };
    part.kind().plan(&context)
}

/// The paths of the layers.
fn feed_paths(program: &str, machine: &MachineFile) -> Vec<PlannedPath> {
    let program = interpret(program, Options::default()).unwrap();
    let planner = Planner::build(machine).unwrap();
    let paths = planner.program(&program, &machine.planning.park_axes(), None);
    paths
        .unwrap()
        .into_iter()
        .filter(|path| path.motion == Motion::Feed)
        .collect()
}
