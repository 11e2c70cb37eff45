//! Machines operated by hand: jogs in every way, let go of in every way, and blocks.

use super::*;
use config::work_offsets::{System, WorkOffset};
use host_link::spool::Spooling;
use host_link::{ByHand, Jog, JogWay};
use shared::io::{AXES, AXIS_NAMES};
use shared::protocol::HOLD_TO_RUN_MS;
use system_tests::plate;
use system_tests::{Deed, Hands, Rest, Then};

/// All places where the machine waited.
fn operated<'a>(machine: &MachineFile, deeds: impl IntoIterator<Item = Deed<'a>>) -> Vec<Rest> {
    let boards = SimulatedBoards::new(machine.motion.kinematics.name()).unwrap();
    operated_on(boards, machine, deeds)
}

fn operated_on<'a>(
    mut boards: SimulatedBoards,
    machine: &MachineFile,
    deeds: impl IntoIterator<Item = Deed<'a>>,
) -> Vec<Rest> {
    let program = interpret("M2", Options::default()).unwrap();
    let job = Job {
        work: Work::ByHand,
        spooling: Spooling::nothing(),
        ..job(machine, &program, None)
    };
    let mut hands = Hands::new(deeds);
    let ended = run(&mut boards, &job, &mut hands).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    hands.rests()
}

fn jog(way: JogWay, speed: f64, step: Option<f64>) -> Jog {
    Jog::now(way, speed, step)
}

/// By how much each axis moved between two rests (mm, degrees).
fn moved(rests: &[Rest], from: usize) -> [f64; AXES] {
    let [before, after] = [0, 1].map(|i| rests[from + i].motion.reference);
    std::array::from_fn(|axis| after[axis] - before[axis])
}

#[track_caller]
fn only(moved: [f64; AXES], axis: usize, by: std::ops::Range<f64>) {
    for (other, moved) in moved.into_iter().enumerate() {
        if other == axis {
            assert!(by.contains(&moved), "{} moved by {moved}", AXIS_NAMES[axis]);
        } else {
            assert!(moved.abs() < 1e-9, "{} moved by {moved}", AXIS_NAMES[other]);
        }
    }
}

#[test]
fn an_axis_moves_while_it_is_held_to_and_stops_when_it_is_not() {
    let x = jog(JogWay::Axis(0), 20.0, None);
    let old = jog(JogWay::Axis(2), 5.0, Some(2.0));
    std::thread::sleep(Duration::from_millis(u64::from(HOLD_TO_RUN_MS) + 10));
    let rests = operated(
        &machine(),
        [
            Deed::Holds(x, 1000, Then::Silence),
            Deed::Holds(jog(JogWay::Axis(0), -20.0, None), 1000, Then::Asks(ByHand::LetGo)),
            Deed::AsksLate(old),
        ],
    );
    let lease = f64::from(HOLD_TO_RUN_MS) * 1e-3;
    // A second and up to the lease at 20 mm/s, less the acceleration, and braking.
    only(moved(&rests, 0), 0, 20.0 - 1.0..20.0 + 20.0 * lease + 1.5);
    let stops = rests[1]
        .samples
        .iter()
        .find(|sample| sample.state == State::Stopping);
    let after = stops.expect("a stop").tick - rests[1].asked;
    assert!(
        (HOLD_TO_RUN_MS..HOLD_TO_RUN_MS + 30).contains(&after),
        "{after} ms"
    );
    only(moved(&rests, 1), 0, -20.0 - 1.5..-20.0 + 1.5);
    assert_eq!(moved(&rests, 2), [0.0; AXES], "too old");
    assert!(
        rests[3].told[0].contains("too long to begin it now"),
        "{:?}",
        rests[3].told
    );
    assert!(
        rests
            .iter()
            .all(|rest| rest.motion.state == State::Idle && rest.motion.fault.is_none())
    );
}

#[test]
fn steps_are_exact_in_every_frame() {
    let step = |way, by: f64| Deed::Asks(ByHand::Jog(jog(way, by.signum() * 10.0, Some(by.abs()))));
    let rests = operated(
        &machine(),
        [
            step(JogWay::Axis(1), 1.5),
            step(JogWay::Axis(2), -0.01),
            step(JogWay::Work(0), 12.0),
            step(JogWay::Turn(4), 3.0),
            step(JogWay::Tool(2), 2.0),
            step(JogWay::Tool(0), -2.0),
            step(JogWay::Tool(1), 0.5),
        ],
    );
    only(moved(&rests, 0), 1, 1.5 - 1e-6..1.5 + 1e-6);
    only(moved(&rests, 1), 2, -0.01 - 1e-6..-0.01 + 1e-6);
    let planner = Planner::build(&machine()).unwrap();
    let tips: Vec<_> = rests
        .iter()
        .map(|rest| planner.tip(&rest.motion.reference))
        .collect();
    let way = |from: usize| {
        let [before, after] = [0, 1].map(|i| nalgebra::Vector3::from(tips[from + i].position_mm));
        after - before
    };
    assert!((way(2) - nalgebra::Vector3::x() * 12.0).norm() < 1e-5);
    assert!(way(3).norm() < 1e-5, "the tip stays: {}", way(3));
    assert!((tips[4].angles_deg[1] - tips[3].angles_deg[1] - 3.0).abs() < 1e-6);
    let pose = planner.pose(&tips[4]);
    assert!((way(4) - pose.normal * 2.0).norm() < 1e-5);
    assert!((way(5) + pose.tangent * 2.0).norm() < 1e-5);
    assert!((way(6) - pose.normal.cross(&pose.tangent) * 0.5).norm() < 1e-5);
}

#[test]
fn slides_are_jogged_and_stop_when_they_are_let_go_of() {
    let rests = operated(
        &machine(),
        [
            Deed::Asks(ByHand::Jog(jog(JogWay::Slide(3), -2.0, Some(1.25)))),
            Deed::Holds(jog(JogWay::Slide(0), 4.0, None), 500, Then::Asks(ByHand::LetGo)),
            Deed::Holds(jog(JogWay::Slide(0), -4.0, None), 500, Then::Silence),
        ],
    );
    let slides = |index: usize| rests[index].tracker.as_ref().unwrap().slides_mm;
    let moved = |index: usize, slide: usize| slides(index + 1)[slide] - slides(index)[slide];
    assert!((moved(0, 3) + 1.25).abs() < 0.01, "{}", moved(0, 3));
    assert!((1.5..2.5).contains(&moved(1, 0)), "{}", moved(1, 0));
    assert!((-2.9..-2.0).contains(&moved(2, 0)), "{}", moved(2, 0));
    assert!(moved(1, 3).abs() < 0.01 && moved(2, 3).abs() < 0.01);
}

#[test]
fn blocks_are_checked_as_programs_are_and_what_cannot_be_done_moves_nothing() {
    let block = |text: &str| Deed::Asks(ByHand::Block(text.to_owned()));
    let rests = operated(
        &machine(),
        [
            block("G43.4 G0 X900 Y900 Z100 A0 B0 C0"),
            block("G91 G1 X-5 F600"),
            block("G1 X1000000 F600"),
            block("G1 X900 F"),
            block("M62 P1"),
            Deed::Asks(ByHand::Jog(jog(JogWay::Axis(0), f64::INFINITY, Some(1.0)))),
        ],
    );
    let planner = Planner::build(&machine()).unwrap();
    let x = |index: usize| planner.tip(&rests[index].motion.reference).position_mm[0];
    assert!((x(1) - 900.0).abs() < 1e-5 && (x(2) - 895.0).abs() < 1e-5);
    let told: Vec<_> = rests.iter().map(|rest| rest.told.join("; ")).collect();
    assert!(told[..3].iter().all(String::is_empty), "{told:?}");
    assert!(
        told[3].contains("axis X") || told[3].contains("long"),
        "{}",
        told[3]
    );
    assert!(
        told[4].starts_with("the block is not carried out: line 1, column"),
        "{}",
        told[4]
    );
    assert!(told[5].contains("M62"), "{}", told[5]);
    assert!((x(4) - 895.0).abs() < 1e-9);
}

#[test]
fn blocks_go_by_the_work_offsets_and_one_that_sets_them_holds_for_those_after_it() {
    let block = |text: &str| Deed::Asks(ByHand::Block(text.to_owned()));
    let mut machine = machine();
    let second = WorkOffset {
        origin: [0.0, 40.0, 0.0, 0.0, 0.0, 0.0],
        rotation_deg: 0.0,
    };
    machine.work_offsets.set(System::G55, second);
    let rests = operated(
        &machine,
        [
            block("G0 X900 Y900 Z100 A0 B0 C0"),
            block("G10 L20 P1 X0"),
            block("G0 X-5"),
            block("G55 G0 Y850"),
            block("G10 L2 P1 X1000000 G0 X0"),
            block("G0 X5"),
        ],
    );
    let planner = Planner::build(&machine).unwrap();
    let tip = |index: usize| planner.tip(&rests[index].motion.reference).position_mm;
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-5, "{a} is not {b}");
    near(tip(2)[0], 900.0);
    near(tip(3)[0], 895.0);
    near(tip(4)[1], 890.0);
    // What is not carried out sets nothing.
    near(tip(6)[0], 905.0);
    let told: Vec<_> = rests.iter().map(|rest| rest.told.join("; ")).collect();
    assert_eq!(told[2], "set for the blocks by hand that follow: G54");
    assert!(
        [0, 1, 3, 4, 6].iter().all(|index| told[*index].is_empty()),
        "{told:?}"
    );
    assert!(!told[5].is_empty());
}

#[test]
fn a_probe_by_hand_leaves_what_it_found_to_the_blocks_after_it() {
    let block = |text: &str| Deed::Asks(ByHand::Block(text.to_owned()));
    let plant = plant_file::PlantFile::parse("plate", &plate::plant()).unwrap();
    let rests = operated_on(
        SimulatedBoards::wired_to(&plant),
        &plate::machine(),
        [
            block("G0 X700 Y550 Z-60 A0 C0"),
            block("G38.2 Z-90 F600"),
            block("G38.2 Z-110 F300"),
            block("G10 L2 P1 Z#5063"),
            block("G0 Z12"),
            block("G0 X[#5061 + 1000 * #5070]"),
            block("G0 X#5061"),
            Deed::Asks(ByHand::Jog(jog(JogWay::Axis(2), -20.0, Some(40.0)))),
            Deed::Asks(ByHand::Jog(jog(JogWay::Axis(2), 20.0, Some(10.0)))),
        ],
    );
    let told: Vec<_> = rests.iter().map(|rest| rest.told.join("; ")).collect();
    // What has met nothing is told, and the machine stays in the operator's hands.
    assert!(
        told[2].contains("at the end of the motion the probe has touched nothing"),
        "{told:?}"
    );
    assert!(
        told[3].contains("the probe touched with the tip at X7") && told[3].contains("Z-98.2"),
        "{told:?}"
    );
    assert_eq!(told[4], "set for the blocks by hand that follow: G54");
    let planner = Planner::build(&plate::machine()).unwrap();
    let tip = |index: usize| planner.tip(&rests[index].motion.reference).position_mm;
    assert!(
        (tip(5)[2] - (plate::CORNER[2] - 300.0) - 12.0).abs() < 0.005,
        "{:?}",
        tip(5)
    );
    assert!((tip(6)[0] - 1700.0).abs() < 0.005, "{:?}", tip(6));
    // A jog that runs into the plate ends there, and one away from it does not.
    assert!(told[8].starts_with("the probe touches in a motion"), "{told:?}");
    let below = plate::CORNER[2] - 300.0 - tip(8)[2];
    assert!((0.0..5.0).contains(&below), "{below} mm into the plate");
    assert!(
        told[9].is_empty() && (tip(9)[2] - tip(8)[2] - 10.0).abs() < 1e-6,
        "{told:?}"
    );
}
