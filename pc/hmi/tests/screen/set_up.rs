//! Setting up, on simulated boards in real time: home, arm, jog by button and key, carry out blocks.

use crate::bench::{Bench, PROGRAM, waits};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;
use hmi::screen::Page;
use hmi::station::Action;
use shared::state::State;
use std::time::{Duration, Instant};

/// Longer than a jog takes to end that is not held any more, by the clock: the lease and braking.
const ENDED: Duration = Duration::from_secs(2);

fn axes(bench: &mut Bench) -> [f64; 6] {
    bench.station().live.motion.as_ref().expect("a state").axes
}

/// Presses or lets go of the pointer there.
fn pointer(bench: &mut Bench, at: Pos2, pressed: bool) {
    bench.harness.event(Event::PointerMoved(at));
    bench.harness.event(Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    });
}

/// Draws for so long, as often as a screen does.
fn draw_for(bench: &mut Bench, time: Duration) {
    let end = Instant::now() + time;
    while Instant::now() < end {
        bench.harness.step();
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn homed() -> Bench {
    let mut bench = Bench::in_real_time("dual-beam-gantry");
    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Cancel");
    assert!(!bench.station().is_running());
    bench.pictures("home", |bench| bench.tap("Home…"));
    bench.tap("Home now");
    bench.until("an axis searches", |station| {
        station
            .live
            .motion
            .as_ref()
            .is_some_and(|motion| motion.searching != 0)
    });
    assert!(bench.harness.query_by_label_contains("search now").is_some());
    bench.until("it is ready", waits);
    bench
}

#[test]
fn home_arm_jog_a_step_hold_a_button_and_carry_out_a_block() {
    let mut bench = homed();
    let begin = axes(&mut bench);

    // Nothing moves by one touch.
    bench.tap("X +");
    draw_for(&mut bench, Duration::from_millis(300));
    assert_eq!(bench.station().live.state(), Some(State::Idle));
    assert!((axes(&mut bench)[0] - begin[0]).abs() < 0.01);

    bench.tap("Arm the panel");
    bench.tap("1");
    bench.tap("X +");
    bench.until("it has jogged", |station| {
        waits(station)
            && station
                .live
                .motion
                .as_ref()
                .is_some_and(|m| (m.axes[0] - begin[0] - 1.0).abs() < 0.005)
    });

    bench.pictures("set-up", |_| {});
    bench.tap("While held");
    let at = bench.harness.get_by_label("Y +").rect().center();
    pointer(&mut bench, at, true);
    draw_for(&mut bench, Duration::from_millis(1000));
    assert_eq!(bench.station().live.state(), Some(State::Running));
    pointer(&mut bench, at, false);
    bench.until("it stands", waits);
    draw_for(&mut bench, Duration::from_millis(200));
    let moved = axes(&mut bench)[1] - begin[1];
    // A second at 5 mm/s, less what it takes to begin.
    assert!((2.5..5.5).contains(&moved), "{moved} mm");

    // A pointer that leaves the button lets go of it.
    pointer(&mut bench, at, true);
    draw_for(&mut bench, Duration::from_millis(300));
    let away = at + eframe::egui::vec2(0.0, 300.0);
    bench.harness.event(Event::PointerMoved(away));
    draw_for(&mut bench, Duration::from_millis(100));
    bench.until("it stands", waits);
    pointer(&mut bench, away, false);

    for (block, told) in [
        ("G91 G1 X-2 F600", None),
        ("G1 X1000000 F600", Some("no machine goes farther")),
    ] {
        let x = axes(&mut bench)[0];
        bench.type_in(
            "Block by hand (MDI), checked as a program is; the panel must be armed",
            block,
        );
        bench.tap("Carry out");
        match told {
            None => bench.until("it has moved", |station| {
                waits(station)
                    && station
                        .live
                        .motion
                        .as_ref()
                        .is_some_and(|m| (m.axes[0] - x + 2.0).abs() < 0.01)
            }),
            Some(told) => {
                bench.until("it is refused", |station| station.live.told.is_some());
                assert!(bench.harness.query_by_label_contains(told).is_some());
            }
        }
    }

    // Another page disarms.
    bench.open(Page::Run);
    bench.open(Page::SetUp);
    assert!(bench.harness.query_by_label("Arm the panel").is_some());
    bench.tap("Drives off");
    bench.until("the drives are off", |station| !station.is_running());
    assert_eq!(bench.station().live.journal.open_alarms().count(), 0);
}

#[test]
fn arrow_keys_jog_only_where_the_panel_is_armed_and_a_screen_that_is_not_drawn_stops() {
    let mut bench = homed();
    let begin = axes(&mut bench);
    let key = |bench: &mut Bench, pressed| {
        bench.harness.event(Event::Key {
            key: Key::ArrowRight,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        });
    };
    key(&mut bench, true);
    draw_for(&mut bench, Duration::from_millis(300));
    key(&mut bench, false);
    assert!((axes(&mut bench)[0] - begin[0]).abs() < 0.01);

    bench.tap("Arm the panel");
    key(&mut bench, true);
    draw_for(&mut bench, Duration::from_millis(800));
    assert_eq!(bench.station().live.state(), Some(State::Running));
    // Frozen: nobody asks any more, though the key is down.
    std::thread::sleep(ENDED);
    key(&mut bench, false);
    bench.until("it stands", waits);
    draw_for(&mut bench, Duration::from_millis(200));
    let moved = axes(&mut bench)[0] - begin[0];
    assert!((1.5..5.0 + 1.5).contains(&moved), "{moved} mm");
    bench.key(Key::F1);
    bench.until("the job is over", |station| !station.is_running());
}

#[test]
fn a_program_begins_from_a_machine_that_is_operated_by_hand() {
    let mut bench = homed();
    bench.load(PROGRAM);
    let now = Duration::MAX / 4;
    assert!(!bench.station().may(Action::Home, now));
    bench.open(Page::Run);
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("the program's job runs", |station| station.runs_program());
    bench.tap("STOP");
    bench.until("the job is over", |station| !station.is_running());
}
