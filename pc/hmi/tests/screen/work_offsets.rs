//! Work offsets: set where the tip stands and by value, kept, and gone by.

use crate::bench::{Bench, PROGRAM, waits};
use config::work_offsets::{System, WorkOffset, WorkOffsets};
use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use hmi::screen::Page;
use hmi::station::Station;
use host_link::{ByHand, Command, Jog, JogWay};
use std::time::Duration;

/// Taps the value of what is called `name`.
fn choose(bench: &mut Bench, name: &str) {
    bench.harness.get_by_role_and_label(Role::Button, name).click();
    bench.harness.run_steps(3);
}

fn tip(station: &Station) -> [f64; 3] {
    let axes = station.live.motion.as_ref().expect("a state").axes;
    let machine = station.by_hand().expect("a machine");
    machine.planner.tip(&axes).position_mm
}

#[test]
fn a_work_offset_is_set_where_the_tip_stands_kept_on_record_and_blocks_by_hand_go_by_it() {
    let (mut bench, file) = Bench::with_own_file();
    let program = bench.folder.path().join("square.ngc");
    let square = "G21 G90 G54 G64 P0.05\nG0 X0 Y0 Z20 A0 B0 C0\nG1 X50 F3000\nY50\nX0\nY0\nM2\n";
    std::fs::write(&program, square).expect("written");
    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    bench.block("G0 X900 Y900 Z100 A0 B0 C0");

    bench.tap("Work offsets…");
    choose(&mut bench, "X");
    bench.tap("Set tip here to value");
    choose(&mut bench, "Y");
    bench.type_in("Value", "12");
    bench.tap(".");
    bench.tap("5");
    bench.tap("Set tip here to value");
    bench.tap("G59.1");
    bench.type_in("Value", "x");
    assert!(bench.says("Not a number from"));
    bench.type_in("Value", "0,25");
    choose(&mut bench, "Turn about Z");
    bench.tap("Set origin to value");
    bench.pictures("work-offsets", |bench| bench.tap("● G54"));
    bench.tap("Save");
    bench.until("blocks by hand go by it", |station| {
        waits(station) && station.live.told.is_some()
    });

    let kept = WorkOffsets::beside(&file).expect("work offsets");
    let first = kept.of(System::G54);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 0.01, "{a} is not {b}");
    near(first.origin[0], 900.0);
    near(first.origin[1], 887.5);
    assert_eq!(first.origin[2..], [0.0; 4]);
    let turned = WorkOffset {
        rotation_deg: 0.25,
        ..WorkOffset::default()
    };
    assert_eq!(kept.of(System::G59_1), turned);
    let block = Command::ByHand(ByHand::Block("G0 X-5".to_owned()));
    bench.station().send(block, Duration::ZERO);
    bench.until("it is 5 mm beside the origin", |station| {
        waits(station) && (tip(station)[0] - 895.0).abs() < 0.01
    });
    bench.tap("Drives off");
    bench.until("the drives are off", |station| !station.is_running());
    bench.open(Page::Alarms);
    assert!(bench.says("G54.X: 0 → ") && bench.says("G59.1.rotation_deg: 0 → 0.25"));

    // A program that calls it is there, and it is told.
    bench.load(program.to_str().expect("a name"));
    let loaded = bench.station().loaded().expect("a program").clone();
    let end = loaded.drawn.way.places.last().expect("a way").pose.position;
    near(end.x, first.origin[0]);
    near(end.y, first.origin[1]);
    let told = loaded
        .notices
        .iter()
        .any(|notice| notice.contains("G54 as it was set at the machine"));
    assert!(told, "{:?}", loaded.notices);

    // What would lie beyond the travel is not loaded, and a file that is wrong is told by its line.
    std::fs::write(WorkOffsets::file(&file), "[G54]\nX = 5000.0\n").expect("written");
    bench.station().load(program.clone(), None);
    bench.until("it is refused", |station| station.refused().is_some());
    std::fs::write(WorkOffsets::file(&file), "[G54]\nW = 1.0\n").expect("written");
    bench.open(Page::SetUp);
    bench.tap("Work offsets…");
    assert!(bench.says("dual-beam-gantry.offsets.toml, line 2: "));
}

fn is_greyed(bench: &Bench, button: &str) -> bool {
    bench.harness.get_by_label(button).accesskit_node().is_disabled()
}

/// The seam that camera 1 sees from where the machine stands now: the mean of some pictures \[mm\].
fn sighted(bench: &mut Bench) -> [f64; 3] {
    let newest = |station: &Station| station.live.pictures[0].as_ref().map(|picture| picture.capture);
    let mut sum = [0.0; 3];
    // Those on their way were taken before.
    for count in 0..10 {
        let before = newest(bench.station());
        bench.until("another picture", |station| newest(station) != before);
        bench.until("a seam in it", |station| station.sighted(0).is_some());
        let position = bench.station().sighted(0).expect("a seam").position;
        if count >= 2 {
            sum = std::array::from_fn(|axis| sum[axis] + position[axis] / 8.0);
        }
    }
    sum
}

#[test]
fn a_work_offset_is_set_to_where_a_camera_sees_its_seam() {
    let (mut bench, file) = Bench::with_own_file();
    bench.load(PROGRAM);
    bench.open(Page::SetUp);
    bench.tap("Home…");
    bench.tap("Home now");
    bench.until("it is ready", waits);
    bench.block("G0 X400 Y300 Z250 A0 B0 C11.2233");
    bench.block("G0 Z96.536");
    let seam = sighted(&mut bench);

    // The seam stays where it is, from wherever it is seen; only along it another place is.
    let (sin, cos) = 11.2233_f64.to_radians().sin_cos();
    let stays = |bench: &mut Bench, what: &str| {
        let again = sighted(bench);
        let [x, y, z] = std::array::from_fn(|axis| again[axis] - seam[axis]);
        let across = y * cos - x * sin;
        assert!(across.abs() < 0.01 && z.abs() < 0.01, "{what}: {across} {z}");
    };
    bench.block("G91 G1 Y0.15 F60");
    stays(&mut bench, "across");
    bench.block("G91 G1 Z0.05 F60");
    stays(&mut bench, "up");
    slide(&mut bench, 0, -2.0);
    stays(&mut bench, "by U1");
    slide(&mut bench, 1, 2.0);
    stays(&mut bench, "by V1");

    bench.tap("Work offsets…");
    choose(&mut bench, "Y");
    while is_greyed(&bench, "Set seam 1 to value") {
        bench.until("another frame", |_| true);
    }
    // Nothing is typed, which is 0.
    bench.tap("Set seam 1 to value");
    choose(&mut bench, "Z");
    bench.type_in("Value", "12.5");
    bench.tap("Set seam 1 to value");
    choose(&mut bench, "Turn about Z");
    assert!(is_greyed(&bench, "Set seam 1 to value"));
    bench.pictures("work-offsets-cameras", |_| {});
    bench.tap("Save");
    bench.until("blocks by hand go by it", |station| {
        waits(station) && station.live.told.is_some()
    });
    let kept = WorkOffsets::beside(&file).expect("work offsets").of(System::G54);
    let off = [kept.origin[1] - seam[1], kept.origin[2] + 12.5 - seam[2]];
    assert!(
        kept.origin[0] == 0.0 && off.iter().all(|off| off.abs() < 0.05),
        "{off:?}"
    );
}

/// Jogs a slide by 0.2 mm.
fn slide(bench: &mut Bench, slide: usize, speed: f64) {
    let at = |station: &Station| {
        station
            .live
            .tracker
            .as_ref()
            .map_or(0.0, |tracker| tracker.slides_mm[slide])
    };
    let before = at(bench.station());
    let moved = |station: &Station| (at(station) - before).abs() > 0.15;
    while !moved(bench.station()) {
        // On a busy computer it may be asked for too late, which is told.
        let jog = Jog::now(JogWay::Slide(slide), speed, Some(0.2));
        bench
            .station()
            .send(Command::ByHand(ByHand::Jog(jog)), Duration::ZERO);
        bench.until("it is there, or refused", |station| {
            waits(station) && (moved(station) || station.live.told.is_some())
        });
    }
}
