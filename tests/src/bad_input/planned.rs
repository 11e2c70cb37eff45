//! What a command does with an input that it could read, without boards.

use crate::shipped;
use cam::dry_run;
use cam::path::Planner;
use camera::{Arrival, Camera, Picture, parse_grey};
use config::calibration::Calibration;
use config::machine::MachineFile;
use config::weld_data::WeldData;
use nc::{Motion, Options, interpret};
use parts::PartFile;
use std::io::Cursor;
use std::path::Path;
use std::sync::{Arc, LazyLock};
use std::time::Duration;
use tempfile::{NamedTempFile, TempPath};
use vision::{Detector, Image, Joint, Prior};
use world::{Deviation, FieldOfView, RenderedWorld, SceneFile, View, ViewForm, check_seam};

/// Rows and columns of a picture above which it is not measured here: that takes a share of a second.
const LARGEST: usize = 256;

/// Programs that take longer are planned, and not run.
const LONGEST_DRY_RUN_S: f64 = 20.0;

fn shipped_text(file: &str) -> String {
    std::fs::read_to_string(shipped(file)).expect("a shipped file")
}

fn shipped_machine(name: &str) -> MachineFile {
    let machine = MachineFile::read(&shipped(&format!("machines/{name}.toml")));
    machine.unwrap_or_else(|error| panic!("{error}"))
}

/// As `seamwright dry-run` does.
pub fn program(machine: &str, text: &str) -> anyhow::Result<()> {
    dry_run_of(&shipped_machine(machine), text)
}

fn dry_run_of(machine: &MachineFile, text: &str) -> anyhow::Result<()> {
    let planner = Planner::build(machine)?;
    let from = machine.homed_axes();
    let options = Options {
        setup: Arc::new(planner.setup(&from)),
        ..Options::default()
    };
    let program = interpret(text, options)?;
    let paths = planner.program(&program, &from, None)?;
    // A dry run takes as long as the program has milliseconds.
    let slowest_s: f64 = paths
        .iter()
        .filter(|path| path.motion == Motion::Feed)
        .map(|path| path.length_mm() / path.speeds().slowest_mm_s)
        .sum();
    if slowest_s < LONGEST_DRY_RUN_S {
        dry_run::run(machine, &planner, &paths, 1.0)?;
    }
    Ok(())
}

/// As `seamwright check --seam` does.
pub fn deviation(text: &str) -> anyhow::Result<()> {
    let machine = shipped_machine("dual-beam-gantry");
    let program = interpret(&shipped_text(crate::PROGRAM), Options::default())?;
    let paths = Planner::build(&machine)?.program(&program, &machine.homed_axes(), None)?;
    check_seam(&paths, &machine, Some(&Deviation::parse("a.csv", text)?))?;
    Ok(())
}

/// As `seamwright plan` does.
pub fn part(machine: &str, text: &str) -> anyhow::Result<()> {
    plan(machine, &shipped("programs/a.toml"), text)
}

fn plan(machine: &str, path: &Path, text: &str) -> anyhow::Result<()> {
    let machine = MachineFile {
        welding: WeldData::read(&shipped("programs/welddata.toml"))?,
        ..shipped_machine(machine)
    };
    let plan = PartFile::parse(path, text)?.plan(&machine, "a")?;
    let program = interpret(&plan.program, Options::default())?;
    Planner::build(&machine)?.program(&program, &machine.planning.park_axes(), None)?;
    Ok(())
}

/// A temporary file with `text`.
fn written(text: &str) -> anyhow::Result<TempPath> {
    let file = NamedTempFile::new()?;
    std::fs::write(&file, text)?;
    Ok(file.into_temp_path())
}

/// A rib with one of its files in the place of the shipped one.
pub fn rib(key: &str, text: &str) -> anyhow::Result<()> {
    let file = written(text)?;
    let mut part = String::from("[t-seam]\nspeed_m_min = 5.0\npower_w = 2000.0\n");
    for seam in ["seam_1", "seam_2"].into_iter().filter(|_| key != "taught") {
        let path = match seam == key {
            true => file.to_path_buf(),
            false => shipped(&format!("programs/t-seam-400-{}.csv", seam.replace('_', ""))),
        };
        part += &format!("{seam} = '{}'\n", path.display());
    }
    if key == "taught" {
        part += &format!("taught = '{}'\n", file.display());
    }
    plan("dual-beam-gantry", Path::new("a.toml"), &part)
}

/// A panel that was taught.
pub fn panel(text: &str) -> anyhow::Result<()> {
    let file = written(text)?;
    let taught = format!("[panel]\ntaught = '{}'", file.display());
    let part = shipped_text("programs/panel.toml").replacen("[panel]", &taught, 1);
    plan("ac-head", Path::new("a.toml"), &part)
}

/// A saddle that was taught.
pub fn saddle(text: &str) -> anyhow::Result<()> {
    let file = written(text)?;
    let part = shipped_text("programs/saddle-taught.toml");
    let part = part.replace("\"saddle-taught.csv\"", &format!("'{}'", file.display()));
    plan("pipe-welder", Path::new("a.toml"), &part)
}

/// A seam through taught places.
pub fn places(text: &str) -> anyhow::Result<()> {
    let file = written(text)?;
    let part = shipped_text("programs/lap-joint.toml");
    let part = part.replace("\"lap-joint-taught.csv\"", &format!("'{}'", file.display()));
    plan("wire-arc", Path::new("a.toml"), &part)
}

/// A bead along the curve.
pub fn bead(text: &str) -> anyhow::Result<()> {
    let file = written(text)?;
    let part = format!(
        "[bead]\nnurbs_file = '{}'\nwindow_mm_s = [4.0, 16.0]\npower_w = 2000.0\nlead_mm = 3.0\noverlap_mm = 2.0\n",
        file.display()
    );
    plan("wire-arc", Path::new("a.toml"), &part)
}

/// What the program beside the shipped data becomes with these.
pub fn weld_data(text: &str) -> anyhow::Result<()> {
    let machine = MachineFile {
        welding: WeldData::parse("a.toml", text)?,
        ..shipped_machine("wire-arc")
    };
    let program = interpret(&shipped_text("programs/butt-joint.ngc"), Options::default())?;
    Planner::build(&machine)?.program(&program, &machine.homed_axes(), None)?;
    Ok(())
}

/// The part that is quickly planned for the machine, and a short program on it.
pub fn machine(text: &str) -> anyhow::Result<()> {
    let machine = MachineFile::parse("a.toml", text)?;
    let axes = machine.planning.park_axes();
    let part = match machine.motion.kinematics.name() {
        "dual-beam-gantry" => Some("t-seam-400"),
        "stir-gantry" => Some("stir-contour"),
        _ => None,
    };
    if let Some(part) = part {
        PartFile::read(&shipped(&format!("programs/{part}.toml")))?.plan(&machine, "a")?;
    }
    let [x, _, z, ..] = axes;
    dry_run_of(
        &machine,
        &format!("G53 G0 X{x:.5} Z{z:.5}\nG53 G0 X{:.5}\nM2\n", x + 1.0),
    )
}

/// A picture of a plate with a gap in the scene.
pub fn scene(text: &str) -> anyhow::Result<()> {
    let machine = shipped_machine("dual-beam-gantry");
    let unit = machine.tracking.expect("it has a tracker");
    let scene = SceneFile::parse("a.toml", text)?;
    let world = RenderedWorld::new(&scene, &unit.cameras, &unit.board.heads()?, 1);
    let (mut camera, tell) = world.camera(0);
    let form = ViewForm::Plate {
        pitch: 0.0,
        roll: 0.0,
        yaw_rad: 0.0,
    };
    let mut picture = Picture::default();
    for (capture, along_mm) in [(1, 10.0), (2, 160.0)] {
        tell.send(FieldOfView::Seam(View {
            along_mm,
            lateral_mm: 0.1,
            height_mm: 0.05,
            form,
        }))?;
        camera.strobed(capture, 5000);
        world.late_us(capture, 0);
        let _: Arrival = camera.next(Duration::from_secs(1), &mut picture)?;
    }
    Ok(())
}

/// What is measured with the calibration.
pub fn calibration(text: &str) -> anyhow::Result<()> {
    let calibration = Calibration::parse("a.toml", text)?;
    calibration.side_measurement(0.1, 0.2, 0.3);
    calibration.camera_step(0.1, 0.2);
    let (rows, columns) = (calibration.optics.rows, calibration.optics.columns);
    let mut detector = detector(&calibration)?;
    if rows.max(columns) <= LARGEST {
        measure(&mut detector, &vec![100; rows * columns])?;
    }
    Ok(())
}

fn detector(calibration: &Calibration) -> anyhow::Result<Detector> {
    let Calibration {
        optics,
        photon_transfer,
        profile,
        ..
    } = *calibration;
    Ok(Detector::new(optics, photon_transfer, profile)?)
}

fn measure(detector: &mut Detector, pixels: &[u8]) -> anyhow::Result<()> {
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let (rows, columns) = (detector.optics().rows, detector.optics().columns);
    detector.measure(&Image::new(pixels, rows, columns)?, &prior)?;
    Ok(())
}

/// What is measured in the picture, by a camera of its size.
pub fn picture(bytes: &[u8]) -> anyhow::Result<()> {
    static MACHINE: LazyLock<MachineFile> = LazyLock::new(|| shipped_machine("dual-beam-gantry"));
    let mut picture = Picture::default();
    parse_grey("a.png", Cursor::new(bytes), &mut picture)?;
    let (rows, columns) = (picture.rows, picture.columns);
    if rows.max(columns) > LARGEST {
        return Ok(());
    }
    let cameras = &MACHINE.tracking.as_ref().expect("it has a tracker").cameras;
    let mut calibration = cameras.nominal(0);
    (calibration.optics.rows, calibration.optics.columns) = (rows, columns);
    measure(&mut detector(&calibration)?, &picture.pixels)
}
