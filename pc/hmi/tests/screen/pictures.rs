//! Pictures of every page in every language, written to `hmi` in the folder of the tests' temporary files, from where those in
//! docs/images/hmi are. A letter that no font has and a button without a name fail here.

use crate::bench::{Bench, PROGRAM};
use eframe::egui::Key;
use hmi::screen::Page;
use hmi::texts::Language;

/// Path length at which the weld is looked at \[mm\].
const MID_WELD: f64 = 250.0;

#[test]
fn every_page_in_every_language() {
    let mut bench = Bench::new();
    bench.pictures("load", |bench| bench.tap("Load…"));
    bench.tap("Cancel");
    bench.load(PROGRAM);
    bench.pictures("start", |bench| bench.tap("Start…"));
    bench.tap("Weld now");
    bench.until("it is in mid-weld", |station| {
        station.live.along_mm().is_some_and(|mm| mm > MID_WELD)
    });
    bench.pictures("run", |_| {});
    bench.pictures("plot", |bench| bench.open(Page::Plot));
    bench.open(Page::Run);
    bench.until("the job is over", |station| !station.is_running());
    bench.pictures("finished", |_| {});
    bench.pictures("welds", |bench| bench.open(Page::Welds));
    bench.weld(PROGRAM);
    bench.until("a beam is on", |station| station.live.beam_is_on());
    bench.tap("STOP");
    bench.until("the job is over", |station| !station.is_running());
    bench.pictures("alarms", |bench| bench.open(Page::Alarms));
    bench.pictures("parameters", |bench| {
        bench.open(Page::Parameters);
        bench.type_in("Search", "axes");
        for (key, value) in [("axes.X.max_jerk", "40000"), ("axes.X.max_velocity", "350")] {
            bench.tap_containing(&format!("{key} ="));
            bench.type_in("Value", value);
            bench.key(Key::Enter);
        }
    });
    bench.pictures("write", |bench| bench.tap("Write…"));
    bench.tap("Cancel");
    bench.tap("Discard");
    bench.pictures("screen", |bench| bench.open(Page::Settings));
    bench.harness.state_mut().look.high_contrast = true;
    bench.harness.state_mut().look.left_handed = true;
    bench.pictures_in("run-left", &[Language::English], |bench| bench.open(Page::Run));
}
