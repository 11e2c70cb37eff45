//! Every machine and function is counted, and what is counted is no error.

use benchmarks::kinematics::{FUNCTIONS, Outcome, SAMPLES, Visitor, samples, visit};
use benchmarks::machine::{Machine, machines};
use benchmarks::machine_files::pack;
use benchmarks::meter::{Meter, measured};
use benchmarks::record::Record;
use shared::kinematics::KinematicsConfig;
use shared::trajectory::BoardPlanner;
use std::path::Path;

fn packed() -> Vec<u8> {
    pack(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines")).expect("shipped files")
}

/// Counts 7 instructions a call.
struct Seven;

impl Meter for Seven {
    fn count(&mut self, call: &mut dyn FnMut()) -> u32 {
        measured(call);
        7
    }
}

#[test]
fn every_machine_and_function_has_a_record() {
    let mut text = String::new();
    benchmarks::run(
        "kinematics",
        &packed(),
        &mut Seven,
        &mut text,
        &mut BoardPlanner::new(),
    )
    .expect("it runs");
    let mut lines = text.lines();
    let mut machines: Vec<&str> = Vec::new();
    let calls = SAMPLES as u32;
    while let Some(Record::Count { subject, .. }) = lines.clone().next().and_then(Record::parse) {
        machines.push(subject);
        for name in FUNCTIONS {
            let line = lines.next().expect("a line for each function");
            let Some(Record::Count {
                subject: machine,
                function,
                tally,
            }) = Record::parse(line)
            else {
                panic!("{line} is no record");
            };
            assert_eq!((machine, function), (subject, name));
            assert_eq!(
                (tally.calls, tally.total, tally.worst),
                (calls, u64::from(calls) * 7, 7)
            );
        }
    }
    let last: Vec<_> = lines.map(Record::parse).collect();
    assert!(matches!(last[..], [Some(Record::Checksum(_))]), "{last:?}");
    let mut all = KinematicsConfig::NAMES.to_vec();
    // Of a list of joints there is no file; what it costs is in the mathematics.
    all.retain(|name| *name != "serial-chain");
    all.sort_unstable();
    assert_eq!(machines, all);
}

/// Numbers seen of each function, all of them finite.
#[derive(Default)]
struct Finite([usize; FUNCTIONS.len()]);

impl Visitor for Finite {
    fn visit<R: Outcome>(&mut self, index: usize, call: impl Fn() -> R) {
        call().each(&mut |x| {
            assert!(x.is_finite(), "{}", FUNCTIONS[index]);
            self.0[index] += 1;
        });
    }
}

#[test]
fn no_function_fails_on_any_sample() {
    for machine in machines(&packed()) {
        let (kinematics, limits) = machine.expect("readable").build().expect("valid");
        let mut finite = Finite::default();
        for sample in samples(&kinematics, &limits) {
            visit(&kinematics, &sample.expect("a pose"), &mut finite);
        }
        assert_eq!(finite.0, [0, 9, 6, 6, 12, 18].map(|numbers| numbers * SAMPLES));
    }
}

#[test]
fn samples_are_the_same_every_time_and_differ_among_themselves() {
    let file = packed();
    let machine = machines(&file).next().expect("a machine").expect("readable");
    let (kinematics, limits) = machine.build().expect("valid");
    let all: Vec<_> = samples(&kinematics, &limits).collect();
    assert!(samples(&kinematics, &limits).eq(all.iter().cloned()));
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn a_file_that_is_cut_off_is_an_error_and_an_end() {
    let file = packed();
    let read: Vec<Result<Machine, _>> = machines(&file[..file.len() - 1]).collect();
    let (last, before) = read.split_last().expect("machines");
    assert!(last.is_err() && before.iter().all(Result::is_ok));
    assert!(
        benchmarks::run(
            "kinematics",
            &file[1..],
            &mut Seven,
            &mut String::new(),
            &mut BoardPlanner::new()
        )
        .is_err()
    );
}

#[test]
fn an_unknown_benchmark_is_an_error() {
    assert!(
        benchmarks::run(
            "baking",
            &packed(),
            &mut Seven,
            &mut String::new(),
            &mut BoardPlanner::new()
        )
        .is_err()
    );
}
