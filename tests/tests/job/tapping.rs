//! Threads that are tapped: neither an operator's override nor the speed that is asked for of welds changes their feed.

use super::*;
use shared::protocol::MotionSample;

/// Output 3 turns the spindle the other way.
const REVERSE: u8 = 1 << 2;

fn gantry() -> MachineFile {
    let text = include_str!("../../../machines/stir-gantry.toml");
    let text = format!("{text}\n[outputs.left]\nnumber = 3\n[program]\nspindle_reverse = \"left\"\n");
    MachineFile::parse("m.toml", &text).unwrap()
}

/// Asks for half of the feed all the time.
struct Slow;

impl Operator for Slow {
    fn event(&mut self, _: &Event, _: &Remote) {}

    fn turn(&mut self, remote: &Remote) {
        // It takes one in a turn.
        let _ = remote.send(Command::Override(0.5));
    }
}

#[test]
fn a_tap_keeps_its_feed_whatever_the_operator_asks_for() {
    let program = "\
G21 G17 G90 G43.4
G0 X250 Y215 Z200 B0 C0
M3 S600
G0 Z80
F600
G98 G84 Z60 R75 P0.2
G80
G1 X255
M2";
    let machine = gantry();
    let program = interpret(program, Options::default()).unwrap();
    let mut job = job(&machine, &program, None);
    // Twice what it says.
    job.speed_m_per_min = Some(1.2);
    let mut samples: Vec<MotionSample> = Vec::new();
    let mut simulated = SimulatedBoards::new(machine.motion.kinematics.name()).unwrap();
    let mut boards = TappedBoards {
        boards: &mut simulated,
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| samples.push(*sample),
    };
    let ended = run(&mut boards, &job, &mut Slow).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);

    let moving = || samples.iter().filter(|sample| sample.speed_mm_s > 1e-3);
    let fastest = |turned: bool, feeds: &dyn Fn(f64) -> bool| {
        let there = moving().filter(|s| (s.outputs & REVERSE != 0) == turned && feeds(s.axes[2]));
        there.map(|s| s.speed_mm_s).fold(0.0, f64::max)
    };
    // 10 mm/s, down with the spindle as it was, up with it reversed.
    let in_the_hole = |z: f64| (61.0..74.0).contains(&z);
    assert!((fastest(false, &in_the_hole) - 10.0).abs() < 1e-3);
    assert!((fastest(true, &in_the_hole) - 10.0).abs() < 1e-3);
    // What feeds after it goes with half of the 20 mm/s that were asked for; the table goes the other way.
    let after = |s: &&MotionSample| (-253.5..-251.0).contains(&s.axes[0]) && s.axes[2] < 81.0;
    let last = moving().rfind(after).unwrap();
    assert!((last.speed_mm_s - 10.0).abs() < 0.5, "{last:?}");
}
