//! Commissioning at the screen: motors are measured, looked at, written; a circle is made.

use crate::bench::{Bench, PROGRAM};
use config::calibration::Calibration;
use config::machine::MachineFile;
use eframe::egui::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use hmi::access::Level;
use hmi::live::What;
use hmi::screen::Page;
use hmi::texts::Language;
use host_link::events::Phase;
use job::{CircularTest, Plane};
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest wait for what is evaluated.
const PATIENCE: Duration = Duration::from_secs(120);
/// A drawn machine; with the shipped gains its B and C swing.
const RINGS: &str = "draw:usual:1";

fn bench(plant: &str) -> (Bench, std::path::PathBuf) {
    let (mut bench, file) = Bench::with_own_file();
    bench.station().place.plant = plant.parse().expect("a plant");
    open(&mut bench);
    (bench, file)
}

/// With the page in sight, and everything evaluated.
fn open(bench: &mut Bench) {
    bench.open(Page::Commission);
    until_says(bench, "X1: ");
    until_evaluated(bench);
}

fn until_says(bench: &mut Bench, text: &str) {
    let end = Instant::now() + PATIENCE;
    while !bench.says(text) {
        assert!(Instant::now() < end, "waited too long: {text}");
        bench.harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn until_evaluated(bench: &mut Bench) {
    let end = Instant::now() + PATIENCE;
    bench.harness.step();
    while bench.says("is being evaluated") {
        assert!(Instant::now() < end, "waited too long");
        bench.harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Ticks these motors and no other.
fn tick(bench: &mut Bench, motors: &[&str]) {
    for name in ["X1", "X2", "Y", "Z", "A", "B", "C"] {
        let find = |bench: &Bench| bench.harness.get_by_role_and_label(Role::CheckBox, name).click();
        if is_ticked(bench, name) != motors.contains(&name) {
            find(bench);
            bench.harness.run_steps(3);
        }
    }
}

fn is_ticked(bench: &Bench, name: &str) -> bool {
    let tick = bench.harness.get_by_role_and_label(Role::CheckBox, name);
    format!("{:?}", tick.accesskit_node().toggled()).contains("True")
}

fn is_greyed(bench: &Bench, button: &str) -> bool {
    bench.harness.get_by_label(button).accesskit_node().is_disabled()
}

fn measure(bench: &mut Bench, motors: &[&str]) {
    tick(bench, motors);
    bench.tap("Measure…");
    bench.tap("Measure now");
    assert!(bench.station().is_commissioning());
}

fn is_over(bench: &mut Bench) {
    bench.until("the job is over", |station| !station.is_running());
    until_evaluated(bench);
}

fn text(file: &Path) -> String {
    std::fs::read_to_string(file).expect("readable")
}

/// The drawn plant of the dual-beam gantry with that noise [°/s] at the drive of B.
fn noisy(bench_folder: &Path, noise: &str) -> String {
    let shipped = text(Path::new("../../machines/dual-beam-gantry.plant.toml"));
    let (before, b) = shipped.split_once("[motors.B.drive]\n").expect("B");
    let plant = format!("{before}[motors.B.drive]\nnoise = {noise}\n{b}");
    let file = bench_folder.join("noisy.plant.toml");
    std::fs::write(&file, plant).expect("written");
    file.display().to_string()
}

#[test]
fn two_motors_are_measured_looked_at_written_and_on_record_and_another_start_goes_on() {
    let (mut bench, file) = bench(RINGS);
    let before = text(&file);
    for name in ["X1", "B", "C"] {
        assert!(bench.says(&format!("{name}: not measured")) && is_ticked(&bench, name));
    }
    assert!(is_greyed(&bench, "Write…"));
    // Nothing moves by one touch, and what will is told.
    tick(&mut bench, &["B", "C"]);
    bench.tap("Measure…");
    for told in [
        "Measure B, C?",
        "B: 19 times 20.00 ° there and back",
        "1.00 ° to both sides",
        "about 4 min",
    ] {
        assert!(bench.says(told), "{told}");
    }
    bench.pictures("commission-measure", |_| {});
    bench.tap("Cancel");
    assert!(!bench.station().is_running());
    bench.tap("Measure…");
    bench.tap("Measure now");
    bench.until("B is excited", |station| {
        matches!(station.live.phase, Some(Phase::Exciting { motor: "B", .. }))
    });
    assert!(bench.says("moving") && is_greyed(&bench, "Measure…"));
    bench.pictures_in("commission-runs", &[Language::English], |_| {});
    is_over(&mut bench);
    assert_eq!(text(&file), before);

    bench.tap("B: measured");
    for told in [
        "swings by itself",
        "Write what was found",
        "-5.4",
        "111.4",
        "7.7",
        "notch at 66.4 Hz",
    ] {
        assert!(bench.says(told), "{told}");
    }
    bench.pictures("commission", |_| {});
    bench.tap("Write…");
    assert!(bench.says("motors.B.kp: 120.0 → 111.4") && bench.says("motors.C.kp: 120.0"));
    bench.pictures("commission-write", |_| {});
    let c = bench.harness.get_by_role_and_label(Role::Button, "C");
    c.click();
    bench.harness.run_steps(3);
    assert!(!bench.says("motors.C.kp") && bench.says("dual-beam-gantry.toml.0001"));
    assert_eq!(text(&file), before);
    bench.tap("Write now");
    until_evaluated(&mut bench);
    assert!(bench.says("B: written") && bench.says("C: measured") && bench.says("X1: not measured"));
    assert!(bench.says("It is in the machine file"));
    let after = text(&file);
    assert!(after.contains("kp = 111.4 # commissioned; was 120.0"), "{after}");
    assert_eq!(after.matches("kp = 120.0").count(), 6);
    assert_eq!(text(&file.with_file_name("dual-beam-gantry.toml.0001")), before);
    let entries = bench.station().live.journal.entries();
    let changed: Vec<_> = entries
        .filter_map(|entry| match &entry.what {
            What::Parameter(change) => Some(change.key.clone()),
            _ => None,
        })
        .collect();
    assert!(changed.contains(&"motors.B.kp".to_owned()), "{changed:?}");
    assert!(
        changed.iter().all(|key| key.starts_with("motors.B.")),
        "{changed:?}"
    );
    // One entry a motor, not one an excitation.
    let entries = bench.station().live.journal.entries();
    let excited = entries.filter(|entry| matches!(entry.what, What::Phase(Phase::Exciting { .. })));
    assert_eq!(excited.count(), 2);

    let mut bench = bench.again(|_| ());
    open(&mut bench);
    assert!(bench.says("B: written") && bench.says("C: measured") && bench.says("X1: not measured"));
    assert!(is_ticked(&bench, "X1") && !is_ticked(&bench, "B") && !is_ticked(&bench, "C"));
    let record = text(&bench.folder.path().join("record.tsv"));
    assert!(record.contains("motors.B.kp: 120.0 → 111.4"), "{record}");
    // What was found of C is of what the file has now, whoever has changed it.
    let theirs = text(&file).replace("kp = 120.0", "kp = 60.0");
    std::fs::write(&file, theirs).expect("written");
    open(&mut bench);
    bench.tap("C: measured before the file was changed");
    assert!(bench.says("has other values of this motor since") && bench.says("60.0"));
    assert!(bench.says("B: written"));
}

#[test]
fn a_motor_that_is_refused_is_told_with_what_to_do_and_never_written() {
    let (mut bench, file) = bench(RINGS);
    let before = text(&file);
    let plant = noisy(bench.folder.path(), "2.0");
    bench.station().place.plant = plant.parse().expect("a plant");
    measure(&mut bench, &["B"]);
    is_over(&mut bench);
    bench.tap("B: left as it is");
    for told in [
        "have a coherence above 0.9",
        "a brake that is not open",
        "grey is not believed",
    ] {
        assert!(bench.says(told), "{told}");
    }
    assert!(is_greyed(&bench, "Write…"));
    bench.pictures("commission-refused", |_| {});
    assert_eq!(text(&file), before);
}

#[test]
fn what_was_measured_before_a_stop_is_kept() {
    let (mut bench, _file) = bench(RINGS);
    measure(&mut bench, &["B", "C"]);
    bench.until("C is excited", |station| {
        matches!(station.live.phase, Some(Phase::Exciting { motor: "C", .. }))
    });
    bench.tap("STOP");
    is_over(&mut bench);
    assert!(bench.says("It ended early: stopped by the operator"));
    assert!(bench.says("B: measured") && bench.says("C: not measured"));
    assert!(is_ticked(&bench, "C") && !is_ticked(&bench, "B"));
    // A fault ends it, too.
    let plant = noisy(bench.folder.path(), "200.0");
    bench.station().place.plant = plant.parse().expect("a plant");
    measure(&mut bench, &["B"]);
    is_over(&mut bench);
    assert!(bench.says("It ended early: the motion board stopped"));
    assert!(bench.says("B: measured"));
}

#[test]
fn an_operator_and_a_setter_may_look_and_no_more() {
    let (mut bench, _file) = bench("draw:usual:1");
    let set = bench
        .station()
        .set_pin(Level::Engineer, Some("24680"), Duration::ZERO);
    set.expect("a PIN");
    bench.station().lock(Duration::ZERO);
    bench.harness.run_steps(2);
    assert!(bench.says("Needs the access level: engineer"));
    assert!(is_greyed(&bench, "Measure…") && is_greyed(&bench, "Write…"));
    bench.tap("Circular test");
    assert!(is_greyed(&bench, "Go round…"));
    let refused = bench.station().measure(&[0], Duration::ZERO);
    assert_eq!(
        refused.map_err(|error| error.to_string()),
        Err("needs the access level engineer".to_owned())
    );
    let test = CircularTest {
        plane: Plane::Xy,
        radius_mm: 100.0,
        speed_m_per_min: 9.0,
    };
    assert!(bench.station().circle(test, Duration::ZERO).is_err());
    assert!(!bench.station().is_running());
    bench.pictures("locked-commission", |_| {});
}

#[test]
fn a_circle_is_asked_for_made_and_judged() {
    let (mut bench, _file) = bench("draw:usual:311");
    bench.tap("Circular test");
    assert!(bench.says("No circle was made yet"));
    bench.type_in("Radius [mm]", "2000");
    bench.tap("Go round…");
    bench.tap("Go round now");
    assert!(bench.says("does not fit into the travel of"));
    bench.type_in("Radius [mm]", "-1");
    assert!(bench.says("must be numbers above 0") && is_greyed(&bench, "Go round…"));
    bench.type_in("Radius [mm]", "50");
    bench.type_in("Speed [m/min]", "6");
    bench.tap("Go round…");
    assert!(bench.says("Go round? 50 mm in XY at 6 m/min"));
    bench.pictures("commission-go-round", |_| {});
    assert!(!bench.station().is_running());
    bench.tap("Go round now");
    is_over(&mut bench);
    assert!(bench.says("G3: from the circle") && bench.says("both directions: G(b)"));
    bench.type_in("Limit [mm] (empty: none)", "0.0001");
    assert!(bench.says("OUTSIDE the limit of 0.0001 mm"));
    bench.type_in("Limit [mm] (empty: none)", "0.9");
    assert!(bench.says("Within the limit of 0.9 mm"));
    bench.type_in("Limit [mm] (empty: none)", "0.01");
    bench.pictures("commission-circle", |_| {});
    let folder = bench.folder.path().join("0001-circular-test");
    assert!(folder.join("circle.svg").metadata().expect("a plot").len() > 10_000);
    assert!(bench.says("0001-circular-test"));
    let mut entries = bench.station().live.journal.entries();
    assert!(entries.any(|entry| {
        matches!(&entry.what, What::Said(text) if text.contains("circle of 50 mm in XY") && text.contains("G(b)"))
    }));
}

#[test]
fn the_spot_of_a_camera_is_found_by_marks_and_its_calibration_written_after_two_questions() {
    let (mut bench, file) = bench("draw:usual:401");
    bench.tap("Camera to spot");
    assert!(bench.says("No spot was found yet") && bench.says("No program is loaded."));
    assert!(is_greyed(&bench, "Burn marks…"));
    // Marks wait for nobody, so neither may the program that says where the plate lies.
    let waiting = bench.folder.path().join("waits.ngc");
    let text = std::fs::read_to_string(PROGRAM).expect("a program");
    std::fs::write(&waiting, text.replacen('\n', "\nM0\n", 1)).expect("written");
    bench.load(waiting.to_str().expect("a name"));
    bench.tap("Burn marks…");
    bench.tap("Burn now");
    assert!(bench.says("the program waits for the operator") && !bench.station().is_running());
    bench.load(PROGRAM);
    bench.type_in("Length of a mark [mm]", "9");
    assert!(bench.says("from 10 to 100 mm") && is_greyed(&bench, "Burn marks…"));
    bench.type_in("Length of a mark [mm]", "25");
    bench.tap("Camera 2");
    bench.tap("Burn marks…");
    assert!(bench.says("BOTH BEAMS BURN with 500 W: two marks of 25 mm") && bench.says("80 mm long"));
    bench.pictures("commission-burn", |_| {});
    assert!(!bench.station().is_running());
    bench.tap("Burn now");
    is_over(&mut bench);
    bench.pictures("commission-spot", |_| {});
    let calibration = file.with_file_name("camera-2.toml");
    assert!(!calibration.exists() && bench.says("The machine file names no calibrations yet."));
    bench.tap("Write calibration…");
    bench.tap("Cancel");
    assert!(!calibration.exists());
    bench.tap("Write calibration…");
    assert!(bench.says("The calibration of camera 2") && !bench.says("is kept as"));
    bench.tap("Write now");
    bench.until("the program is planned anew", |station| {
        station.loaded().is_some()
    });
    // Where the plant has its camera: mounted beside the spot, with a lead of its own.
    let written = Calibration::read(&calibration).expect("a calibration");
    let machine = MachineFile::read(&file).expect("a machine");
    let plant = bench.station().place.plant.of(machine.motion.kinematics.name());
    let mount = plant.expect("a plant").cameras[1];
    let found = written.spot.expect("a spot");
    let off = [0, 1].map(|i| written.slides.offset_mm[i] - mount.beside_spot_mm[i]);
    assert!(off.iter().all(|off| off.abs() < 0.006), "{off:?}");
    let lead_mm = machine.tracking.expect("cameras").board.head.camera_lead_mm + mount.lead_error_mm;
    assert!((found.lead_mm - lead_mm).abs() < 0.1, "{found:?}");
    assert!((found.delay_s - mount.delay_s).abs() < 0.2e-3, "{found:?}");

    // Another time what was written before is kept, and the same is not written twice.
    bench.tap("Write calibration…");
    bench.tap("Write now");
    assert!(bench.says("nothing is changed"));
    bench.type_in("Length of a mark [mm]", "20");
    bench.tap("Burn marks…");
    bench.tap("Burn now");
    is_over(&mut bench);
    bench.tap("Write calibration…");
    assert!(bench.says("camera-2.toml.0001"));
    bench.tap("Write now");
    assert_eq!(
        Calibration::read(&file.with_file_name("camera-2.toml.0001")).expect("the one before"),
        written
    );
    bench.open(Page::Alarms);
    assert!(bench.says("camera-2.toml made") && bench.says("camera 2: the spot has moved by"));
}
