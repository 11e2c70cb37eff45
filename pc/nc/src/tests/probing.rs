//! Motions with the probe: what ends them, and what is known after them.

use super::*;
use crate::probing::{Probe, ProbeInput};
use std::sync::Arc;

/// With a probe at the second input.
fn options() -> Options {
    Options {
        setup: Arc::new(Setup {
            probe: Some(ProbeInput {
                input: 1,
                touching: true,
            }),
            ..Setup::default()
        }),
        ..Options::default()
    }
}

fn with_probe(body: &str) -> Result<Program, NcError> {
    interpret(&format!("{HEADER}{body}"), options())
}

fn refused(body: &str) -> String {
    let error = with_probe(body).unwrap_err();
    format!(
        "{}: {}",
        i64::from(error.place.line) - HEADER.lines().count() as i64,
        error.problem
    )
}

/// The tip with A B C at 0.
fn at(x: f64, y: f64, z: f64) -> [f64; 6] {
    [x, y, z, 0.0, 0.0, 0.0]
}

fn ends(program: &Program) -> Vec<[Option<f64>; 3]> {
    let targets = program.paths.iter().flat_map(|path| &path.targets);
    targets
        .map(|target| [0, 1, 2].map(|axis| target.words.axes[axis]))
        .collect()
}

#[test]
fn a_motion_with_the_probe_is_a_path_of_its_own() {
    let program = with_probe("F300\nG1 X10\nG38.2 Z-20 F60\nG1 X20\nG38.5 Z5\nM2").unwrap();
    let paths = &program.paths[2..];
    let probes: Vec<_> = paths
        .iter()
        .map(|path| path.probe.map(|p| (p.code, p.input, p.on, p.must, p.away)))
        .collect();
    assert_eq!(
        probes,
        [
            None,
            Some(("G38.2", 1, true, true, false)),
            None,
            Some(("G38.5", 1, false, false, true))
        ]
    );
    assert_eq!(paths[1].targets.len(), 1);
    assert_eq!(paths[1].targets[0].feed, Some(FeedRate::PerMinute(60.0)));
    assert_eq!(
        ends(&program)[3..],
        [
            [Some(10.0), Some(0.0), Some(-20.0)],
            [Some(20.0), None, None],
            [Some(20.0), Some(0.0), Some(5.0)]
        ]
    );
    assert!(program.branches, "it is run from its beginning only");
    let told = &program.notices.last().unwrap();
    assert!(told.text.starts_with("G38."), "{}", told.text);
    // An input that goes off while the probe touches.
    let mut options = options();
    let mut setup = (*options.setup).clone();
    setup.probe.as_mut().unwrap().touching = false;
    options.setup = Arc::new(setup);
    let text = format!("{HEADER}G38.3 Z-5 F60\nG38.4 Z5\nM2");
    let program = interpret(&text, options).unwrap();
    let on: Vec<_> = program.paths.iter().filter_map(|path| path.probe).collect();
    assert_eq!(on.iter().map(|probe| probe.on).collect::<Vec<_>>(), [false, true]);
}

#[test]
fn the_program_goes_on_with_what_was_found() {
    let body = "G10 L2 P1 X100 Y0 Z10\nG0 X0 Y0 Z20\nG38.2 Z-20 F60\n#1=#5063\nG92 Z0\nG1 Z5\nG0 X[#5061+1] Z[#1]\nM2";
    let program = with_probe(body).unwrap();
    // Until it is known, it touches at its end: Z-20 of the program is -10 of the machine, and Z0 from there on.
    let shape = ends(&program);
    assert_eq!(shape[3], [Some(100.0), Some(0.0), Some(-10.0)]);
    assert_eq!(shape[4][2], Some(-5.0));
    // It touched at -2.5 of the machine, which is -12.5 of the program, and stood a little lower.
    let found = Answer::Probe(Probed {
        met: Some(at(100.0, 0.0, -2.5)),
        stands: at(100.0, 0.0, -2.53),
    });
    let program = program.answered(&[found]).unwrap();
    let shape = ends(&program);
    assert_eq!(shape[3], [Some(100.0), Some(0.0), Some(-2.53)]);
    // G92 is where the tip stands.
    assert!((shape[4][2].unwrap() - (-2.53 + 5.0)).abs() < 1e-9);
    assert!((shape[5][0].unwrap() - 101.0).abs() < 1e-9);
    assert!((shape[5][2].unwrap() - (-2.53 - 12.5)).abs() < 1e-9);
    assert!(
        program.notices.is_empty(),
        "nothing is taken for granted any more"
    );
}

#[test]
fn conditions_see_whether_it_touched() {
    let body = "o1 while [#1 LT 3]\nG38.3 X[10 * [#1 + 1]] F60\no2 if [#5070 EQ 1]\no1 break\no2 endif\n#1=[#1+1]\n\
                o1 endwhile\nG0 Z[#5061]\nM2";
    let program = with_probe(body).unwrap();
    let probes = |program: &Program| program.paths.iter().filter(|path| path.probe.is_some()).count();
    assert_eq!(probes(&program), 3, "they are taken to touch nothing");
    let none = |x| {
        Answer::Probe(Probed {
            met: None,
            stands: at(x, 0.0, 0.0),
        })
    };
    let program = program.answered(&[none(10.0)]).unwrap();
    assert_eq!(probes(&program), 3);
    let met = Answer::Probe(Probed {
        met: Some(at(17.25, 0.0, 0.0)),
        stands: at(17.3, 0.0, 0.0),
    });
    let touched = program.answered(&[none(10.0), met]).unwrap();
    assert_eq!(probes(&touched), 2);
    assert_eq!(ends(&touched).last().unwrap()[2], Some(17.25));
    let program = program.answered(&[none(10.0), none(20.0), none(30.0)]).unwrap();
    assert_eq!(probes(&program), 3);
    // Where it did not, the end of the motion counts.
    assert_eq!(ends(&program).last().unwrap()[2], Some(30.0));
}

#[test]
fn places_are_in_the_units_and_the_system_of_the_program() {
    let body = "G20\nG10 L2 P1 X1 R90\nG38.2 X1 Y0 F10\n(DEBUG,#5061 #5062 #5063 #5070)\nM2";
    let program = with_probe(body).unwrap();
    // X of the program is Y of the machine; from X1 inch.
    let found = Answer::Probe(Probed {
        met: Some(at(25.4, 12.7, 0.0)),
        stands: at(25.4, 12.8, 0.0),
    });
    let program = program.answered(&[found]).unwrap();
    let said = &program.notices.last().unwrap().text;
    let numbers: Vec<f64> = said.split(' ').map(|number| number.parse().unwrap()).collect();
    for (number, expected) in numbers.iter().zip([0.5, 0.0, 0.0, 1.0]) {
        assert!((number - expected).abs() < 1e-6, "{said}");
    }
}

#[test]
fn a_probe_that_touched_at_once_has_moved_nothing() {
    let program = with_probe("G38.3 Z-5 F60\nG0 X10\nM2").unwrap();
    let found = Answer::Probe(Probed {
        met: Some(at(0.0, 0.0, 0.0)),
        stands: at(0.0, 0.0, 0.0),
    });
    let program = program.answered(&[found]).unwrap();
    let path = &program.paths[2];
    assert_eq!((path.motion, path.targets.len()), (Motion::Stand, 0));
    assert!(path.probe.is_some());
    assert_eq!(program.paths.len(), 4);
}

#[test]
fn a_way_of_nothing_meets_nothing() {
    let program = with_probe("#5070=1\nG38.3 Z0 F60\nG0 X[#5070 + 5]\nM2").unwrap();
    assert!(program.paths.iter().all(|path| path.probe.is_none()));
    assert_eq!(ends(&program).last().unwrap()[0], Some(5.0));
}

#[test]
fn g31_is_for_its_block() {
    let program = with_probe("G31 Z-5 F60\nG1 Z5 F300\nM2").unwrap();
    let probe: Vec<Probe> = program.paths.iter().filter_map(|path| path.probe).collect();
    assert_eq!(
        probe.iter().map(|p| (p.code, p.must)).collect::<Vec<_>>(),
        [("G31", false)]
    );
    assert_eq!(
        refused("G31 Z-5 F60\nZ5\nM2"),
        format!("2: {}", Problem::NoMotion)
    );
    // G38 is modal.
    let program = with_probe("G38.3 Z-5 F60\nZ-10\nM2").unwrap();
    assert_eq!(
        program.paths.iter().filter(|path| path.probe.is_some()).count(),
        2
    );
}

#[test]
fn what_a_probe_cannot_do_is_said() {
    for (body, why) in [
        ("G38.2 Z-5\nM2", "F"),
        ("G38.2 F60\nM2", "elsewhere"),
        ("G93\nG38.2 Z-5 F2\nM2", "write G94"),
        ("G38.2 Z-5 A10 F60\nM2", "turns or extends nothing"),
        ("G38.2 Z0 F60\nM2", "elsewhere"),
        ("F60\nM62 P0\nG38.2 Z-5\nM2", "M62: no beam or tracking"),
        ("F60\nWELDON=ROOT\nG38.2 Z-5\nWELDOFF\nM2", "write WELDOFF"),
        ("G38 Z-5 F60\nM2", "write G38.2"),
    ] {
        let error = with_probe(body).unwrap_err().to_string();
        assert!(error.contains(why), "{body}: {error}");
    }
    let error = run("G38.2 Z-5 F60\nM2").unwrap_err().to_string();
    assert!(error.contains("this machine has no probe"), "{error}");
}
