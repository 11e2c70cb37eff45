//! Teaching a seam by places, planning it, and welding it; teaching seams by the cameras.

use crate::bench::{Bench, waits};
use config::machine::MachineFile;
use egui_kittest::kittest::Queryable;
use hmi::screen::Page;
use hmi::station::Station;
use host_link::events::Phase;
use parts::PartFile;
use std::path::Path;

/// Taps a step of 10 mm, and waits until it is done.
fn step(bench: &mut Bench, direction: &str) {
    let place = |station: &Station| station.live.motion.as_ref().map(|motion| motion.reference);
    let before = place(bench.station());
    bench.tap(direction);
    bench.until("it has moved", |station| {
        waits(station) && place(station) != before
    });
}

#[test]
fn places_are_taken_taken_out_and_planned_and_the_seam_is_welded() {
    let mut bench = Bench::of("wire-arc");
    let folder = bench.folder.path().join("parts");
    std::fs::create_dir(&folder).expect("a folder");
    for file in ["lap-joint.toml", "welddata.toml"] {
        std::fs::copy(format!("../../programs/{file}"), folder.join(file)).expect("copied");
    }
    std::fs::write(folder.join("lap-joint.ngc"), "M2\n").expect("written");
    bench.station().programs.clone_from(&folder);

    bench.open(Page::Teach);
    bench.tap("Part…");
    bench.tap("lap-joint.toml");
    assert!(
        bench
            .harness
            .query_by_label_contains("Home on the page")
            .is_some()
    );
    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    bench.block("G0 X-60 Y-20 Z10");

    bench.open(Page::Teach);
    bench.tap("Take");
    bench.tap("Take");
    assert!(
        bench
            .harness
            .query_by_label("This place is taken already.")
            .is_some()
    );
    bench.tap("Arm the panel");
    bench.tap("Work");
    bench.tap("10");
    for (direction, times) in [("X +", 3), ("X +", 3), ("X +", 1), ("Y −", 1)] {
        for _ in 0..times {
            step(&mut bench, direction);
        }
        bench.tap("Take");
    }
    bench.tap("Undo");
    bench.pictures("teach", |_| {});
    let taught = std::fs::read_to_string(folder.join("lap-joint-taught.csv")).expect("written at once");
    let places: Vec<&str> = taught.lines().skip(1).collect();
    assert_eq!(places.len(), 4, "{taught}");
    assert!(
        places[0].starts_with("-60.0000") && places[2].starts_with("0.0000"),
        "{taught}"
    );

    bench.tap("Plan program");
    bench.until("it is loaded", |station| {
        !station.is_loading() && station.loaded().is_some()
    });
    assert_eq!(bench.station().refused(), None);
    let before =
        std::fs::read_to_string(folder.join("lap-joint.ngc.0001")).expect("the program before is kept");
    assert_eq!(before, "M2\n");
    bench.open(Page::Run);
    bench.tap("Start…");
    bench.tap("Weld now");
    bench.until("the job runs", |station| station.runs_program());
    bench.until("the job is over", |station| !station.is_running());
    assert_eq!(bench.station().last().expect("an outcome").error, None);

    // The lesson can be gone on with, or begun anew; what was taught is kept.
    bench.open(Page::Teach);
    bench.tap("Begin anew…");
    bench.tap("Take out");
    let kept = std::fs::read_to_string(folder.join("lap-joint-taught.csv.0001")).expect("kept");
    assert_eq!(kept, taught);
}

/// A part with seams of some 100 mm in `folder`.
fn short_seams(folder: &Path) {
    std::fs::create_dir(folder).expect("a folder");
    for side in [1, 2] {
        let drawn =
            std::fs::read_to_string(format!("../../programs/t-seam-400-seam{side}.csv")).expect("a seam");
        let short: Vec<&str> = drawn.lines().take(22).collect();
        std::fs::write(folder.join(format!("seam{side}.csv")), short.join("\n")).expect("written");
    }
    let part =
        "[t-seam]\nseam_1 = \"seam1.csv\"\nseam_2 = \"seam2.csv\"\nspeed_m_min = 5.0\npower_w = 2000.0\n";
    std::fs::write(folder.join("short.toml"), part).expect("written");
}

/// How the seams of that part deviate, on simulated boards.
fn deviation(folder: &Path) {
    let file = "../../programs/t-seam-400-deviation.csv";
    std::fs::copy(file, folder.join("short-deviation.csv")).expect("copied");
}

/// Lines of a program that say where the tip goes.
fn places(program: &str) -> Vec<&str> {
    program.lines().filter(|line| line.contains(" X")).collect()
}

#[test]
fn the_cameras_are_taught_seams_in_two_lessons_and_the_program_is_planned() {
    let mut bench = Bench::new();
    let folder = bench.folder.path().join("parts");
    short_seams(&folder);
    bench.station().programs.clone_from(&folder);
    let taught = folder.join("short-taught.csv");

    bench.open(Page::Teach);
    bench.tap("Part…");
    bench.tap("short.toml");
    assert!(bench.says("0 points in short-taught.csv"));
    bench.tap("Teach…");
    bench.tap("Teach now");
    assert!(bench.says("short-deviation.csv is missing") && !bench.station().is_running());
    deviation(&folder);
    bench.tap("Teach…");
    bench.tap("Teach now");
    bench.until("two points are taught", |station| {
        station.live.phase == Some(Phase::TeachingSeam { number: 3 })
    });
    assert!(!bench.station().runs_program());
    bench.tap("End after this point");
    bench.until("the lesson is over", |station| !station.is_running());
    bench.harness.run_steps(2);
    assert!(bench.says("ended by the operator"));
    assert!(bench.says("3 points in short-taught.csv"));

    bench.tap("Teach…");
    assert!(bench.says("It goes on after point 3."));
    bench.tap("Teach now");
    bench.until("it goes on", |station| {
        station.live.phase == Some(Phase::TeachingSeam { number: 5 })
    });
    assert!(bench.says("4 points in short-taught.csv"));
    bench.pictures("teach-seams", |_| {});
    bench.until("the lesson is over", |station| !station.is_running());
    bench.harness.run_steps(2);
    assert!(bench.says("the seam is taught as far as it is drawn"));
    let points = std::fs::read_to_string(&taught).expect("written at once");

    bench.tap("Plan program");
    bench.until("it is loaded", |station| {
        !station.is_loading() && station.loaded().is_some()
    });
    assert_eq!(bench.station().refused(), None);
    let program = std::fs::read_to_string(folder.join("short.ngc")).expect("planned");
    // From the points, which are beside the drawing.
    let machine = MachineFile::read(bench.station().machine_file()).expect("a machine");
    let part = PartFile::read(&folder.join("short.toml")).expect("a part");
    let drawn = part.drawn(&machine).expect("a plan").expect("a drawing");
    assert_ne!(places(&program), places(&drawn.program));

    bench.tap("Begin anew…");
    bench.tap("Take out");
    assert!(bench.says("0 points in short-taught.csv"));
    let kept = std::fs::read_to_string(folder.join("short-taught.csv.0001")).expect("kept");
    assert_eq!(kept, points);
}
