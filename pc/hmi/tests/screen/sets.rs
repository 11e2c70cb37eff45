//! Tools and weld data at the screen: changed with the pad, checked by the readers of their files, written, on record.

use crate::bench::{Bench, waits};
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use hmi::screen::Page;
use std::path::Path;

/// A job with weld data beside it, and its machine.
const JOINT: &str = "butt-joint.ngc";

fn text(file: &Path) -> String {
    std::fs::read_to_string(file).expect("readable")
}

fn is_greyed(bench: &Bench, button: &str) -> bool {
    bench.harness.get_by_label(button).accesskit_node().is_disabled()
}

/// Taps the value of what is called `name`.
fn choose(bench: &mut Bench, name: &str) {
    bench.harness.get_by_role_and_label(Role::Button, name).click();
    bench.harness.run_steps(3);
}

/// Types `value` into the field of the pad.
fn keys(bench: &mut Bench, value: &str) {
    bench.type_in("Value", value);
}

/// A copy of the job and of its weld data; where it is.
fn own_job(bench: &Bench) -> std::path::PathBuf {
    for file in [JOINT, "welddata.toml"] {
        let from = Path::new("../../programs").join(file);
        std::fs::copy(from, bench.folder.path().join(file)).expect("copied");
    }
    bench.folder.path().join(JOINT)
}

#[test]
fn tools_are_made_changed_and_taken_out_by_the_pad_and_a_program_goes_by_them() {
    let (mut bench, file) = Bench::with_own_file();
    let before = text(&file);
    let program = bench.folder.path().join("longer.ngc");
    std::fs::write(
        &program,
        "G21 G90 G64 P0.05\nG43 H2\nG0 X900 Y900 Z120 A0 B0 C0\nM2\n",
    )
    .expect("written");
    bench.load(program.to_str().expect("a name"));
    let height = |bench: &mut Bench| {
        let loaded = bench.station().loaded().expect("a program").clone();
        loaded.drawn.way.places.last().expect("a way").pose.position.z
    };
    let bare = height(&mut bench);

    bench.open(Page::SetUp);
    bench.tap("Tools…");
    assert!(bench.says("There are no tools") && is_greyed(&bench, "Write…"));
    for (number, length) in [("2", "12.5"), ("10", "0.25")] {
        keys(&mut bench, number);
        bench.tap("New tool with this number");
        choose(&mut bench, "Length");
        keys(&mut bench, length);
        bench.tap("Set to value");
    }
    // There is one already.
    keys(&mut bench, "2");
    assert!(is_greyed(&bench, "New tool with this number"));
    bench.tap("Delete");
    choose(&mut bench, "Diameter");
    keys(&mut bench, "1001");
    bench.tap("Set to value");
    assert!(bench.says("tools.10.diameter_mm is 1001, but must be from -1000 to 1000"));
    assert!(is_greyed(&bench, "Write…"));
    bench.type_in("Value", "-6,5");
    bench.tap("Set to value");
    assert!(!bench.says("Refused"));
    bench.pictures("tools", |_| {});

    // Nothing is written by one touch.
    bench.tap("Write…");
    assert!(bench.says("tools.2.length_mm: left out → 12.5"));
    bench.tap("Cancel");
    assert_eq!(text(&file), before);
    bench.tap("Write…");
    bench.tap("Write now");
    let written = text(&file);
    let tools = "\n[tools.2]\nlength_mm = 12.5\ndiameter_mm = 0.0\n\n[tools.10]\nlength_mm = 0.25\ndiameter_mm = -6.5\n";
    assert_eq!(written.replacen(tools, "", 1), before);
    let version = file.with_file_name("dual-beam-gantry.toml.0001");
    assert_eq!(text(&version), before);
    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    let longer = height(&mut bench);
    assert!(
        (longer - bare - 12.5).abs() < 1e-6,
        "{longer} is not 12.5 above {bare}"
    );
    bench.open(Page::Alarms);
    assert!(bench.says("tools.10.diameter_mm: left out → -6.5") && bench.says("dual-beam-gantry.toml.0001"));

    // What somebody else has written meanwhile is not written over.
    bench.open(Page::SetUp);
    bench.tap("Tools…");
    bench.tap("T10");
    bench.tap("Take tool out");
    let theirs = format!("{written}# theirs\n");
    std::fs::write(&file, &theirs).expect("written");
    bench.tap("Write…");
    bench.tap("Write now");
    assert!(bench.says("The file on the disk has changed since it was loaded."));
    assert_eq!(text(&file), theirs);
    bench.tap("Cancel");
    bench.tap("Tools…");
    bench.tap("T10");
    bench.tap("Take tool out");
    bench.tap("Write…");
    bench.tap("Write now");
    assert_eq!(
        text(&file),
        theirs.replacen("\n[tools.10]\nlength_mm = 0.25\ndiameter_mm = -6.5\n", "", 1)
    );
}

#[test]
fn tools_stay_as_they_are_while_the_drives_are_on() {
    let (mut bench, _file) = Bench::with_own_file();
    bench.open(Page::SetUp);
    assert!(!is_greyed(&bench, "Tools…") && is_greyed(&bench, "Weld data…"));
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    assert!(is_greyed(&bench, "Tools…") && !is_greyed(&bench, "Work offsets…"));
    assert!(bench.says("Tools are changed while the drives are off."));
}

#[test]
fn weld_data_of_the_program_are_changed_as_far_as_their_reader_lets_them_be() {
    let (mut bench, _file) = Bench::with_own_file_of("wire-arc");
    let program = own_job(&bench);
    let file = bench.folder.path().join("welddata.toml");
    let before = text(&file);
    bench.load(program.to_str().expect("a name"));
    bench.open(Page::SetUp);
    bench.tap("Weld data…");
    bench.tap("root");
    choose(&mut bench, "ignition.time_s");
    keys(&mut bench, "0.01");
    bench.tap("Set to value");
    assert!(bench.says("root.ignition.time_s is 0.01, but must be from 0.1 to 60"));
    assert!(is_greyed(&bench, "Write…"));
    keys(&mut bench, "0.6");
    bench.tap("Set to value");
    choose(&mut bench, "power");
    bench.type_in("Value", "hot");
    bench.tap("Set to value");
    assert!(bench.says("Must be a number"));
    bench.type_in("Value", "3100");
    bench.tap("Set to value");
    bench.pictures("weld-data", |_| {});
    bench.tap("Write…");
    for change in ["root.power: 3200.0 → 3100.0", "root.ignition.time_s: 0.4 → 0.6"] {
        assert!(bench.says(change), "{change}");
    }
    bench.tap("Write now");
    let after =
        before
            .replacen("power = 3200.0", "power = 3100.0", 1)
            .replacen("time_s = 0.4", "time_s = 0.6", 1);
    assert_eq!(text(&file), after);
    assert_eq!(text(&file.with_file_name("welddata.toml.0001")), before);
    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    let loaded = bench.station().loaded().expect("a program").clone();
    assert_eq!(loaded.machine.welding.sets["root"].power, 3100.0);
    bench.open(Page::Alarms);
    assert!(bench.says("root.power: 3200.0 → 3100.0"));

    // What the machine does not have is told here, and mended here.
    for (outputs, is_refused) in [("[\"air\"]", true), ("[\"gas\", \"wire\"]", false)] {
        bench.open(Page::SetUp);
        bench.tap("Weld data…");
        choose(&mut bench, "outputs");
        bench.type_in("Value", outputs);
        bench.tap("Set to value");
        bench.tap("Write…");
        bench.tap("Write now");
        bench.until("the program is planned anew", |station| !station.is_loading());
        assert_eq!(bench.station().refused().is_some(), is_refused);
        assert_eq!(bench.says("air"), is_refused);
    }
    assert_eq!(text(&file), after);
}

#[test]
fn without_sets_it_is_said_how_they_are_made_and_a_file_that_is_wrong_is_told_by_its_line() {
    let mut bench = Bench::new();
    let program = bench.folder.path().join("square.ngc");
    std::fs::write(&program, "G21 G90\nG0 X900 Y900 Z120 A0 B0 C0\nM2\n").expect("written");
    bench.load(program.to_str().expect("a name"));
    bench.open(Page::SetUp);
    bench.tap("Weld data…");
    assert!(bench.says("There are no sets yet.") && bench.says("WELDON=root") && is_greyed(&bench, "Write…"));
    bench.pictures("no-weld-data", |_| {});
    bench.tap("Cancel");
    let file = bench.folder.path().join("welddata.toml");
    std::fs::write(&file, "[root]\npower = -1.0\n").expect("written");
    bench.tap("Weld data…");
    assert!(bench.says("root.power is -1, but must be 0 or more"));
}

#[test]
fn the_first_set_makes_the_file_and_what_somebody_else_has_made_meanwhile_is_not_written_over() {
    let mut bench = Bench::new();
    let program = bench.folder.path().join("square.ngc");
    std::fs::write(&program, "G21 G90\nG0 X900 Y900 Z120 A0 B0 C0\nM2\n").expect("written");
    bench.load(program.to_str().expect("a name"));
    let file = bench.folder.path().join("welddata.toml");
    let first = |bench: &mut Bench| {
        bench.open(Page::SetUp);
        bench.tap("Weld data…");
        keys(bench, "two words");
        assert!(is_greyed(bench, "New set with this name"));
        keys(bench, "first-pass");
        bench.tap("New set with this name");
        choose(bench, "power");
        keys(bench, "2500");
        bench.tap("Set to value");
        bench.tap("+ ramp_up");
        assert!(bench.harness.query_by_label("+ ramp_up").is_none());
        choose(bench, "ramp_up.over_mm");
        keys(bench, "6");
        bench.tap("Set to value");
        bench.pictures("first-weld-data", |_| {});
        bench.tap("Write…");
        assert!(bench.says("first-pass.power: left out → 2500.0") && !bench.says("is kept as"));
    };
    first(&mut bench);
    std::fs::write(&file, "[theirs]\npower = 1.0\n").expect("written");
    bench.tap("Write now");
    assert!(bench.says("The file on the disk has changed since it was loaded."));
    assert_eq!(text(&file), "[theirs]\npower = 1.0\n");
    bench.tap("Cancel");
    std::fs::remove_file(&file).expect("removed");
    first(&mut bench);
    bench.tap("Write now");
    let made = "[first-pass]\npower = 2500.0\nramp_up = { power = 2500.0, over_mm = 6.0 }\n";
    assert_eq!(text(&file), made);
    assert!(!file.with_file_name("welddata.toml.0001").exists());
    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    bench.open(Page::Alarms);
    assert!(bench.says("welddata.toml made") && bench.says("first-pass.power: left out → 2500.0"));
}

#[test]
fn a_new_set_begins_as_the_one_that_is_chosen_and_sets_are_taken_out() {
    let (mut bench, _file) = Bench::with_own_file_of("wire-arc");
    let program = own_job(&bench);
    let file = bench.folder.path().join("welddata.toml");
    let before = text(&file);
    bench.load(program.to_str().expect("a name"));
    bench.open(Page::SetUp);
    bench.tap("Weld data…");
    bench.tap("root");
    keys(&mut bench, "cap");
    assert!(is_greyed(&bench, "New set with this name"));
    keys(&mut bench, "hot-root");
    bench.tap("New set with this name");
    bench.tap("● hot-root");
    choose(&mut bench, "power");
    keys(&mut bench, "3500");
    bench.tap("Set to value");
    bench.tap("Write…");
    bench.tap("Write now");
    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    let loaded = bench.station().loaded().expect("a program").clone();
    let sets = &loaded.machine.welding.sets;
    assert_eq!((sets["root"].power, sets["hot-root"].power), (3200.0, 3500.0));
    assert_eq!(sets["hot-root"].tacks, sets["root"].tacks);
    assert!(text(&file).starts_with(&before));

    // What the program calls is told to be missing, as soon as it is.
    bench.tap("Weld data…");
    bench.tap("hot-root");
    bench.tap("Take set out");
    bench.tap("cap");
    bench.tap("Take set out");
    bench.tap("Write…");
    assert!(bench.says("hot-root.power: 3500.0 → left out") && bench.says("cap.power: 3600.0 → left out"));
    bench.tap("Write now");
    bench.until("the program is planned anew", |station| !station.is_loading());
    assert!(bench.says("cap") && bench.station().refused().is_some());
}
