//! Every program of the planner's benchmark comes to its end on the PC.

use benchmarks::machine_files::pack;
use benchmarks::meter::{Meter, measured};
use benchmarks::planner::FUNCTIONS;
use benchmarks::record::{NOTHING, Record};
use shared::trajectory::BoardPlanner;
use std::path::Path;

struct Seven;

impl Meter for Seven {
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        measured(call);
        7
    }
}

#[test]
fn every_program_has_its_pushes_and_its_ticks() {
    let machines = pack(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines")).expect("shipped files");
    let mut text = String::new();
    benchmarks::run(
        "planner",
        &machines,
        &mut Seven,
        &mut text,
        &mut BoardPlanner::new(),
    )
    .expect("all programs");
    let mut programs = Vec::new();
    for line in text.lines() {
        match Record::parse(line).expect(line) {
            Record::Call {
                subject, function, ..
            } if function == NOTHING => programs.push((subject, 0, 0)),
            Record::Call {
                subject, function, ..
            } => {
                let (program, pushes, ticks) = programs.last_mut().expect("begun");
                assert_eq!(*program, subject);
                *pushes += u32::from(function == FUNCTIONS[0]);
                *ticks += u32::from(function == FUNCTIONS[1]);
            }
            Record::Checksum(_) => {}
            Record::Count { .. } => panic!("{line}"),
        }
    }
    let pushes: Vec<u32> = programs.iter().map(|(_, pushes, _)| *pushes).collect();
    assert_eq!(pushes, [12, 10, 300, 40, 40, 300]);
    // A second or more each: none stands still, and none is there at once.
    assert!(
        programs
            .iter()
            .all(|(_, _, ticks)| (1000..20_000).contains(ticks))
    );
}
