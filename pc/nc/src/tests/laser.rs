//! M3, M4, M5 and S on machines whose beam they switch.

use super::*;
use shared::protocol::{Channel, PathAction};

fn options() -> Options {
    let setup = Setup {
        laser: Some(Laser {
            side: 1,
            full_s: 1000.0,
            full_watt: 2000.0,
        }),
        ..Setup::default()
    };
    Options {
        setup: setup.into(),
        ..Options::default()
    }
}

fn read(text: &str) -> Result<Program, String> {
    interpret(text, options()).map_err(|error| error.to_string())
}

/// What each path switches: target, action.
fn switched(text: &str) -> Vec<(Motion, Vec<(usize, PathAction)>)> {
    let program = read(text).unwrap();
    let paths = program.paths.iter().map(|path| {
        let events = path.events.iter().map(|event| match event.action {
            ProgramAction::Output(action) => (event.with_target, action),
            other => panic!("{other:?}"),
        });
        (path.motion, events.collect())
    });
    paths.collect()
}

fn gate(on: bool) -> PathAction {
    PathAction::Beam { side: 1, on }
}

fn watt(watt: f64) -> PathAction {
    PathAction::Power { side: 1, watt }
}

fn by_speed(full_mm_s: f64) -> PathAction {
    let (channel, least) = (Channel::Power(1), 0.0);
    PathAction::BySpeed {
        channel,
        full_mm_s,
        least,
    }
}

#[test]
fn m3_burns_in_motions_that_feed_and_rapids_do_not() {
    let text = "G21 G0 X0 Y0\nM3 S500\nG1 X5 F600\nX6 S1000\nX7\nX8 S0\nX9 S250\nG0 Y1\nG1 X0\nM5\nX1\nM2";
    let on_the_way = vec![
        (0, watt(1000.0)),
        (0, gate(true)),
        (1, watt(2000.0)),
        (3, gate(false)),
        (4, watt(500.0)),
        (4, gate(true)),
    ];
    let expected = [
        (Motion::Rapid, vec![]),
        (Motion::Feed, on_the_way),
        (Motion::Rapid, vec![]),
        (Motion::Feed, vec![(0, gate(true))]),
        (Motion::Feed, vec![(0, gate(false))]),
    ];
    assert_eq!(switched(text), expected);
}

#[test]
fn the_power_of_m4_follows_the_speed_over_f() {
    // As LightBurn puts it out.
    let text =
        "G0 G17 G40 G21 G54\nG90\nM4\nG0 X8Y8\nG1 Y23S500F1800\nG1 X23 F600\nM3\nX9\nG1 S0\nM5\nG0 X0\nM2";
    let on_the_way = vec![
        (0, watt(1000.0)),
        (0, by_speed(30.0)),
        (0, gate(true)),
        (1, by_speed(10.0)),
        (2, by_speed(0.0)),
    ];
    let expected = [
        (Motion::Rapid, vec![]),
        (Motion::Feed, on_the_way),
        (Motion::Rapid, vec![(0, gate(false))]),
    ];
    assert_eq!(switched(text), expected);
}

#[test]
fn the_end_and_another_tool_switch_the_beam_off() {
    for end in ["M2", "M6 T2\nG0 X9\nM2", "%"] {
        let paths = switched(&format!("G21 G0 X0\nT1 M61 Q1\nM3 S5\nG1 X5 F600\n{end}"));
        let last = paths.iter().flat_map(|(_, events)| events).last();
        assert_eq!(last, Some(&(0, gate(false))), "{end}");
    }
}

#[test]
fn after_a_weld_the_beam_is_told_its_power_again() {
    let text = "G21 G0 X0\nM4 S500\nG1 X5 F600\nM5\nWELDON=root\nG1 X6\nWELDOFF\nM4\nG1 X7\nM2";
    let program = read(text).unwrap();
    let mut feeds = program.paths.iter().filter(|path| path.motion == Motion::Feed);
    let last = &feeds.next_back().unwrap().events;
    for action in [watt(1000.0), by_speed(10.0), gate(true)] {
        let action = ProgramAction::Output(action);
        assert!(
            last.iter().any(|event| event.action == action),
            "{action:?}: {last:?}"
        );
    }
}

#[test]
fn what_a_beam_cannot_do_is_refused() {
    for (text, problem) in [
        (
            "M3 S1001\nG1 X5 F600\nM2",
            "line 2, column 4: S1001 is more than S1000, the full power",
        ),
        ("M4 S10\nG93 G1 X5 F2\nM2", "M4: with G93 there is no F"),
        ("M3\nG1 X5 F600\nM2", "without it the beam is off"),
        ("M3 S-1\nG1 X5 F600\nM2", "must be 0"),
        (
            "M3 S5\nWELDON=root\nG1 X5 F600\nWELDOFF\nM2",
            "line 3, column 4: M3: a weld with weld data switches its beam itself",
        ),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains(problem), "{error}");
    }
}

#[test]
fn a_beam_is_told_as_one() {
    let mut told = Vec::new();
    let text = "G21\nM4\nG1 X5 F600 S250\nM3\nM5\nM2";
    explain(text, options(), |block| told.extend(block.facts)).unwrap();
    for fact in [
        "from here the beam burns in motions that feed, with the power of S in proportion to the speed",
        "S of the beam from here: 250",
        "power of beam 2: 500 W (of a spindle r/min) with this motion",
        "the power follows the speed, full at 600 mm/min with this motion",
        "gate of beam 2 opens with this motion",
        "from here the beam burns in motions that feed, with the power of S",
        "from here the beam is off",
    ] {
        assert!(told.iter().any(|told| told == fact), "{fact}: {told:#?}");
    }
    assert!(told.iter().all(|fact| !fact.contains("spindle turns")));
}

#[test]
fn a_beam_taps_no_thread() {
    let said = read("G21 G90\nG0 X0 Y0 Z10\nS500 M3\nF500\nG84 X1 Z-5 R2\nM2").unwrap_err();
    assert!(
        said.contains("M3, M4 and M5 switch a beam here: taps need a spindle"),
        "{said}"
    );
    let said = read("G21 G90\nG0 X0 Y0 Z10\nS500 M3\nG95 F0.5\nG1 X1\nM2").unwrap_err();
    assert!(said.contains("which does not turn"), "{said}");
}
