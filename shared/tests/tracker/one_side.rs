//! A machine with one head: U1 and V1, and nothing where the other two slides would be.

use crate::bench::{Bench, Shape, config};
use shared::config::TrackerConfig;
use shared::io::{SIDES, SLIDES};
use shared::protocol::BeamPermit::{No, Open};
use shared::state::TrackerState;

fn one_side() -> TrackerConfig {
    let mut config = config();
    config.slides.truncate(SLIDES / SIDES);
    config
}

/// Not connected: counts that run, both switches open, no drive ready.
fn unconnected(feedback: &mut shared::io::SlideFeedback) {
    for slide in 2..SLIDES {
        feedback.counts[slide] = feedback.counts[slide].wrapping_add(1_000_000);
        feedback.limit_plus.set(slide, true);
        feedback.limit_minus.set(slide, true);
        feedback.drive_fault.set(slide, true);
    }
}

/// The bench measures both sides: what it says of side 2 is dropped, and counted.
#[test]
fn one_head_homes_and_follows_whatever_is_read_where_the_other_would_be() {
    let mut bench = Bench::new(Shape::Arc(800.0), |_, s| (0.5 * (s / 40.0).sin(), -0.2));
    bench.change_inputs = unconnected;
    bench.prepare_with(one_side());
    assert_eq!(bench.status().state, TrackerState::Ready);
    bench.tracking = true;
    bench.speed = 50.0;
    bench.run_ms(1000);
    for _ in 0..5000 {
        bench.tick();
        let permit = bench.last.permit.expect("the motion board is heard");
        assert_eq!(permit.sides, [Open, No]);
        assert_eq!(bench.last.command.beam_gate, [true, false]);
        let [u, v, ..] = bench.spot_errors();
        assert!(u.abs() < 0.05 && v.abs() < 0.05, "{u} {v} at {}", bench.s);
        assert_eq!(bench.last.command.dac[2..], [shared::io::DacCode::ZERO; 2]);
    }
    let status = bench.status();
    assert_eq!((status.fault, status.accepted[1]), (None, 0));
    assert!(
        status.accepted[0] > 500 && status.implausible_measurements[1] > 500,
        "{status:?}"
    );
    assert_eq!(status.slides_mm[2..], [0.0; 2]);
}

#[test]
fn its_own_switches_still_trip() {
    let mut bench = Bench::new(Shape::Straight, |_, _| (0.0, 0.0));
    bench.prepare_with(one_side());
    bench.change_inputs = |feedback| feedback.limit_plus.set(1, true);
    bench.run_ms(2);
    assert_eq!(bench.status().state, TrackerState::Fault);
}

#[test]
fn what_is_not_connected_does_not_keep_a_fault() {
    let mut bench = Bench::new(Shape::Straight, |_, _| (0.0, 0.0));
    bench.prepare_with(one_side());
    bench.change_inputs = |feedback| {
        unconnected(feedback);
        feedback.limit_plus.set(1, true);
    };
    bench.run_ms(2);
    assert_eq!(bench.status().state, TrackerState::Fault);
    bench.change_inputs = unconnected;
    bench.run_ms(2);
    bench.accept(shared::protocol::Request::Reset);
    assert_eq!(bench.status().state, TrackerState::Off);
}

#[test]
fn half_a_side_is_refused() {
    for slides in [0, 1, 3] {
        let mut config = config();
        config.slides.truncate(slides);
        let error = config.build().expect_err("refused").to_string();
        assert!(error.starts_with("slides of tracking is"), "{error}");
    }
}
