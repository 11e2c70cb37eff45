//! `seamwright measure` as a person uses it: pictures with a known truth, and wrong ones.

use camera::{Picture, Recorder, read_grey, write_grey, write_rgb};
use config::calibration::Calibration;
use config::machine::MachineFile;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::{TempDir, tempdir};
use vision::render::{Finish, Gap, Joint, Light, Root, Scene, Stripe, Texture, TruthRenderer};
use vision::{Corner, Optics, PlateSeam};

const ROWS: usize = 300;
const COLUMNS: usize = 400;

/// How far a measurement may lie beside the truth \[mm\].
const LATERAL_MM: f64 = 0.005;
const HEIGHT_MM: f64 = 0.01;

/// A camera of the shipped machine as it is drawn, along the normal of its head, but with the published 4x lens.
fn drawn() -> Calibration {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines/dual-beam-gantry.toml");
    let machine = MachineFile::read(&file).expect("the shipped machine");
    let cameras = machine.tracking.expect("a tracker").cameras;
    let optics = Optics {
        magnification: 4.0,
        ..cameras.optics
    };
    Calibration::nominal(optics, cameras.photon_transfer, 0.0)
}

/// A temporary folder with a calibration.
struct Scratch(TempDir);

impl Scratch {
    fn new() -> Self {
        let folder = tempdir().expect("a folder");
        let calibration = drawn();
        std::fs::write(folder.path().join("camera.toml"), calibration.to_toml()).expect("written");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Renders a scene into a file.
    fn picture(&self, name: &str, scene: &Scene) -> PathBuf {
        let path = self.path(name);
        write_grey(&path, &rendered(scene)).expect("written");
        path
    }

    /// Measures; exit code, output and errors.
    fn measure(&self, words: &[&str]) -> (i32, String, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_seamwright"))
            .current_dir(self.0.path())
            .args(["measure", "--calibration", "camera.toml"])
            .args(words)
            .output()
            .expect("seamwright runs");
        let text = |bytes| String::from_utf8(bytes).expect("text");
        (
            output.status.code().expect("an exit code"),
            text(output.stdout),
            text(output.stderr),
        )
    }

    /// Measures one picture as JSON.
    fn json(&self, words: &[&str]) -> serde_json::Value {
        let (code, said, errors) = self.measure(&[words, &["--json"]].concat());
        assert_eq!((code, errors.as_str()), (0, ""));
        let records: serde_json::Value = serde_json::from_str(&said).expect("JSON");
        records[0].clone()
    }
}

fn rendered(scene: &Scene) -> Picture {
    let camera = drawn();
    let mut renderer = TruthRenderer::new(camera.optics, camera.photon_transfer, 1).expect("a camera");
    Picture {
        rows: ROWS,
        columns: COLUMNS,
        pixels: renderer.render(scene, 7),
        ..Picture::default()
    }
}

fn plate() -> PlateSeam {
    PlateSeam {
        height_mm: 0.06,
        pitch: 0.0,
        roll: 0.05,
        lateral_mm: 0.08,
        yaw_rad: 0.03,
        width_mm: 0.12,
    }
}

fn gap(plate: PlateSeam) -> Scene {
    Scene::new(Joint::Gap(Gap::new(plate)), Texture::new(Finish::Plain, 5))
}

#[track_caller]
fn assert_says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "no {part:?} in: {said}");
    }
}

#[track_caller]
fn assert_near(record: &serde_json::Value, figure: &str, truth: f64, tolerance: f64) {
    let value = record["measured"][figure]["value"].as_f64().expect("a figure");
    assert!(
        (value - truth).abs() < tolerance,
        "{figure} is {value}, not {truth}"
    );
}

#[test]
fn a_gap_is_measured_and_drawn() {
    let scratch = Scratch::new();
    let scene = gap(plate());
    scratch.picture("seam.png", &scene);
    let truth = scene.truth(&drawn().optics).expect("it can be seen");
    let record = scratch.json(&["seam.png"]);
    assert_eq!(
        (&record["status"], &record["measured"]["joint"]),
        (&"seam".into(), &"gap".into())
    );
    assert_near(&record, "lateral_mm", truth.centre_mm, LATERAL_MM);
    let height_mm = truth.height_mm + truth.roll * truth.centre_mm;
    assert_near(&record, "height_mm", height_mm, HEIGHT_MM);
    assert_near(&record, "width_mm", 0.12, 0.01);

    let (code, said, errors) = scratch.measure(&["seam.png", "--overlay", "drawn", "--enlarge", "3"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    assert_says(&said, &["picture", "across u [mm]", "seam.png  seam", "±"]);
    let mut grey = Picture::default();
    let colours = read_grey(&scratch.path("drawn/seam.png"), &mut grey).expect_err("coloured");
    assert_says(&colours.to_string(), &["coloured pixels"]);
    let header = std::fs::read(scratch.path("drawn/seam.png")).expect("drawn");
    // Two lines of words stand below.
    assert_eq!(header[16..24], [0, 0, 4, 176, 0, 0, 3, 184], "1200 × 952 pixels");
    assert_eq!(record["verdict"], "seam");
    assert!(!said.contains("pictures:"), "no summary of one: {said}");
}

#[test]
fn a_corner_is_measured_between_its_walls() {
    let scratch = Scratch::new();
    let corner = Corner {
        height_mm: -0.15,
        lateral_mm: 0.05,
        walls: [-0.8, 0.9],
    };
    let texture = Texture::new(Finish::Plain, 5);
    scratch.picture(
        "corner.png",
        &Scene::new(Joint::Corner(Root::new(corner)), texture),
    );
    let record = scratch.json(&["corner.png", "--joint", "corner", "--walls", "-39,42"]);
    assert_eq!(
        (&record["status"], &record["measured"]["joint"]),
        (&"seam".into(), &"corner".into())
    );
    assert_near(&record, "lateral_mm", 0.05, 0.015);
    assert_near(&record, "height_mm", -0.15, 0.015);
    let (code, said, _) = scratch.measure(&["corner.png", "--joint", "corner", "--overlay", "drawn"]);
    assert_eq!(code, 0);
    assert_says(&said, &["walls: -", "left", "right"]);
    let (code, _, errors) = scratch.measure(&["corner.png", "--joint", "corner", "--walls", "-45,90"]);
    assert_eq!(code, 2);
    assert_says(&errors, &["two slopes between -85 and 85"]);
}

#[test]
fn a_picture_of_no_use_says_why() {
    let scratch = Scratch::new();
    let closed = gap(PlateSeam {
        width_mm: 0.0,
        ..plate()
    });
    scratch.picture("closed.png", &closed);
    let dark = Scene {
        light: Light::even(0.0),
        ..gap(plate())
    };
    scratch.picture("dark.png", &dark);
    let high = gap(PlateSeam {
        height_mm: 0.45,
        ..plate()
    });
    scratch.picture("high.png", &high);
    let scratched = Scene {
        stripes: vec![Stripe {
            offset_mm: -0.25,
            width_mm: 0.03,
            factor: 0.4,
        }],
        ..gap(plate())
    };
    scratch.picture("scratched.png", &scratched);
    let pictures = ["closed.png", "dark.png", "high.png", "scratched.png"];
    let (code, said, errors) = scratch.measure(&[&pictures[..], &["--overlay", "drawn"]].concat());
    assert_eq!((code, errors.as_str()), (0, ""));
    assert_says(
        &said,
        &[
            "no seam",
            "no dark line across it",
            "dark.png       dark",
            "the light is off, or no work lies before the camera",
            "too high",
            "the work is probably higher than the picture reaches: move the camera away",
            "scratched.png  seam",
        ],
    );
    // A scratch has the texture of the plate: it is no second gap.
    assert!(!said.contains("second"), "{said}");
    for picture in pictures {
        assert!(scratch.path("drawn").join(picture).is_file(), "{picture}");
    }
    assert_says(
        &said,
        &[
            "4 pictures: 1 with a seam, 0 doubtful, 3 refused",
            "refused       1  there is a sharp band, but no dark line across it",
            "gap width  0.1",
        ],
    );
}

#[test]
fn wrong_files_are_told_and_the_others_are_measured() {
    let scratch = Scratch::new();
    scratch.picture("good.png", &gap(plate()));
    std::fs::write(scratch.path("text.png"), "no picture").expect("written");
    write_rgb(&scratch.path("colours.png"), 2, 2, &[9; 12]).expect("written");
    let small = Picture {
        rows: 100,
        columns: 200,
        pixels: vec![100; 20_000],
        ..Picture::default()
    };
    write_grey(&scratch.path("small.png"), &small).expect("written");
    std::fs::create_dir(scratch.path("empty")).expect("a folder");
    let wrong = ["none.png", "text.png", "colours.png", "small.png", "empty"];
    let (code, said, errors) = scratch.measure(&[&wrong[..], &["good.png"]].concat());
    assert_eq!(code, 1);
    let good = |line: &str| line.starts_with("good.png ") && line.contains(" seam ");
    assert!(said.lines().any(good), "{said}");
    let lines: Vec<&str> = errors.lines().collect();
    assert_eq!(lines.len(), wrong.len(), "{errors}");
    let parts = [
        ["cannot read picture none.png", "No such file"],
        ["text.png is not a PNG file", "damaged"],
        ["colours.png has coloured pixels", "convert it"],
        [
            "small.png: a picture of 100 × 200 pixels",
            "a camera of 300 × 400",
        ],
        ["cannot read empty/captures.csv", "No such file"],
    ];
    for (line, parts) in lines.iter().zip(parts) {
        assert_says(line, &parts);
        assert_eq!(
            line.matches("os error").count(),
            usize::from(line.contains("No such file")),
            "{line}"
        );
    }
}

#[test]
fn a_missing_calibration_is_told_with_the_remedy() {
    let scratch = Scratch::new();
    std::fs::remove_file(scratch.path("camera.toml")).expect("removed");
    let (code, said, errors) = scratch.measure(&["seam.png"]);
    assert_eq!((code, said.as_str()), (1, ""));
    assert_says(
        &errors,
        &["cannot read calibration camera.toml", "seamwright calibrate"],
    );
}

#[test]
fn an_overlay_overwrites_no_picture() {
    let scratch = Scratch::new();
    let path = scratch.picture("seam.png", &gap(plate()));
    let before = std::fs::read(&path).expect("read");
    let (code, _, errors) = scratch.measure(&["seam.png", "--overlay", "."]);
    assert_eq!(code, 1);
    assert_says(&errors, &["would overwrite picture seam.png", "another folder"]);
    assert_eq!(std::fs::read(&path).expect("read"), before);

    std::fs::create_dir(scratch.path("other")).expect("a folder");
    std::fs::copy(&path, scratch.path("other/seam.png")).expect("copied");
    let (code, _, errors) = scratch.measure(&["seam.png", "other/seam.png", "--overlay", "drawn"]);
    assert_eq!(code, 1);
    assert_says(
        &errors,
        &["no overlay of picture other/seam.png", "another one of that name"],
    );
}

#[test]
fn a_folder_of_captures_is_followed_as_a_camera_would() {
    let scratch = Scratch::new();
    let mut recorder = Recorder::new(&scratch.path("kept")).expect("a folder");
    let camera = drawn();
    let mut renderer = TruthRenderer::new(camera.optics, camera.photon_transfer, 1).expect("a camera");
    for capture in 1..=8 {
        // The last but one shows another seam.
        let lateral_mm = if capture == 7 { -0.2 } else { 0.08 };
        let scene = gap(PlateSeam {
            lateral_mm,
            ..plate()
        });
        let picture = Picture {
            capture,
            time_us: 5_000 * u64::from(capture),
            rows: ROWS,
            columns: COLUMNS,
            pixels: renderer.render(&scene, u64::from(capture)),
        };
        recorder.add(&picture).expect("kept");
    }
    let (code, said, errors) = scratch.measure(&["kept"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    let of = |capture: usize| {
        let pictures: Vec<&str> = said.split("capture-").collect();
        pictures[capture].to_owned()
    };
    assert_says(&of(1), &["seam", "acquiring; not accepted yet"]);
    assert_says(&of(2), &["acquiring; not accepted yet"]);
    assert_says(&of(3), &["tracking"]);
    assert!(!of(5).contains("mean"), "{said}");
    assert_says(&of(6), &["tracking; mean: across +0.08"]);
    assert_says(&of(8), &["tracking; mean: across +0.08"]);
    // The last but one.
    assert_says(
        &said,
        &[
            "8 pictures: 7 with a seam, 1 doubtful, 0 refused",
            "doubtful      1  its position differs from that of the seam before",
        ],
    );
    let (code, said, _) = scratch.measure(&["kept", "--sheets", "sheets"]);
    assert_eq!(code, 0);
    assert_says(&said, &["contact sheet sheets/doubtful.png: 1 of 1"]);
    assert!(scratch.path("sheets/doubtful.png").is_file());
    assert!(
        !scratch.path("sheets/refused.png").exists(),
        "nothing was refused"
    );
    let (code, said, _) = scratch.measure(&["kept", "--json"]);
    let records: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!((code, records.as_array().map(Vec::len)), (0, Some(8)));
    assert_eq!(records[7]["observed"]["state"], "tracking");
    assert_eq!(records[6]["observed"]["believed"], false, "{records}");
}
