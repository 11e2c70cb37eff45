//! Levels and PINs, the record and the settings that outlive the screen.

use crate::bench::{Bench, PROGRAM};
use eframe::egui::Key;
use egui_kittest::kittest::{NodeT, Queryable};
use hmi::access::{Level, UNTOUCHED};
use hmi::parameters::Parameters;
use hmi::screen::Page;
use hmi::station::{Action, Station};
use hmi::texts::Language;
use host_link::events::Question;
use host_link::{ByHand, Command, Jog, JogWay};
use std::time::Duration;

const SETTER: &str = "1357";
const ENGINEER: &str = "24680";
/// What needs a level, with that.
const NEED: [(Action, Level); 8] = [
    (Action::Home, Level::Setter),
    (Action::ByHand, Level::Setter),
    (Action::Jog, Level::Setter),
    (Action::Teach, Level::Setter),
    (Action::WorkOffsets, Level::Setter),
    (Action::Write, Level::Engineer),
    (Action::Commission, Level::Engineer),
    (Action::Stop, Level::Operator),
];

fn type_pin(bench: &mut Bench, pin: &str) {
    for digit in pin.chars() {
        bench.tap(&digit.to_string());
    }
    bench.tap("OK");
}

fn set_pin(bench: &mut Bench, level: &str, pin: &str) {
    bench.tap(&format!("Set PIN: {level}…"));
    assert!(bench.says(&format!("New PIN: {level}")));
    type_pin(bench, pin);
    assert!(bench.says("The same PIN again"));
    type_pin(bench, pin);
}

/// With a PIN for each level, and somebody in as an engineer; a machine file of its own.
fn with_pins() -> (Bench, std::path::PathBuf) {
    let (mut bench, file) = Bench::with_own_file();
    bench.open(Page::Settings);
    set_pin(&mut bench, "engineer", ENGINEER);
    set_pin(&mut bench, "setter", SETTER);
    assert_eq!(bench.station().access().level(), Level::Engineer);
    (bench, file)
}

fn lock(bench: &mut Bench) {
    bench.open(Page::Settings);
    bench.tap("Lock");
    assert_eq!(bench.station().access().level(), Level::Operator);
}

fn enter(bench: &mut Bench, pin: &str) {
    bench.tap("Access…");
    type_pin(bench, pin);
}

fn is_greyed(bench: &Bench, button: &str) -> bool {
    bench.harness.get_by_label(button).accesskit_node().is_disabled()
}

fn record(bench: &Bench) -> String {
    std::fs::read_to_string(bench.folder.path().join("record.tsv")).unwrap_or_default()
}

/// Draws until `text` is in the record, which is written beside the screen.
fn recorded(bench: &mut Bench, text: &str) -> String {
    let folder = bench.folder.path().to_owned();
    bench.until(text, |_: &Station| {
        let record = std::fs::read_to_string(folder.join("record.tsv"));
        record.is_ok_and(|record| record.contains(text))
    });
    let record = record(bench);
    let line = record.lines().rfind(|line| line.contains(text));
    line.expect("a line").to_owned()
}

#[test]
fn without_a_pin_everything_is_allowed_and_the_page_says_so() {
    let mut bench = Bench::new();
    for (action, _) in NEED {
        assert!(bench.station().allows(action), "{action:?}");
    }
    bench.open(Page::Settings);
    assert!(bench.says("No PIN is set"));
    assert!(is_greyed(&bench, "Lock") && is_greyed(&bench, "Access…"));
    assert!(is_greyed(&bench, "Set PIN: setter…") && !is_greyed(&bench, "Set PIN: engineer…"));
    bench.ahead.set(10 * UNTOUCHED);
    bench.harness.step();
    bench.open(Page::SetUp);
    assert!(!is_greyed(&bench, "Home…"));
}

#[test]
fn once_locked_what_needs_a_level_is_refused_by_the_station_and_greyed_with_the_level() {
    let (mut bench, file) = with_pins();
    let before = std::fs::read_to_string(&file).expect("readable");
    bench.station().home(Duration::ZERO);
    bench.until("it is ready", |station| {
        station.live.question == Some(Question::ByHand)
    });
    lock(&mut bench);

    let now = bench.station().live.journal.entries().last().expect("one").at;
    let place = |station: &Station| station.live.motion.as_ref().map(|motion| motion.reference);
    let stands = place(bench.station());
    let jog = || ByHand::Jog(Jog::now(JogWay::Axis(0), 20.0, Some(1.0)));
    for by_hand in [jog(), ByHand::Block("G1 X10 F600".to_owned())] {
        bench.station().send(Command::ByHand(by_hand), now);
    }
    for _ in 0..30 {
        bench.harness.step();
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(place(bench.station()), stands);
    bench.station().enter(SETTER, now).expect("let in");
    bench.station().send(Command::ByHand(jog()), now);
    bench.until("it moves", |station| place(station) != stands);
    bench.until("it is ready", |station| {
        station.live.question == Some(Question::ByHand)
    });
    lock(&mut bench);
    for (action, level) in NEED {
        let may = bench.station().allows(action);
        assert_eq!(may, level == Level::Operator, "{action:?}");
    }
    // Whoever is in sight of it may switch it off.
    bench.open(Page::SetUp);
    assert!(is_greyed(&bench, "Home…") && !is_greyed(&bench, "Drives off"));
    assert!(bench.says("Needs the access level: setter"));
    assert!(bench.harness.query_by_label("Arm the panel").is_none());
    bench.tap("Drives off");
    bench.until("it is off", |station| !station.is_running());

    bench.station().home(now);
    assert!(!bench.station().is_running());
    let taught = bench.station().teach(|| Ok(()));
    assert!(taught.is_err_and(|error| error.to_string().contains("setter")));
    let mut parameters = Parameters::open(&file).expect("readable");
    parameters.set("axes.X.max_jerk", "40000").expect("a number");
    let written = bench.station().write(&mut parameters, now);
    assert!(written.is_err_and(|error| error.to_string().contains("engineer")));
    assert_eq!(std::fs::read_to_string(&file).expect("readable"), before);
    let set = bench.station().set_pin(Level::Setter, None, now);
    assert!(set.is_err());

    bench.open(Page::Teach);
    assert!(bench.says("Needs the access level: setter"));
    bench.open(Page::Parameters);
    assert!(bench.says("Needs the access level: engineer") && is_greyed(&bench, "Write…"));
    bench.open(Page::Settings);
    assert!(is_greyed(&bench, "Set PIN: setter…") && is_greyed(&bench, "Remove PIN: setter"));

    // An operator runs programs.
    bench.weld(PROGRAM);
    bench.until("a beam is on", |station| station.live.beam_is_on());
    bench.open(Page::SetUp);
    bench.tap("Access…");
    assert!(bench.says("Enter the PIN"));
    bench.tap("STOP");
    bench.until("the job is over", |station| !station.is_running());
}

#[test]
fn a_pin_lets_in_from_where_it_is_needed_by_taps_and_by_keys() {
    let (mut bench, _file) = with_pins();
    lock(&mut bench);
    bench.open(Page::SetUp);
    bench.tap("Access…");
    bench.tap("Cancel");
    assert!(bench.says("Needs the access level: setter"));
    enter(&mut bench, SETTER);
    assert_eq!(bench.station().access().level(), Level::Setter);
    assert!(!is_greyed(&bench, "Home…") && bench.says("Arm the panel"));
    bench.open(Page::Parameters);
    assert!(bench.says("Needs the access level: engineer"));
    bench.tap("Access…");
    bench
        .harness
        .event(eframe::egui::Event::Text(format!("{ENGINEER}9")));
    bench.key(Key::Backspace);
    bench.key(Key::Enter);
    assert_eq!(bench.station().access().level(), Level::Engineer);
    assert!(!bench.says("Needs the access level"));
}

#[test]
fn three_wrong_pins_wait_and_are_on_record() {
    let (mut bench, _file) = with_pins();
    lock(&mut bench);
    bench.tap("Access…");
    for _ in 0..3 {
        assert!(!bench.says("Too many wrong PINs"));
        type_pin(&mut bench, "9999");
    }
    assert!(bench.says("Too many wrong PINs: wait 10 s."));
    assert!(is_greyed(&bench, "OK"));
    for text in [SETTER, "9999"] {
        bench.harness.event(eframe::egui::Event::Text(text.to_owned()));
        bench.key(Key::Enter);
        assert_eq!(bench.station().access().level(), Level::Operator);
    }
    bench.ahead.set(Duration::from_secs(11));
    bench.harness.step();
    assert!(!bench.says("Too many wrong PINs"));
    type_pin(&mut bench, SETTER);
    assert_eq!(bench.station().access().level(), Level::Setter);
    assert!(recorded(&mut bench, "entered: setter").contains("\tsetter\t"));
    assert_eq!(record(&bench).matches("\toperator\twrong PIN").count(), 3);
}

#[test]
fn two_different_pins_are_none_and_why_a_pin_is_none_is_said() {
    let mut bench = Bench::new();
    bench.open(Page::Settings);
    bench.tap("Set PIN: engineer…");
    type_pin(&mut bench, "1234");
    type_pin(&mut bench, "4321");
    assert!(bench.says("two different PINs"));
    for _ in 0..2 {
        type_pin(&mut bench, "123");
    }
    assert!(bench.says("A PIN has 4 to 8 digits."));
    bench.key(Key::Escape);
    assert!(bench.says("No PIN is set"));
}

#[test]
fn a_level_falls_back_where_nobody_touches_the_screen() {
    let (mut bench, _file) = with_pins();
    let past = |bench: &mut Bench, share: u32| {
        let ahead = bench.ahead.get() + UNTOUCHED / 10 * share;
        bench.ahead.set(ahead);
        bench.harness.run_steps(2);
    };
    past(&mut bench, 9);
    assert_eq!(bench.station().access().level(), Level::Engineer);
    bench.open(Page::SetUp);
    bench.tap("Arm the panel");
    past(&mut bench, 9);
    assert_eq!(bench.station().access().level(), Level::Engineer);
    past(&mut bench, 2);
    assert_eq!(bench.station().access().level(), Level::Operator);
    assert!(bench.says("Needs the access level: setter"));
    recorded(&mut bench, "untouched for 10 minutes");
}

#[test]
fn what_happened_and_how_it_looks_outlives_the_screen() {
    let (mut bench, file) = with_pins();
    let mut parameters = Parameters::open(&file).expect("readable");
    parameters.set("axes.X.max_jerk", "40000").expect("a number");
    let written = bench.station().write(&mut parameters, Duration::ZERO);
    written.expect("written");
    bench
        .station()
        .live
        .journal
        .alarm(Duration::ZERO, "something is wrong");
    bench.harness.state_mut().look.language = Language::German;
    bench.harness.run_steps(2);
    let mut bench = bench.again(|_| ());
    assert_eq!(bench.harness.state_mut().look.language, Language::German);
    bench.harness.state_mut().look.language = Language::English;
    assert_eq!(bench.station().access().level(), Level::Operator);
    bench.open(Page::Alarms);
    assert!(bench.says("Earlier, before the screen was opened"));
    assert!(bench.says("No alarms."));
    for text in [
        "PIN set: setter",
        "axes.X.max_jerk: 30000.0 → 40000.0",
        "something is wrong",
    ] {
        assert!(bench.says(text), "{text}");
    }
    let line = recorded(&mut bench, "max_jerk");
    assert!(line.contains("\tnote\tengineer\t"), "{line}");
    bench.open(Page::Settings);
    enter(&mut bench, ENGINEER);
    assert_eq!(bench.station().access().level(), Level::Engineer);
    bench.tap("Remove PIN: engineer");
    assert!(bench.says("removed last"));
    bench.tap("Remove PIN: setter");
    bench.tap("Remove PIN: engineer");
    assert!(bench.says("No PIN is set"));
    let mut bench = bench.again(|_| ());
    assert!(bench.station().allows(Action::Write));
}

#[test]
fn broken_settings_are_told_and_let_nobody_in_where_they_may_hold_pins() {
    let (bench, _file) = with_pins();
    let broken = |folder: &std::path::Path| {
        let file = folder.join("hmi.toml");
        let text = std::fs::read_to_string(&file).expect("written");
        std::fs::write(&file, text.replace("size = 1.0", "size = 1,0")).expect("written");
    };
    let mut bench = bench.again(broken);
    assert!(bench.says("hmi.toml") && bench.says("line 3") && bench.says("or delete it"));
    for (action, level) in NEED {
        let may = bench.station().allows(action);
        assert_eq!(may, level == Level::Operator, "{action:?}");
    }
    bench.open(Page::Settings);
    assert!(bench.says("may hold PINs") && is_greyed(&bench, "Access…"));
    bench.harness.state_mut().look.left_handed = true;
    bench.harness.run_steps(2);
    let kept = std::fs::read_to_string(bench.folder.path().join("hmi.toml")).expect("kept");
    assert!(kept.contains("size = 1,0"));
    // Without PINs in it, it is as usual.
    let mut bench = bench.again(|folder| {
        std::fs::write(folder.join("hmi.toml"), "hand = \"left\"\n").expect("written");
    });
    assert!(bench.says("hmi.toml") && bench.station().allows(Action::Write));
}

#[test]
fn the_pad_and_its_page_in_every_language() {
    let (mut bench, _file) = with_pins();
    bench.open(Page::Settings);
    bench.pictures("levels", |_| {});
    lock(&mut bench);
    bench.pictures("locked", |_| {});
    bench.pictures("locked-set-up", |bench| bench.open(Page::SetUp));
    bench.pictures("locked-parameters", |bench| bench.open(Page::Parameters));
    bench.pictures("access", |bench| {
        bench.tap("Access…");
        for digit in ["1", "3"] {
            bench.tap(digit);
        }
    });
    for _ in 0..3 {
        type_pin(&mut bench, "9999");
    }
    bench.pictures("access-wait", |_| {});
    bench.tap("Cancel");
}
