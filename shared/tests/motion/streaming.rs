//! Elements and events that come while the path runs.

use super::bench::{BLEND, Bench, load};
use shared::motion::{ControllerAccess, EVENTS, MotionController, answer};
use shared::protocol::{LOAD_ELEMENTS, PathAction, PathEvent, PathJoin, Refusal, Request, Response};
use shared::state::State;
use shared::trajectory::{ELEMENTS, PathSpace};

const STEP: f64 = 0.25;

fn event(k: u32) -> PathEvent {
    PathEvent {
        s_mm: f64::from(k) * STEP,
        action: PathAction::Beam {
            side: 0,
            on: k.is_multiple_of(2),
        },
    }
}

/// Four times what the board holds, an event with every element: everything is passed in its order.
#[test]
fn a_path_of_any_length_runs_through_the_room_there_is() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let count = 4 * ELEMENTS as u32;
    let elements: Vec<_> = (0..count)
        .map(|k| {
            let last = k + 1 == count;
            let join = if last { PathJoin::Stop } else { BLEND };
            let (from, to) = (f64::from(k) * STEP, f64::from(k + 1) * STEP);
            load(bench.along_y(from, to, 50.0, join), last)
        })
        .collect();
    let mut elements = elements.into_iter();
    let mut sent = 0;
    let mut running = false;
    let mut gates = Vec::new();
    for _ in 0..20_000 {
        let room = bench.status().room;
        if room.elements > 0
            && room.events > 0
            && let Some(element) = elements.next()
        {
            bench.loaded(&Request::LoadEvents([event(sent)].into_iter().collect()));
            bench.loaded(&element);
            sent += 1;
            continue;
        }
        if !running {
            assert!(sent as usize >= ELEMENTS.min(EVENTS) - 1, "{sent}");
            bench.run();
            running = true;
        }
        bench.run_ms(1);
        let now = bench.samples.last().unwrap();
        gates.push((now.s_mm, now.speed_mm_s, now.beams[0]));
        if now.state == State::Idle {
            break;
        }
    }
    assert_eq!((sent, bench.status().state), (count, State::Idle));
    assert_eq!(bench.status().s_mm, f64::from(count) * STEP);
    // Away from the ends, where the speed is full, the gate is as the events say, to a millisecond.
    let inside = gates.iter().filter(|(s, ..)| (10.0..110.0).contains(s));
    let mut seen = 0;
    for (s, speed, open) in inside {
        let part = (s / STEP).fract() * STEP;
        if part > 0.06 {
            let k = (s / STEP) as u32;
            assert_eq!(
                *open,
                k.is_multiple_of(2) && *speed >= 5.0,
                "at {s}, {speed} mm/s"
            );
            seen += 1;
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn a_path_that_runs_dry_waits_without_a_jerk_and_goes_on() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let [first, second] = [(0.0, 20.0), (20.0, 40.0)].map(|(from, to)| bench.along_y(from, to, 100.0, BLEND));
    let third = bench.along_y(40.0, 60.0, 100.0, PathJoin::Stop);
    bench.loaded(&load(first, false));
    bench.loaded(&load(second, false));
    bench.run();
    let mut speed = 0.0;
    for _ in 0..6000 {
        bench.servo_tick();
        let change = bench.speed() - speed;
        assert!(change.abs() < 0.5, "{change} mm/s in a tick");
        speed = bench.speed();
        if bench.samples.len().is_multiple_of(100) {
            bench.status();
        }
    }
    let status = bench.status();
    assert_eq!(status.state, State::Running);
    assert!(speed.abs() < 0.5 && status.s_mm > 15.0, "{status:?}");
    bench.loaded(&load(third, true));
    bench.until(State::Idle, 3000);
    assert_eq!(bench.status().s_mm, 60.0);
}

#[test]
fn more_than_there_is_room_for_is_refused_and_nothing_taken() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    for k in 0..ELEMENTS as u32 {
        let (from, to) = (f64::from(k), f64::from(k + 1));
        let element = bench.along_y(from, to, 50.0, BLEND);
        let room = bench.loaded(&load(element, false));
        assert_eq!(usize::from(room.elements), ELEMENTS - 1 - k as usize);
    }
    let more = bench.along_y(128.0, 129.0, 50.0, BLEND);
    let refusal = bench.refused(&load(more, false));
    assert!(matches!(refusal, Refusal::NoRoom { room } if room.elements == 0));
    for k in 0..EVENTS as u32 {
        bench.loaded(&Request::LoadEvents([event(k)].into_iter().collect()));
    }
    let more = Request::LoadEvents([event(EVENTS as u32)].into_iter().collect());
    assert!(matches!(bench.refused(&more), Refusal::NoRoom { room } if room.events == 0));
}

/// A bench whose path ticks come wherever a request lets them.
struct Interrupted<'a>(&'a mut Bench);

impl ControllerAccess for Interrupted<'_> {
    fn with<R>(&mut self, use_it: impl FnOnce(&mut MotionController) -> R) -> R {
        self.0.run_ms(1);
        use_it(&mut self.0.controller)
    }
}

/// They are built where no path tick waits: that of four curves would keep a turn of planning from ending.
#[test]
fn a_path_tick_may_come_before_the_elements_of_a_request_are_taken() {
    let mut bench = Bench::homed();
    bench.begin(PathSpace::Tool);
    let first = bench.along_y(0.0, 20.0, 50.0, BLEND);
    let more: heapless::Vec<_, LOAD_ELEMENTS> = [(20.0, BLEND), (30.0, BLEND), (40.0, PathJoin::Stop)]
        .map(|(from, join)| bench.along_y(from, from + 10.0, 50.0, join))
        .into_iter()
        .collect();
    bench.loaded(&load(first, false));
    bench.run();
    bench.run_ms(200);
    let before = bench.samples.len();
    let request = Request::LoadElements {
        elements: more,
        last: true,
    };
    let answered = answer(&mut Interrupted(&mut bench), &request, 0);
    assert!(matches!(answered, Response::Room(_)), "{answered:?}");
    assert!(bench.samples.len() > before, "one before they are taken");
    bench.until(State::Idle, 10_000);
    assert_eq!((bench.status().s_mm, bench.fault()), (50.0, None));
}
