//! Parts of every kind on simulated boards: drives, gratings and servo loops included.

mod bead;
mod panel;
mod saddle;
mod stir;
mod taught_seam;

use config::machine::MachineFile;
use host_link::events::{Event, Phase};
use host_link::{Command, Remote};
use job::{Job, JobError, Names, Work};
use nc::{Options, interpret};
use parts::PartFile;
use report::{Ended, Outcome, Report};
use system_tests::{NoOperator, Operator, shipped};
use world::Surroundings;
use world::simulated::SimulatedBoards;

fn machine(name: &str) -> MachineFile {
    MachineFile::read(&shipped(&format!("machines/{name}.toml"))).unwrap()
}

/// The text of a shipped file.
fn text(name: &str) -> String {
    std::fs::read_to_string(shipped(name)).unwrap()
}

/// A shipped part with something `new` in place of something `old`.
fn part_with(name: &str, changes: &[(&str, &str)]) -> PartFile {
    let mut text = text(name);
    for (old, new) in changes {
        assert!(text.contains(old), "{name} has no {old}");
        text = text.replace(old, new);
    }
    PartFile::parse(&shipped(name), &text).unwrap()
}

/// What comes of `work` on a simulated `machine`, judged by `part`.
fn made(machine: &MachineFile, work: Work, part: &PartFile, operator: &mut dyn Operator) -> Ended {
    let job = Job {
        machine,
        work,
        part: Some(part),
        speed_m_per_min: None,
        from_line: None,
        surroundings: Surroundings::default().into(),
        spooling: Default::default(),
        names: Names {
            program: "part".into(),
            machine: "machine".into(),
            seam: None,
            boards: "simulated".into(),
        },
    };
    let mut boards = SimulatedBoards::new(machine.motion.kinematics.name()).unwrap();
    system_tests::run(&mut boards, &job, operator).unwrap()
}

/// Runs a program, judged by `part`, to its end.
fn welded(machine: &MachineFile, program: &str, part: &PartFile) -> Report {
    let program = interpret(program, Options::default()).unwrap();
    let report = made(machine, Work::Program(&program), part, &mut NoOperator).report;
    assert_eq!(report.outcome, Outcome::Finished, "{report}");
    report
}

/// Keys of the figures beyond their limits.
fn exceeded(report: &Report) -> Vec<&'static str> {
    report.exceeded().map(|figure| figure.key).collect()
}

fn value(report: &Report, key: &str) -> f64 {
    let figure = report.figures.iter().find(|figure| figure.key == key);
    figure.unwrap_or_else(|| panic!("no {key}")).value
}
