//! The cameras while the machine is operated by hand.

use crate::bench::{Bench, PROGRAM, waits};
use hmi::screen::Page;
use hmi::station::Station;
use host_link::events::Focus;

/// Of the newest picture of camera 1: its capture, and by how much its seam is out of focus \[mm\].
fn defocus(station: &Station) -> Option<(u32, f64)> {
    let picture = station.live.pictures[0].as_ref()?;
    match picture.focus {
        Focus::Band { defocus_mm, .. } => Some((picture.capture, defocus_mm?)),
        _ => None,
    }
}

/// The same of a picture that is taken from now on.
fn next_defocus(bench: &mut Bench) -> f64 {
    // Those on their way were taken before.
    let newest = |station: &Station| {
        station.live.pictures[0]
            .as_ref()
            .map_or(0, |picture| picture.capture)
    };
    for _ in 0..2 {
        let before = newest(bench.station());
        bench.until("another picture", |station| newest(station) > before);
    }
    bench.until("a seam in it", |station| defocus(station).is_some());
    defocus(bench.station()).expect("a seam").1
}

#[test]
fn by_hand_the_cameras_are_live_and_tell_how_far_and_to_which_side_the_work_is_out_of_focus() {
    let mut bench = Bench::new();
    bench.load(PROGRAM);
    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    bench.until("there are pictures of both", |station| {
        station.live.pictures.iter().all(Option::is_some)
    });
    assert!(bench.says("Sharpness 0.0, best 0.0"));

    // Where the drawing has the seam, one camera's lead before it.
    bench.block("G0 X400 Y300 Z250 A0 B0 C11.2233");
    bench.block("G0 Z96.536");
    bench.until("the seam is seen", |station| {
        station.live.pictures[0]
            .as_ref()
            .is_some_and(|picture| picture.seam.is_some())
    });
    bench.pictures("cameras", |_| {});
    let before = next_defocus(&mut bench);
    // The camera comes nearer, by which the work is higher than its focus.
    bench.block("G91 G1 Z-0.05 F60");
    let nearer = next_defocus(&mut bench);
    assert!((nearer - before - 0.05).abs() < 0.01, "{before} {nearer}");

    // The best is held, until somebody taps on it.
    bench.block("G91 G1 Z20 F2000");
    bench.until("nothing is sharp", |station| defocus(station).is_none());
    bench.until("it is far away", |station| {
        let picture = station.live.pictures[0].as_ref();
        picture.is_some_and(|picture| picture.focus == Focus::Nothing || picture.focus == Focus::TooLow)
    });
    let held: Vec<String> = bars(&bench);
    assert!(
        held[0].starts_with("Sharpness 0.0, best ") && held[0] != "Sharpness 0.0, best 0.0",
        "{held:?}"
    );
    bench.tap(&held[0]);
    assert_eq!(bars(&bench)[0], "Sharpness 0.0, best 0.0");
    bench.tap("Drives off");
    bench.until("the drives are off", |station| !station.is_running());
    assert!(!bench.says("Sharpness"));
}

/// What the bars say.
fn bars(bench: &Bench) -> Vec<String> {
    use egui_kittest::kittest::{NodeT, Queryable};
    let bars = bench.harness.query_all_by_label_contains("Sharpness");
    bars.filter_map(|bar| bar.accesskit_node().label()).collect()
}
