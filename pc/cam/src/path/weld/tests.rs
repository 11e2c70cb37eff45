//! Welds with weld data on the shipped wire-arc machine: where the tip goes, what is switched, and what is refused.

use crate::path::{PathError, PlannedPath, Planner};
use config::machine::MachineFile;
use config::weld_data::WeldData;
use nalgebra::Vector3;
use nc::{Motion, Options, interpret};
use shared::protocol::{Channel, PathAction};
use shared::trajectory::CHANNELS;

const START: &str = "G21 G90 G43.4\nG53 G0 X500 Y400 Z400 A0 B0 C0\nG0 X-100 Y0 Z50 A0 B0 C0\nF480\n";

fn planned(data: &str, program: &str) -> Result<Vec<PlannedPath>, PathError> {
    planned_on("wire-arc", data, &format!("{START}{program}"))
}

fn planned_on(machine: &str, data: &str, program: &str) -> Result<Vec<PlannedPath>, PathError> {
    let file = format!("{}/../../machines/{machine}.toml", env!("CARGO_MANIFEST_DIR"));
    let mut machine = MachineFile::read(file.as_ref()).unwrap();
    machine.welding = WeldData::parse("w.toml", data).unwrap();
    let program = interpret(program, Options::default()).unwrap();
    let planner = Planner::build(&machine).unwrap();
    planner.program(&program, &machine.homed_axes(), None)
}

fn error(data: &str, program: &str) -> String {
    planned(data, program).unwrap_err().to_string()
}

/// Tips along a path, each with the path length to it and the feed there.
fn tips(path: &PlannedPath) -> Vec<(f64, Vector3<f64>, f64)> {
    let mut s = 0.0;
    let mut tips = Vec::new();
    for leg in path.legs() {
        let element = leg.unwrap().element;
        let count = 200;
        for i in 0..=count {
            let u = element.length * f64::from(i) / f64::from(count);
            let value: [f64; CHANNELS] = element.at(u).value;
            tips.push((s + u, Vector3::new(value[0], value[1], value[2]), element.feed));
        }
        s += element.length;
    }
    tips
}

/// How long the tips take at their feeds \[s\].
fn time_s(tips: &[(f64, Vector3<f64>, f64)]) -> f64 {
    let times = tips.windows(2).map(|pair| (pair[1].0 - pair[0].0) / pair[0].2);
    times.sum()
}

/// The least and the largest distance of a path from the Z axis \[mm\].
fn radii(path: &PlannedPath) -> (f64, f64) {
    let radii = tips(path).into_iter().map(|(_, tip, _)| tip.x.hypot(tip.y));
    radii.fold((f64::MAX, 0.0_f64), |(least, most), r| {
        (least.min(r), most.max(r))
    })
}

/// The path on which the beam goes on.
fn weld(paths: &[PlannedPath]) -> &PlannedPath {
    let opens = |path: &&PlannedPath| {
        events(path)
            .iter()
            .any(|(_, action)| matches!(action, PathAction::Beam { on: true, .. }))
    };
    paths.iter().find(opens).unwrap()
}

fn events(path: &PlannedPath) -> Vec<(f64, PathAction)> {
    let legs = path.legs().flat_map(|leg| leg.unwrap().events);
    legs.map(|event| (event.s_mm, event.action)).collect()
}

fn power(value: f64, over_mm: f64) -> PathAction {
    PathAction::Level {
        channel: Channel::Power(0),
        value,
        over_mm,
    }
}

const WEAVE: &str =
    "[w]\npower = 2000.0\nweave = { form = \"sine\", amplitude_mm = 2.0, frequency_hz = 1.0 }\n";

#[test]
fn a_weave_swings_about_its_seam_and_goes_along_it_at_the_feed() {
    let paths = planned(WEAVE, "WELDON=w\nG1 X0\nWELDOFF\nM2").unwrap();
    let tips = tips(weld(&paths));
    let (first, last) = (tips[0].1, tips[tips.len() - 1].1);
    assert!((first - Vector3::new(-100.0, 0.0, 50.0)).norm() < 1e-6);
    assert!((last - Vector3::new(0.0, 0.0, 50.0)).norm() < 1e-6);
    // 100 mm in 25 half periods of 4 mm, beginning to the left: a sine whose ends are those of a cosine.
    for (_, tip, _) in &tips {
        let x = tip.x + 100.0;
        assert!((tip.z - 50.0).abs() < 1e-3);
        if (2.0..=98.0).contains(&x) {
            let wanted = 2.0 * (2.0 * std::f64::consts::PI * x / 8.0).sin();
            assert!(
                (tip.y - wanted).abs() < 2e-3,
                "at {x}: {} and not {wanted}",
                tip.y
            );
        }
    }
    // Time at the feeds of its stretches, against 8 mm/s along the seam.
    let time = time_s(&tips);
    assert!((time - 100.0 / 8.0).abs() < 1e-3, "{time}");
}

#[test]
fn a_weave_follows_an_arc_and_a_smooth_curve_across_their_own_direction() {
    let paths = planned(WEAVE, "WELDON=w\nG3 X100 I100 J0\nWELDOFF\nM2").unwrap();
    let (least, most) = radii(weld(&paths));
    assert!(
        (least - 98.0).abs() < 2e-3 && (most - 102.0).abs() < 2e-3,
        "{least} {most}"
    );
    // A run of G1 with G64 alone is one smooth curve.
    let points: String = (1..=60)
        .map(|i| {
            let angle = std::f64::consts::PI * (1.0 - f64::from(i) / 60.0);
            format!("G1 X{:.5} Y{:.5}\n", 100.0 * angle.cos(), -100.0 * angle.sin())
        })
        .collect();
    let paths = planned(WEAVE, &format!("WELDON=w\n{points}WELDOFF\nM2")).unwrap();
    let (least, most) = radii(weld(&paths));
    assert!(
        (least - 98.0).abs() < 0.02 && (most - 102.0).abs() < 0.02,
        "{least} {most}"
    );
}

#[test]
fn a_triangle_dwells_along_its_sides() {
    let data = "[w]\npower = 1.0\nweave = { form = \"triangle\", amplitude_mm = 1.5, frequency_hz = 1.0, dwell_s = 0.2 }";
    let paths = planned(data, "WELDON=w\nG1 X0\nWELDOFF\nM2").unwrap();
    let tips = tips(weld(&paths));
    let along: f64 = tips
        .windows(2)
        .filter(|pair| pair.iter().all(|tip| (tip.1.y.abs() - 1.5).abs() < 1e-6))
        .map(|pair| (pair[1].0 - pair[0].0) / pair[0].2)
        .sum();
    assert!((along - 0.4 * 12.5).abs() < 1e-2, "{along}");
}

const FULL: &str = "[root]\npower = 2000.0\noutputs = [\"gas\"]\nlevels = { wire_feed = 8.0 }\npre_flow_s = 0.5\n\
    post_flow_s = 1.5\nignition = { power = 1500.0, time_s = 0.4 }\nramp_up = { power = 0.0, over_mm = 5.0 }\n\
    ramp_down = { power = 900.0, over_mm = 8.0 }\ncrater_fill = { power = 700.0, time_s = 0.6 }\n";

#[test]
fn a_weld_flows_ignites_ramps_and_fills_its_crater_in_order() {
    let paths = planned(FULL, "WELDON=root\nG1 X0\nWELDOFF\nM2").unwrap();
    let weld_at = paths.iter().position(|path| path.weld().is_some()).unwrap();
    let gas = |on| (0.0, PathAction::Output { output: 0, on });
    assert_eq!(events(&paths[weld_at - 1]), [gas(true)]);
    let path = &paths[weld_at];
    assert_eq!(path.dwell_before_s, 0.5);
    let events = events(path);
    let levels: Vec<_> = events
        .iter()
        .filter(|(_, action)| {
            matches!(
                action,
                PathAction::Level {
                    channel: Channel::Power(0),
                    ..
                }
            )
        })
        .collect();
    // From rest to rest at 1 mm/s the ignition takes 0.4 s, with 0.0224 s to come up to speed, and as much down.
    let rise = 2.0 * (1.0_f64 / 8000.0).sqrt();
    let (ignition, crater) = (0.4 - rise, 0.6 - rise);
    let length = path.length_mm();
    assert!((length - (ignition + 100.0 + crater)).abs() < 1e-6, "{length}");
    let wanted = [
        (0.0, power(1500.0, 0.0)),
        (ignition, power(2000.0, 5.0)),
        (ignition + 92.0, power(900.0, 8.0)),
        (ignition + 100.0, power(700.0, 0.0)),
    ];
    assert_eq!(levels.len(), wanted.len());
    for ((s, action), (wanted_s, wanted)) in levels.iter().zip(wanted) {
        assert!((s - wanted_s).abs() < 1e-6 && *action == wanted, "{s} {action:?}");
    }
    assert_eq!(
        events
            .iter()
            .filter(|(_, action)| matches!(action, PathAction::Beam { .. }))
            .count(),
        1
    );
    let stops = path
        .legs()
        .map(|leg| leg.unwrap().element.join == shared::trajectory::Join::Stop);
    assert_eq!(
        stops.filter(|stop| *stop).count(),
        3,
        "after ignition, seam and crater fill"
    );
    let after = &paths[weld_at + 1..];
    assert!(
        after[0].motion == Motion::Stand
            && after[0]
                .events
                .iter()
                .any(|event| event.action == PathAction::Beam { side: 0, on: false })
    );
    assert_eq!(after[1].dwell_before_s, 1.5);
    assert!(after[1].events.iter().any(|event| event.action == gas(false).1));
}

#[test]
fn tacks_are_skipped_or_welded_with_another_power_and_changes_are_at_their_places() {
    let data = format!(
        "{FULL}tacks = [{{ from_mm = 20.0, to_mm = 28.0 }}, {{ from_mm = 60.0, to_mm = 65.0, power = 2400.0 }}]\n\
        changes = [{{ at_mm = 40.0, over_mm = 10.0, power = 1800.0, levels = {{ wire_feed = 6.0 }} }}]\n"
    );
    let paths = planned(&data, "WELDON=root\nG1 X-60\nX0\nWELDOFF\nM2").unwrap();
    let path = weld(&paths);
    let rise = 2.0 * (1.0_f64 / 8000.0).sqrt();
    let start = 0.4 - rise;
    // A smooth curve over the seam, whose lengths are exact to some nanometres.
    let near = |a: f64, b: f64| (a - b).abs() < 1e-4;
    let levels = |channel: Channel| -> Vec<[f64; 3]> {
        let events = events(path).into_iter();
        let levels = events.filter_map(|(s, action)| match action {
            PathAction::Level {
                channel: own,
                value,
                over_mm,
            } if own == channel => Some([s - start, value, over_mm]),
            _ => None,
        });
        levels.collect()
    };
    let same = |found: Vec<[f64; 3]>, wanted: &[[f64; 3]]| {
        let all = found.iter().flatten().zip(wanted.iter().flatten());
        assert!(
            found.len() == wanted.len() && all.into_iter().all(|(a, b)| near(*a, *b)),
            "{found:?}"
        );
    };
    same(
        levels(Channel::Power(0)),
        &[
            [-start, 1500.0, 0.0],
            [0.0, 2000.0, 5.0],
            [40.0, 1800.0, 10.0],
            [60.0, 2400.0, 0.0],
            [65.0, 1800.0, 0.0],
            [92.0, 900.0, 8.0],
            [100.0, 700.0, 0.0],
        ],
    );
    same(
        levels(Channel::Analog(0)),
        &[[-start, 8.0, 0.0], [40.0, 6.0, 10.0]],
    );
    let gates: Vec<(f64, bool)> = events(path)
        .into_iter()
        .filter_map(|(s, action)| match action {
            PathAction::Beam { on, .. } => Some((s - start, on)),
            _ => None,
        })
        .collect();
    assert!(
        gates.len() == 3 && near(gates[1].0, 20.0) && near(gates[2].0, 28.0),
        "{gates:?}"
    );
    assert_eq!(
        gates.iter().map(|(_, on)| *on).collect::<Vec<_>>(),
        [true, false, true]
    );
}

#[test]
fn the_power_of_a_tack_holds_for_all_of_it_and_a_ramp_goes_on_behind_it() {
    let data = "[w]\npower = 2000.0\n\
                changes = [{ at_mm = 20.0, over_mm = 20.0, power = 4000.0 }, { at_mm = 62.0, power = 3000.0 }]\n\
                tacks = [{ from_mm = 25.0, to_mm = 30.0, power = 1000.0 }, { from_mm = 60.0, to_mm = 65.0, power = 2500.0 }]\n";
    let paths = planned(data, "WELDON=w\nG1 X0\nWELDOFF\nM2").unwrap();
    let levels = events(weld(&paths))
        .into_iter()
        .filter_map(|(s, action)| match action {
            PathAction::Level { value, over_mm, .. } if s > 0.0 => Some([s, value, over_mm]),
            _ => None,
        });
    let wanted = [
        [20.0, 4000.0, 20.0],
        [25.0, 1000.0, 0.0],
        [30.0, 3000.0, 0.0],
        [30.0, 4000.0, 10.0],
        [60.0, 2500.0, 0.0],
        [65.0, 3000.0, 0.0],
    ];
    assert_eq!(levels.collect::<Vec<_>>(), wanted);
}

#[test]
fn on_a_woven_seam_places_and_ramps_are_those_of_the_seam() {
    let data = format!(
        "{WEAVE}ramp_down = {{ power = 100.0, over_mm = 30.0 }}\ntacks = [{{ from_mm = 31.0, to_mm = 42.5 }}]\n"
    );
    let paths = planned(&data, "WELDON=w\nG1 X0\nWELDOFF\nM2").unwrap();
    let (path, tips) = (weld(&paths), tips(weld(&paths)));
    let x = |s: f64| tips[tips.partition_point(|tip| tip.0 < s)].1.x + 100.0;
    for (s, action) in events(path) {
        match action {
            PathAction::Beam { on: false, .. } => assert!((x(s) - 31.0).abs() < 0.03),
            PathAction::Beam { on: true, .. } if s > 1.0 => assert!((x(s) - 42.5).abs() < 0.03),
            PathAction::Level {
                value: 100.0,
                over_mm,
                ..
            } => {
                assert!(
                    (x(s) - 70.0).abs() < 0.03 && (s + over_mm - path.length_mm()).abs() < 0.01,
                    "{} {}",
                    x(s),
                    s + over_mm - path.length_mm()
                );
            }
            _ => {}
        }
    }
}

#[test]
fn an_offset_leads_beside_the_seam_and_back() {
    let data = "[cap]\npower = 2000.0\noffset_mm = [1.5, 3.0]\n";
    let paths = planned(data, "WELDON=cap\nG1 X0\nWELDOFF\nG1 X10\nM2").unwrap();
    let tips_of_weld = tips(weld(&paths));
    for (_, tip, _) in &tips_of_weld {
        assert!((tip.y - 1.5).abs() < 1e-6 && (tip.z - 53.0).abs() < 1e-6, "{tip}");
    }
    let last = tips(paths.last().unwrap());
    assert!((last[0].1 - Vector3::new(0.0, 0.0, 50.0)).norm() < 1e-6);
}

#[test]
fn what_cannot_be_welded_is_told_with_its_line() {
    let straight = "WELDON=w\nG1 X0\nWELDOFF\nM2";
    for (data, program, told) in [
        (
            "",
            straight,
            "line 5, column 1: there is no weld data \"w\" in w.toml; there are ",
        ),
        (
            WEAVE,
            "WELDON=w\nG1 X0\nG0 Z80\nWELDOFF\nM2",
            "line 7, column 4: the weld \"w\" of line 5, column 1 is still on",
        ),
        (
            WEAVE,
            "WELDON=w\nG1 X0\nM2",
            "line 5, column 1: the weld \"w\" is never ended",
        ),
        (
            WEAVE,
            "WELDON=w\nWELDOFF\nG1 X0\nM2",
            "line 6, column 1: nothing is welded with \"w\"",
        ),
        (
            WEAVE,
            "G1 X0\nWELDOFF\nM2",
            "line 6, column 1: WELDOFF, but no weld is on",
        ),
        (
            WEAVE,
            "WELDON=w\nG64 P0.1\nG1 X0\nY20\nWELDOFF\nM2",
            "line 8, column 1: the seam has a corner of 90.0° here",
        ),
        (
            WEAVE,
            "WELDON=w\nG1 X-98.5\nWELDOFF\nM2",
            "line 6, column 4: the seam is 1.5 mm long, the weave of \"w\" needs 4.0 mm",
        ),
        (
            WEAVE,
            "WELDON=w\nF1 G1 X0\nWELDOFF\nM2",
            "line 6, column 7: half a period of the weave of \"w\" would be 0.0083 mm at this feed",
        ),
        (
            WEAVE,
            "WELDON=w\nG1 X-50\nF600 X0\nWELDOFF\nM2",
            "line 7, column 6: a weld with weld data has one feed",
        ),
        (
            "[w]\npower = 9000.0\n",
            straight,
            "line 5, column 1: 9000 W is more than the maximum of beam 1",
        ),
        (
            "[w]\npower = 1.0\noutputs = [\"argon\"]\n",
            straight,
            "line 5, column 1: ",
        ),
        (
            "[w]\npower = 1.0\nlevels = { wire_feed = 30.0 }\n",
            straight,
            "line 5, column 1: 30 is more than the maximum of analog output 1, 20",
        ),
        (
            "[w]\npower = 1.0\ntacks = [{ from_mm = 90.0, to_mm = 101.0 }]\n",
            straight,
            "line 5, column 1: tacks of \"w\" need 101.0 mm, but the seam is 100.0 mm",
        ),
    ] {
        let error = error(data, program);
        assert!(error.starts_with(told), "{error}\n{told}");
    }
}

const STIR: &str = "[lap]\npower = 600.0\nlevels = {}\nstir = { clearance_mm = 2.0, depth_mm = 5.0, spin_up_s = 1.0, plunge_mm_s = 0.7, dwell_s = 2.5, retract_mm_s = 2.0 }\n";

/// Plans on the shipped stirring gantry, whose pin stands 2 mm above the surface at Z60, tilted by 2.5 degrees.
fn stirred(data: &str, program: &str) -> Result<Vec<PlannedPath>, PathError> {
    let start = "G21 G90 G43.4\nG53 G0 Z200\nG53 G0 B-2.5 C0\nG0 X250 Y215 Z200 B-2.5 C0\nG0 Z62\nF60\n";
    planned_on("stir-gantry", data, &format!("{start}{program}"))
}

#[test]
fn a_pin_turns_plunges_dwells_travels_at_its_depth_and_comes_out() {
    let program = "WELDON=lap\nG1 X260\nG3 X290 Y225 J50 C36.869898\nWELDOFF\nG0 Z200\nM2";
    let paths = stirred(STIR, program).unwrap();
    let turns = paths.iter().position(|path| {
        let opens = |(_, action): &(f64, PathAction)| matches!(action, PathAction::Beam { on: true, .. });
        events(path).iter().any(opens)
    });
    let [turning, plunge, seam, retraction, still] = &paths[turns.unwrap()..][..5] else {
        panic!("{} paths", paths.len());
    };
    assert_eq!(turning.motion, Motion::Stand);
    let switched: Vec<PathAction> = events(turning).into_iter().map(|(_, action)| action).collect();
    let on = PathAction::Beam { side: 0, on: true };
    assert_eq!(switched, [power(600.0, 0.0), on]);
    assert_eq!((plunge.dwell_before_s, seam.dwell_before_s), (1.0, 2.5));
    // 7 mm along the pin, at the speed of the set.
    let (down, up) = (tips(plunge), tips(retraction));
    let (above, below) = (down[0].1, down[down.len() - 1].1);
    assert!((above - Vector3::new(250.0, 215.0, 62.0)).norm() < 1e-6);
    let (sine, cosine) = 2.5_f64.to_radians().sin_cos();
    let along_the_pin = (below - above) / 7.0;
    assert!((along_the_pin.z + cosine).abs() < 1e-6 && (along_the_pin.x.abs() - sine).abs() < 1e-6);
    assert_eq!((down[1].2, up[1].2), (0.7, 2.0));
    assert!((up[up.len() - 1].1 - Vector3::new(290.0, 225.0, 62.0)).norm() < 1e-6);
    let pins = tips(seam);
    assert!((pins[0].1 - below).norm() < 1e-6 && (pins[pins.len() - 1].1 - up[0].1).norm() < 1e-6);
    for (_, tip, feed) in &pins {
        assert!((tip.z - (62.0 - 7.0 * cosine)).abs() < 1e-3 && (feed - 1.0).abs() < 2e-3);
    }
    let off = PathAction::Beam { side: 0, on: false };
    assert!(events(still).contains(&(0.0, off)), "{:?}", events(still));
    // Nothing switches the spindle on the way.
    for path in [plunge, seam, retraction] {
        assert!(!events(path).iter().any(|(_, action)| *action == off));
    }
}

#[test]
fn a_pin_needs_a_spindle() {
    assert_eq!(
        error(STIR, "WELDON=lap\nG1 X0\nWELDOFF\nM2"),
        "line 5, column 1: \"lap\" has stir, but beam 1 of the machine is no spindle (stays_on_at_rest)"
    );
}

#[test]
fn a_program_is_started_at_a_weld_and_not_in_it() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/wire-arc.toml");
    let mut machine = MachineFile::read(file.as_ref()).unwrap();
    machine.welding = WeldData::parse("w.toml", "[w]\npower = 1.0\noutputs = [\"gas\"]").unwrap();
    // WELDON in lines 5 and 9.
    let weld = |x: i32| format!("WELDON=w\nG1 X{x}\nWELDOFF\n");
    let text = format!("{START}{}G0 Z80\n{}G0 Z90\nM2", weld(0), weld(50));
    let program = interpret(&text, Options::default()).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let from = machine.homed_axes();
    let whole = planner.program(&program, &from, None).unwrap();
    for line in [6, 7, 10, 11] {
        let error = planner
            .from_line(&program, whole.clone(), line, &from)
            .unwrap_err();
        let begins = if line < 8 { 5 } else { 9 };
        let told = format!(
            "line {line} is in the weld of line {begins}: start there, or behind line {}, where it ends",
            begins + 2
        );
        assert_eq!(error.to_string(), told);
    }
    // From the second weld on: its gas, its beam and its way are those of the whole program.
    let rest = planner.from_line(&program, whole.clone(), 9, &from).unwrap();
    let last = |paths: &[PlannedPath]| paths[paths.len() - 5..].to_vec();
    for (here, there) in last(&rest).iter().zip(&last(&whole)) {
        assert_eq!((here.motion, here.length_mm()), (there.motion, there.length_mm()));
        assert_eq!(events(here), events(there));
    }
    let gas = PathAction::Output { output: 0, on: true };
    assert!(rest.iter().any(|path| events(path).contains(&(0.0, gas))));
    let burns = |path: &&PlannedPath| {
        let on = |(_, action): &(f64, PathAction)| matches!(action, PathAction::Beam { on: true, .. });
        path.motion == Motion::Feed && events(path).iter().any(on)
    };
    assert_eq!(rest.iter().filter(burns).count(), 1);
    assert!(planner.from_line(&program, whole, 12, &from).is_ok());
}

#[test]
fn another_speed_takes_the_place_of_the_feed_of_a_weld() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/wire-arc.toml");
    let mut machine = MachineFile::read(file.as_ref()).unwrap();
    machine.welding = WeldData::parse("w.toml", WEAVE).unwrap();
    let program = format!("{START}WELDON=w\nG1 X0\nWELDOFF\nG1 X10\nM2");
    let program = interpret(&program, Options::default()).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let paths = planner
        .program(&program, &machine.homed_axes(), Some(5.0))
        .unwrap();
    let tips = tips(weld(&paths));
    let time = time_s(&tips);
    assert!((time - 20.0).abs() < 1e-3, "{time} s for 100 mm at 5 mm/s");
    assert_eq!(paths.last().unwrap().speeds().fastest_mm_s, 5.0);
}
