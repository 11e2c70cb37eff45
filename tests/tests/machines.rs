//! The shipped job of every machine without a tracker, on simulated boards: from its marks to its park position,
//! within the limits of its part.

use host_link::boards::simulated::SimulatedBoards;
use host_link::machine::MachineFile;
use host_link::nc::{Options, interpret};
use host_link::part::PartFile;
use host_link::weld::{Ended, Job, Names, Silent, Work, run};
use std::sync::atomic::AtomicBool;
use system_tests::shipped;

/// Machines and their jobs.
const JOBS: [(&str, &str); 4] = [
    ("pipe-welder", "programs/saddle-320-80.ngc"),
    ("ac-head", "programs/panel.toml"),
    ("wire-arc", "programs/leaf.ngc"),
    ("stir-gantry", "programs/stir-contour.ngc"),
];

fn weld(machine: &str, job: &str) -> Ended {
    let file = shipped(&format!("machines/{machine}.toml"));
    let machine_file = MachineFile::read(&file).unwrap_or_else(|error| panic!("{error}"));
    let job_file = shipped(job);
    let text = std::fs::read_to_string(&job_file).expect("a shipped job");
    // A job that is a part has to be taught first.
    let program = (!job.ends_with(".toml"))
        .then(|| interpret(&text, Options::default()).unwrap_or_else(|error| panic!("{job}: {error}")));
    let part = PartFile::of_program(&job_file).unwrap_or_else(|error| panic!("{error}"));
    assert!(part.is_some(), "{job} is judged by nothing");
    let job = Job {
        machine: &machine_file,
        work: program.as_ref().map_or(Work::TeachAndMake, Work::Program),
        part: part.as_ref(),
        speed_m_per_min: None,
        seam: None,
        seed: 1,
        names: Names {
            program: job.into(),
            machine: machine.into(),
            seam: None,
            boards: "simulated".into(),
        },
    };
    let mut boards = SimulatedBoards::new(machine).unwrap_or_else(|error| panic!("{error}"));
    run(&mut boards, &job, &AtomicBool::new(false), &mut Silent).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_shipped_job_keeps_the_limits_of_its_part() {
    for (machine, job) in JOBS {
        let ended = weld(machine, job);
        let report = &ended.report;
        println!("{report}");
        assert!(ended.error.is_none(), "{job}: {:?}", ended.error);
        assert!(
            report.figures.iter().any(|figure| figure.limit.is_some()),
            "{report}"
        );
        let exceeded: Vec<_> = report.exceeded().map(|figure| figure.key).collect();
        assert!(exceeded.is_empty(), "{exceeded:?}\n{report}");
        assert_eq!((report.lost_ticks.total(), report.telemetry_gaps.total()), (0, 0));
        assert_eq!(report.weld_ticks.unknown, 0, "{report}");
        let late = (report.motion_s - report.planned_motion_s).abs();
        assert!(
            late < 0.002 * report.planned_motion_s + 0.05,
            "{late} s\n{report}"
        );
    }
}
