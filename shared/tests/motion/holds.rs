//! Hold, resume with overlap, back, and override.

use super::bench::Bench;
use shared::protocol::{MotionSample, Request};
use shared::state::State;

/// Asks like a PC that is alive, until `done`.
fn run_until(bench: &mut Bench, done: impl Fn(&MotionSample) -> bool) {
    for ms in 0..20_000 {
        bench.run_ms(1);
        if done(bench.samples.last().unwrap()) {
            return;
        }
        if ms % 100 == 0 {
            bench.status();
        }
    }
    panic!("{:?}", bench.status());
}

fn stands(sample: &MotionSample) -> bool {
    sample.speed_mm_s == 0.0
}

/// The beam is off at once, and on again from two millimetres before where it went off, at speed; between, never.
#[test]
fn a_beam_goes_over_the_place_of_a_hold_again_at_speed() {
    for hold_at in [30.0, 100.0, 170.0] {
        let mut bench = Bench::homed();
        bench.load_line(300.0);
        bench.run();
        run_until(&mut bench, |now| now.s_mm >= hold_at);
        let off = *bench.samples.last().unwrap();
        assert!(off.beams[0]);
        bench.done(&Request::Hold);
        bench.run_ms(3);
        assert!(!bench.command.beam_gate[0]);
        run_until(&mut bench, stands);
        bench.run_ms(5);
        let stood = bench.status().s_mm;
        assert!(stood > off.s_mm && bench.status().state == State::Holding);
        bench.samples.clear();
        bench.done(&Request::Resume);
        run_until(&mut bench, |now| now.state == State::Idle);
        let first = bench.samples.iter().position(|now| now.beams[0]).unwrap();
        let on = &bench.samples[first];
        // The last place with the beam on is a millisecond or two behind that of the request.
        let reopened = off.s_mm - 2.0..off.s_mm - 2.0 + 0.5;
        assert!(
            reopened.contains(&on.s_mm),
            "off at {}, on at {}",
            off.s_mm,
            on.s_mm
        );
        assert!(on.speed_mm_s >= 0.95 * off.speed_mm_s, "{}", on.speed_mm_s);
        let lowest = bench.samples[..first]
            .iter()
            .fold(stood, |low, now| now.s_mm.min(low));
        assert!(lowest < off.s_mm - 2.0, "no run-up: {lowest}");
        // From there on it stays on while the path is fast enough.
        let rest = &bench.samples[first..];
        assert!(rest.iter().all(|now| now.beams[0] || now.s_mm > 290.0));
        assert_eq!(bench.status().s_mm, 300.0);
    }
}

/// A path held before the beam could have gone over it is not welded before its own event.
#[test]
fn a_beam_does_not_reopen_before_it_went_on() {
    let mut bench = Bench::homed();
    bench.load_line(300.0);
    bench.run();
    run_until(&mut bench, |now| now.beams[0] && now.s_mm >= 1.0);
    bench.done(&Request::Hold);
    run_until(&mut bench, stands);
    bench.run_ms(100);
    bench.done(&Request::Resume);
    run_until(&mut bench, |now| now.state == State::Idle);
    assert!(bench.samples.iter().all(|now| now.s_mm >= -1e-9));
    assert_eq!(bench.status().s_mm, 300.0);
}

#[test]
fn back_follows_the_path_with_the_beam_off_and_stops_with_a_hold() {
    let mut bench = Bench::homed();
    bench.load_line(300.0);
    bench.run();
    run_until(&mut bench, |now| now.s_mm >= 150.0);
    bench.done(&Request::Hold);
    run_until(&mut bench, stands);
    bench.run_ms(10);
    let stood = bench.status().s_mm;
    bench.samples.clear();
    bench.done(&Request::Back);
    run_until(&mut bench, |now| now.s_mm < stood - 20.0);
    bench.done(&Request::Hold);
    run_until(&mut bench, stands);
    bench.run_ms(10);
    let back = bench.status();
    assert!(
        back.state == State::Holding && back.s_mm < stood - 20.0,
        "{back:?}"
    );
    assert!(bench.samples.iter().all(|now| !now.beams[0]));
    bench.done(&Request::Resume);
    run_until(&mut bench, |now| now.state == State::Idle);
    let on = bench.samples.iter().find(|now| now.beams[0]).unwrap();
    // Not again over what was welded, but for the overlap.
    assert!(on.s_mm >= 148.0 && on.s_mm < 150.0, "{}", on.s_mm);
}

#[test]
fn the_override_scales_the_speed_of_this_path_and_the_next() {
    let mut bench = Bench::homed();
    bench.load_line(100.0);
    bench.run();
    bench.done(&Request::Override { factor: 0.5 });
    run_until(&mut bench, |now| now.state == State::Idle);
    let fastest = |bench: &Bench| bench.samples.iter().map(|now| now.speed_mm_s).fold(0.0, f64::max);
    // It was asked for when the path had just begun.
    assert!((fastest(&bench) - 75.0).abs() < 1.0, "{}", fastest(&bench));
    bench.samples.clear();
    bench.load_line(100.0);
    bench.run();
    run_until(&mut bench, |now| now.state == State::Idle);
    assert!((fastest(&bench) - 75.0).abs() < 0.01, "{}", fastest(&bench));
    assert_eq!(bench.status().speed_override, 0.5);
}
