//! `seamwright calibrate` on pictures of a camera that is not as drawn.

use camera::{Picture, write_grey};
use config::calibration::Calibration;
use config::machine::MachineFile;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::{TempDir, tempdir};
use vision::render::{Finish, Gap, Joint, Root, Scene, Texture, TruthRenderer};
use vision::{Corner, Detector, Image, PhotonTransfer, PlateSeam, Prior};

/// The shipped machine.
fn machine_file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines/dual-beam-gantry.toml")
}

/// What the drawing says of camera 1.
fn drawn() -> Calibration {
    let machine = MachineFile::read(&machine_file()).expect("the shipped machine");
    machine.tracking.expect("a tracker").cameras.nominal(0)
}

/// What camera 1 is: turned by 0.7° more, 0.05 mm beside, and with another sensor.
fn built() -> Calibration {
    let drawn = drawn();
    let noise = PhotonTransfer {
        full_well: 16_000.0,
        read_noise: 22.0,
    };
    let mut built = Calibration::nominal(drawn.optics, noise, (-30.0f64 + 0.7).to_radians());
    built.slides.offset_mm = [0.03, -0.04];
    built
}

/// The camera as it is built, over a coupon.
struct Bench {
    renderer: TruthRenderer,
    camera: Calibration,
    shots: u64,
}

impl Bench {
    fn new() -> Self {
        let camera = built();
        Self {
            renderer: TruthRenderer::new(camera.optics, camera.photon_transfer, 1).expect("a renderer"),
            camera,
            shots: 0,
        }
    }

    /// u and n of a place at the slides' `at`, seen with the slides at `slides`.
    fn sees(&self, at: [f64; 2], slides: [f64; 2]) -> [f64; 2] {
        let [u, v] = self.camera.slides.offset_mm;
        self.camera
            .camera_step(at[0] - slides[0] - u, at[1] - slides[1] - v)
    }

    /// A plate with an open gap whose middle lies at u, n of the camera.
    fn gap(&mut self, [u, n]: [f64; 2], place: u64, width_mm: f64, level: f64) -> Picture {
        let roll = 0.7f64.to_radians();
        let gap = Gap::new(PlateSeam {
            height_mm: n - roll * u,
            pitch: 0.0,
            roll,
            lateral_mm: u,
            yaw_rad: 0.0,
            width_mm,
        });
        let mut scene = Scene::new(Joint::Gap(gap), Texture::new(Finish::Plain, 40 + place));
        scene.position_mm = [0.0, -u];
        scene.light.level = level;
        self.shoot(&scene)
    }

    fn shoot(&mut self, scene: &Scene) -> Picture {
        self.shots += 1;
        Picture {
            rows: self.camera.optics.rows,
            columns: self.camera.optics.columns,
            pixels: self.renderer.render(scene, self.shots),
            ..Picture::default()
        }
    }
}

/// Pictures and their list.
struct Album<'a> {
    folder: &'a TempDir,
    list: String,
    count: usize,
}

impl<'a> Album<'a> {
    fn new(folder: &'a TempDir, columns: &str) -> Self {
        Self {
            folder,
            list: format!("file,{columns}\n"),
            count: 0,
        }
    }

    fn add(&mut self, picture: &Picture, values: &[f64]) {
        self.count += 1;
        let name = format!("{}.png", self.count);
        write_grey(&self.folder.path().join(&name), picture).expect("a picture");
        let values: Vec<String> = values.iter().map(f64::to_string).collect();
        writeln!(self.list, "{name},{}", values.join(",")).expect("text");
        std::fs::write(self.folder.path().join("calibration.csv"), &self.list).expect("a list");
    }
}

/// Runs the program.
fn calibrate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_seamwright"))
        .arg("calibrate")
        .args(arguments)
        .output()
        .expect("the program")
}

/// Runs it for `what` on the pictures in `folder`; what is known before is in `file`, and what is found goes there.
fn refine(what: &str, file: &Path, folder: &TempDir, more: &[&str]) -> Output {
    let (file, folder) = (path(file), path(folder.path()));
    let arguments = [
        what,
        "--calibration",
        file,
        "--output",
        file,
        "--pictures",
        folder,
    ];
    calibrate(&[&arguments[..], more].concat())
}

fn path(file: &Path) -> &str {
    file.to_str().expect("a name in UTF-8")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Slides there and back, each on its own.
fn steps(size: f64) -> Vec<[f64; 2]> {
    let way = [0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0, 0.0].map(|x| x * size);
    let along = |axis: usize| way.map(|x| if axis == 0 { [x, 0.0] } else { [0.0, x] });
    [along(0), along(1)].concat()
}

/// Noise, profile and slides of a camera that is turned by 0.7°, displaced by 0.05 mm and noisier than drawn, one after the
/// other. Then what it measures, means of 4 pictures, is true to 5 µm; the drawing's camera is off by 40 µm and more.
#[test]
fn a_calibrated_camera_measures_what_is_true() {
    let mut bench = Bench::new();
    let file = tempdir().expect("a folder");
    let output = file.path().join("camera-1.toml");
    let machine = machine_file();

    let folder = tempdir().expect("a folder");
    let mut album = Album::new(&folder, "pair");
    for (pair, level) in [0.12, 0.25, 0.4].into_iter().enumerate() {
        for _ in 0..2 {
            album.add(&bench.gap([0.1, 0.05], 1, 0.1, level), &[pair as f64]);
        }
    }
    let arguments = [
        "noise",
        "--machine",
        path(&machine),
        "--side",
        "1",
        "--pictures",
        path(folder.path()),
    ];
    let ran = calibrate(&[&arguments[..], &["--output", path(&output)]].concat());
    assert!(ran.status.success(), "{}", said(&ran));
    let told = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(
        told.contains("full well") && told.contains("was 20000 e"),
        "{told}"
    );

    let go_on = |what: &str, folder: &TempDir, more: &[&str]| {
        let ran = refine(what, &output, folder, more);
        assert!(ran.status.success(), "{what}: {}", said(&ran));
    };
    let folder = tempdir().expect("a folder");
    let mut album = Album::new(&folder, "u_mm,v_mm");
    for k in -5..=5 {
        let slides = [0.0, 0.05 * f64::from(k)];
        let seen = bench.sees([0.0, 0.0], slides);
        album.add(&bench.gap(seen, 2, 0.0, 0.5), &slides);
    }
    go_on("profile", &folder, &[]);

    let folder = tempdir().expect("a folder");
    let mut album = Album::new(&folder, "place,u_mm,v_mm");
    let meets = [0.02, 0.03];
    for place in 0..4_u32 {
        for slides in steps(0.075) {
            let seen = bench.sees(meets, slides);
            let picture = bench.gap(seen, u64::from(place), 0.12, 0.5);
            album.add(&picture, &[f64::from(place), slides[0], slides[1]]);
        }
    }
    go_on("slides", &folder, &["--meets", "0.02,0.03"]);

    let found = Calibration::read(&output).expect("a calibration");
    let wells = found.photon_transfer.full_well / bench.camera.photon_transfer.full_well;
    assert!((wells - 1.0).abs() < 0.03, "{found:?}");
    let (true_to, drawn_off) = measured_off(&mut bench, &found);
    println!("calibrated off by {true_to:.4} mm at most, drawn by {drawn_off:.4} mm at least");
    assert!(true_to < 0.005, "off by {true_to} mm: {found:?}");
    assert!(drawn_off > 0.04, "the drawing is off by {drawn_off} mm only");
}

/// How far off the calibrated camera is at most, and the drawn one at least \[mm\].
fn measured_off(bench: &mut Bench, found: &Calibration) -> (f64, f64) {
    let mut detector = Detector::new(found.optics, found.photon_transfer, found.profile).expect("a detector");
    let (mut most, mut least) = (0.0, f64::INFINITY);
    for [u, v, seam_u, seam_v] in [
        [0.0, 0.0, 0.05, 0.08],
        [0.2, -0.1, 0.1, 0.0],
        [-1.5, 0.3, -1.6, 0.25],
        [3.0, 2.0, 2.9, 2.05],
    ] {
        let seen = bench.sees([seam_u, seam_v], [u, v]);
        let mut mean = [[0.0; 2]; 2];
        for place in 0..4 {
            let picture = bench.gap(seen, 100 + place, 0.1, 0.45);
            let image = Image::new(&picture.pixels, picture.rows, picture.columns).expect("a picture");
            let prior = Prior {
                joint: vision::Joint::Gap,
                track: None,
                focus: 0.0,
            };
            let report = detector.measure(&image, &prior).expect("a measurement");
            let measured = report.seam().expect("a seam");
            for (mean, camera) in mean.iter_mut().zip([found, &drawn()]) {
                let side =
                    camera.side_measurement(measured.lateral_mm, measured.travel_mm, measured.height_mm);
                mean[0] += side.delta_u_mm / 4.0;
                mean[1] += side.delta_v_mm / 4.0;
            }
        }
        let off = |mean: &[f64; 2]| (mean[0] + u - seam_u).hypot(mean[1] + v - seam_v);
        most = off(&mean[0]).max(most);
        least = off(&mean[1]).min(least);
    }
    (most, least)
}

/// A coupon with a rounded root, known by the slides at which the beam meets it.
#[test]
fn a_corner_is_calibrated_on_a_coupon() {
    let mut bench = Bench::new();
    let folder = tempdir().expect("a folder");
    let known = folder.path().join("camera-1.toml");
    std::fs::write(&known, bench.camera.to_toml()).expect("a file");
    let mut album = Album::new(&folder, "corner,u_mm,v_mm");
    let meets = [0.05, 0.1];
    for (place, slides) in (0..).zip(steps(0.03).into_iter().step_by(2)) {
        let [u, n] = bench.sees(meets, slides);
        let root = Root {
            rounding_mm: 0.3,
            ..Root::new(Corner {
                height_mm: n,
                lateral_mm: u,
                walls: [-0.75, 0.75],
            })
        };
        let scene = Scene::new(Joint::Corner(root), Texture::new(Finish::Plain, place));
        album.add(&bench.shoot(&scene), &[1.0, slides[0], slides[1]]);
    }
    let walls = ["--walls", "-36.87,36.87"];
    let ran = refine("corner", &known, &folder, &walls);
    assert!(
        !ran.status.success() && said(&ran).contains("say --meets U,V"),
        "{}",
        said(&ran)
    );
    let ran = refine(
        "corner",
        &known,
        &folder,
        &[&walls[..], &["--meets", "0.05,0.1"]].concat(),
    );
    assert!(ran.status.success(), "{}", said(&ran));
    let [u, n] = Calibration::read(&known)
        .expect("a calibration")
        .corner_offset_mm
        .expect("an offset");
    assert!(u.abs() < 0.004 && (-0.02..-0.002).contains(&n), "{u} {n}");
}

/// What is refused says why, and leaves the calibration that there is.
#[test]
fn a_poor_fit_leaves_the_file_as_it_was() {
    let mut bench = Bench::new();
    let folder = tempdir().expect("a folder");
    let known = folder.path().join("camera-1.toml");
    let text = bench.camera.to_toml();
    std::fs::write(&known, &text).expect("a file");
    let mut album = Album::new(&folder, "place,u_mm,v_mm");
    for slides in steps(0.02) {
        let seen = bench.sees([0.0, 0.0], slides);
        album.add(&bench.gap(seen, 1, 0.12, 0.5), &[0.0, slides[0], slides[1]]);
    }
    let ran = refine("slides", &known, &folder, &[]);
    assert!(!ran.status.success());
    let error = said(&ran);
    assert!(
        error.contains("camera-1.toml is not written: slide U moved by 0.080 mm only"),
        "{error}"
    );
    let ran = refine("profile", &known, &folder, &[]);
    assert!(
        said(&ran).contains("line 1: the header must be file,u_mm,v_mm"),
        "{}",
        said(&ran)
    );
    assert_eq!(std::fs::read_to_string(&known).expect("a file"), text);
    assert!(!folder.path().join("camera-1.toml.new").exists());
}

#[test]
fn what_belongs_to_another_task_is_said() {
    let ran = calibrate(&["noise", "--pictures", "none", "--output", "none.toml"]);
    assert!(said(&ran).contains("--machine FILE --side 1|2"), "{}", said(&ran));
    let ran = calibrate(&[
        "noise",
        "--pictures",
        "none",
        "--output",
        "none.toml",
        "--meets",
        "1,2",
    ]);
    assert!(
        said(&ran).contains("unexpected argument '--meets'"),
        "{}",
        said(&ran)
    );
    let ran = calibrate(&["corner", "--pictures", "none", "--output", "none.toml"]);
    assert!(said(&ran).contains("--walls"), "{}", said(&ran));

    let folder = tempdir().expect("a folder");
    let machine = folder.path().join("machine.toml");
    let text = std::fs::read_to_string(machine_file()).expect("the shipped machine");
    std::fs::write(&machine, text.replace("joint = \"gap\"", "joint = \"corner\"")).expect("a file");
    let arguments = ["camera", "--machine", path(&machine), "--side", "1"];
    let more = [
        "--boards",
        "simulated",
        "--at",
        "none.ngc",
        "--output",
        "none.toml",
    ];
    let ran = calibrate(&[&arguments[..], &more].concat());
    assert!(said(&ran).contains("a coupon is a gap"), "{}", said(&ran));
}

/// With the machine: the camera of a simulated one that is turned by 0.7° more than believed steps its own slides, at four
/// places of a coupon. The turn to 0.25°, lateral scale to 0.3 %. The camera's heights are 0.6 % too large, which the
/// calibration has to take out; what the texture of four places does to it is 0.1 % rms.
#[test]
fn a_machine_calibrates_its_own_camera() {
    let folder = tempdir().expect("a folder");
    let (machine, before) = (
        folder.path().join("machine.toml"),
        folder.path().join("before.toml"),
    );
    let text = std::fs::read_to_string(machine_file()).expect("the shipped machine");
    let turned = text.replace("mount_deg = [-30.0, 30.0]", "mount_deg = [-29.3, 30.0]");
    assert_ne!(turned, text);
    std::fs::write(&machine, turned).expect("a file");
    std::fs::write(&before, drawn().to_toml()).expect("a file");
    let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs/t-seam-400.ngc");
    let output = folder.path().join("camera-1.toml");
    let arguments = [
        "camera",
        "--machine",
        path(&machine),
        "--side",
        "1",
        "--boards",
        "simulated",
    ];
    let more = [
        "--calibration",
        path(&before),
        "--at",
        path(&program),
        "--places",
        "4",
        "--output",
        path(&output),
    ];
    let ran = calibrate(&[&arguments[..], &more].concat());
    assert!(ran.status.success(), "{}", said(&ran));
    let found = Calibration::read(&output).expect("a calibration").slides.matrix;
    let drawn = drawn().slides.matrix;
    let turn = |i: usize, j: usize| found[i][0] * drawn[j][0] + found[i][1] * drawn[j][1];
    let degrees = f64::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1)).to_degrees();
    assert!((degrees - 0.7).abs() < 0.25, "turned by {degrees}°");
    for (k, (reads, bound)) in [(1.0, 0.003), (1.006, 0.003)].into_iter().enumerate() {
        let scale = reads * found[0][k].hypot(found[1][k]);
        assert!((scale - 1.0).abs() < bound, "scale {scale}: {found:?}");
    }
}
