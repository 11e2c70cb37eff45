//! Teaching a seam by places, planning it, and welding it.

use crate::bench::{Bench, waits};
use egui_kittest::kittest::Queryable;
use hmi::screen::Page;
use hmi::station::Station;

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
