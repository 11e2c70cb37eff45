//! The post-processor of FreeCAD, run on stored jobs, and the example of the minimal post: our reader must find in
//! the programs what the jobs ask for, and the shipped machines must take them.

mod compare;
mod expected;
mod found;
mod lines;
mod refused;
mod stored;

use cam::path::Planner;
use compare::difference;
use config::machine::MachineFile;
use nc::Options;
use stored::{StoredJob, python_is_there};
use system_tests::shipped;

/// Stored jobs, and the machine for each.
const JOBS: [(&str, &str); 6] = [
    ("contour", "stir-gantry"),
    ("pocket", "stir-gantry"),
    ("drilling", "stir-gantry"),
    ("plate", "stir-gantry"),
    ("five-axis", "ac-head"),
    ("beam", "ac-head"),
];

#[test]
fn programs_lead_where_their_jobs_do_with_their_feeds_and_powers() {
    if !python_is_there() {
        return;
    }
    for (name, _) in JOBS {
        assert_as_the_job_asks(name, &StoredJob::shipped(name));
    }
}

#[test]
fn they_do_so_with_other_arguments() {
    if !python_is_there() {
        return;
    }
    for (name, _) in JOBS {
        for more in [
            "--modal --no-header",
            "--no-comments --tolerance=0",
            "--precision=6",
        ] {
            let mut job = StoredJob::shipped(name);
            job.arguments = format!("{} {more}", job.arguments);
            assert_as_the_job_asks(&format!("{name} {more}"), &job);
        }
    }
}

/// Checks every motion of a job's program.
fn assert_as_the_job_asks(name: &str, job: &StoredJob) {
    let text = job.program();
    let (expected, found) = (expected::blocks(job), found::lines(&text));
    assert!(expected.len() > 10, "{name}: {} blocks", expected.len());
    let decimals = job.argument("--precision").unwrap_or("4");
    let decimals = decimals.parse().expect("a number");
    for (block, line) in expected.iter().zip(&found) {
        let wrong = difference(block, line, decimals);
        assert!(
            wrong.is_none(),
            "{name}: {wrong:?} is not as in {block:?}\n{line:?}\n{text}"
        );
    }
    assert_eq!(expected.len(), found.len(), "{name}\n{text}");
    assert_well_formed(job, &text);
}

#[test]
fn a_beam_is_switched_without_a_stop_and_no_more_often_than_it_must() {
    if !python_is_there() {
        return;
    }
    let text = StoredJob::shipped("beam").program();
    let switched: Vec<&str> = text.lines().filter(|line| line.starts_with('M')).collect();
    let cuts = ["M67 E0 Q1200.0", "M62 P0", "M62 P0"];
    let marks = ["M67 E0 Q450.5", "M62 P0", "M63 P0", "M62 P0", "M67 E0 Q300.0"];
    assert_eq!(switched, [&cuts[..], &marks, &["M2"]].concat(), "{text}");
}

#[test]
fn a_program_is_written_to_a_file_as_it_is_returned() {
    if !python_is_there() {
        return;
    }
    let job = StoredJob::shipped("contour");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("contour.ngc");
    let output = stored::run(&job.file, &job.arguments, Some(&file));
    assert!(output.status.success() && output.stdout.is_empty(), "{output:?}");
    assert_eq!(std::fs::read_to_string(&file).expect("a program"), job.program());
}

/// Checks what holds of the text of every program.
fn assert_well_formed(job: &StoredJob, text: &str) {
    let comments = text.matches('(').count();
    assert_eq!(comments == 0, job.has_flag("--no-comments"), "{text}");
    assert_eq!(
        text.starts_with("(from FreeCAD"),
        !job.has_flag("--no-header") && comments > 0,
        "{text}"
    );
    let control = match job.argument("--tolerance") {
        Some("0") => "G61".to_owned(),
        tolerance => format!("G64 P{}", tolerance.unwrap_or("0.05")),
    };
    let turns = text
        .lines()
        .any(|line| line.starts_with('G') && line.contains(" A"));
    assert!(text.contains(&format!("G21 G90 G17 G94 {control}\n")), "{text}");
    assert_eq!(text.contains("\nG43.4\n"), turns, "{text}");
    assert!(text.ends_with("\nM2\n") && !text.contains("-0.0000 "), "{text}");
    for line in text.lines() {
        let nested = line.matches('(').count() > 1 || line.matches(')').count() > 1;
        assert!(!nested && line == line.trim(), "{line}");
    }
}

#[test]
fn shipped_machines_take_the_programs() {
    if !python_is_there() {
        return;
    }
    for (name, machine) in JOBS {
        assert_planned(name, machine, &StoredJob::shipped(name).program());
    }
}

#[test]
fn the_ac_head_takes_the_example_of_the_minimal_post_and_burns_in_its_feeds_only() {
    let readme = std::fs::read_to_string(shipped("posts/README.md")).expect("posts/README.md");
    let example = readme.split("```").nth(1).expect("a block of code");
    let steps: Vec<_> = found::lines(example)
        .into_iter()
        .flat_map(|line| line.steps)
        .collect();
    let burning: Vec<bool> = steps.iter().map(|step| step.tool.is_some()).collect();
    let feeds: Vec<bool> = steps.iter().map(|step| step.feed.is_some()).collect();
    assert!(burning.contains(&true) && burning == feeds, "{steps:?}");
    assert_planned("posts/README.md", "ac-head", example);
}

/// Checks that a machine, after its search of the reference marks, can run a program.
fn assert_planned(name: &str, machine: &str, text: &str) {
    let file = shipped(&format!("machines/{machine}.toml"));
    let machine = MachineFile::read(&file).unwrap_or_else(|error| panic!("{error}"));
    let planner = Planner::build(&machine).unwrap_or_else(|error| panic!("{error}"));
    let start = machine.homed_axes();
    let options = Options {
        setup: planner.setup(&start).into(),
        ..Options::default()
    };
    let program = nc::interpret(text, options).unwrap_or_else(|error| panic!("{name}: {error}\n{text}"));
    let paths = planner
        .program(&program, &start, None)
        .unwrap_or_else(|error| panic!("{name}: {error}\n{text}"));
    assert!(!paths.is_empty(), "{name}");
}
