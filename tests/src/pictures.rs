//! The shipped weld by what cameras see in rendered pictures.

use crate::{
    COMMISSIONED_FILE, MACHINE, NoOperator, Sleeper, job, machine, prediction, program, shipped,
    shipped_seam, with_seam,
};
use config::machine::{JointForm, MachineFile};
use host_link::boards::Boards;
use job::{ImageCameras, Job, JobError};
use plant_file::PlantFile;
use report::Ended;
use shared::io::SIDES;
use shared::state::TrackerFault;
use std::path::Path;
use world::{CameraChoice, Dark, Deviation, PictureChoice, SceneFile, Surroundings, TrueMachine};

/// Noise of welds of which one is enough.
pub(crate) const SEED: u64 = 1;

/// Where the light of side 2 fails \[mm\], and how far before it its beam may go off: at 9 m/min a picture is taken every
/// 0.75 mm, the mean of four lies behind the last, and a permit is withdrawn 0.9 mm before its beam has to be off.
const DARK_FROM_MM: f64 = 200.0;
const BEFORE_MM: f64 = 4.0;
/// Largest deviation of the blind spot while its beam is on \[mm\].
const BLIND_DEVIATION_MM: f64 = 0.1;

/// What closed corners change in the shipped machine's file (docs/commissioning.md): the heads are 30° off the skin's normal,
/// the bisector of skin and rib is 45° off it, and walls take more room in a picture than a gap does.
const CORNER_CAMERAS: [(&str, &str); 4] = [
    ("joint = \"gap\"", "joint = \"corner\""),
    ("mount_deg = [-30.0, 30.0]", "mount_deg = [15.0, -15.0]"),
    ("magnification = 2.0", "magnification = 3.0"),
    ("view_mm = [0.5, 0.45]", "view_mm = [0.3, 0.18]"),
];

/// The shipped machine, or what closed corners make of it.
pub(crate) fn machine_for(joint: JointForm) -> MachineFile {
    if joint == JointForm::Gap {
        return machine();
    }
    let mut text = std::fs::read_to_string(shipped(MACHINE)).expect("the shipped machine");
    for (from, to) in CORNER_CAMERAS {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    MachineFile::parse("corners.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// Welds the shipped program along the shipped seam by pictures of `scene`.
pub fn weld_through_pictures(
    boards: &mut dyn Boards,
    joint: JointForm,
    scene: SceneFile,
    speed_m_per_min: f64,
) -> Ended {
    let weld = |job: &Job| prediction::run(boards, job);
    through_pictures(joint, scene, shipped_seam(), speed_m_per_min, SEED, weld)
}

/// The same along a gap by the commissioned machine file, on boards that are wired to `plant`.
pub fn weld_commissioned(boards: &mut dyn Boards, plant: &PlantFile, speed_m_per_min: f64) -> Ended {
    let file = shipped(COMMISSIONED_FILE);
    let machine = MachineFile::read(&file).unwrap_or_else(|error| panic!("{error}"));
    let surroundings = Surroundings {
        seed: SEED,
        truth: TrueMachine::new(plant, &machine).unwrap_or_else(|error| panic!("{error}")),
        ..with_seam(Some(shipped_seam()))
    };
    let folder = file.parent().expect("a folder");
    let weld = |job: &Job| prediction::run(boards, job);
    by_pictures(
        (&machine, folder),
        SceneFile::default(),
        surroundings,
        speed_m_per_min,
        weld,
    )
}

/// The same along a gap, of which a subscriber of events gets each second one at most; and how many it lost.
pub fn weld_before_a_sleeper(boards: &mut dyn Boards, speed_m_per_min: f64) -> (Ended, u64) {
    let mut sleeper = Sleeper::default();
    let weld = |job: &Job| crate::run(boards, job, &mut sleeper).unwrap_or_else(|error| panic!("{error}"));
    let ended = through_pictures(
        JointForm::Gap,
        SceneFile::default(),
        shipped_seam(),
        speed_m_per_min,
        SEED,
        weld,
    );
    (ended, sleeper.end())
}

/// Welds by pictures of `scene` along `seam`.
pub(crate) fn through_pictures(
    joint: JointForm,
    scene: SceneFile,
    seam: Deviation,
    speed_m_per_min: f64,
    seed: u64,
    weld: impl FnOnce(&Job) -> Ended,
) -> Ended {
    let surroundings = Surroundings {
        seed,
        ..with_seam(Some(seam))
    };
    let of = (&machine_for(joint), Path::new(""));
    by_pictures(of, scene, surroundings, speed_m_per_min, weld)
}

/// Welds by pictures of `scene` in `surroundings` with a machine, whose cameras have their calibrations in `folder` if it has any.
fn by_pictures(
    (machine, folder): (&MachineFile, &Path),
    scene: SceneFile,
    surroundings: Surroundings,
    speed_m_per_min: f64,
    weld: impl FnOnce(&Job) -> Ended,
) -> Ended {
    let cameras = &machine.tracking.as_ref().expect("a tracker").cameras;
    let calibrations = cameras.calibrations(folder);
    let images = ImageCameras {
        calibrations: calibrations.unwrap_or_else(|error| panic!("{error}")),
        kept: None,
        noted: None,
        shown_every: None,
    };
    let surroundings = Surroundings {
        cameras: CameraChoice::Images(Box::new(images), PictureChoice::Rendered(Box::new(scene))),
        ..surroundings
    };
    weld(&job(machine, &program(), surroundings, Some(speed_m_per_min)))
}

/// The same with spatter, scratches, roll, lost and late pictures and a dark spell, as in the shipped scene.
///
/// # Panics
/// If no picture was lost or none was late on a side.
pub fn weld_disturbed(boards: &mut dyn Boards, joint: JointForm, speed_m_per_min: f64) -> Ended {
    let ended = weld_through_pictures(boards, joint, disturbed(), speed_m_per_min);
    let seam = ended.report.seam.as_ref().expect("a tracker");
    for figures in seam.pictures.expect("pictures") {
        assert!(figures.lost > 0 && figures.late > 0, "{figures:?}");
    }
    ended
}

/// The same along gaps at 9 m/min, with other spatter, noise, lost and late pictures for every `seed`.
pub fn weld_disturbed_by(seed: u64, boards: &mut dyn Boards) -> Ended {
    let weld = |job: &Job| crate::run(boards, job, &mut NoOperator).unwrap_or_else(|error| panic!("{error}"));
    through_pictures(JointForm::Gap, disturbed(), shipped_seam(), 9.0, seed, weld)
}

fn disturbed() -> SceneFile {
    let file = shipped("programs/t-seam-400-disturbed.toml");
    SceneFile::read(&file).unwrap_or_else(|error| panic!("{error}"))
}

/// Checks that a weld in which the light of side 2 fails for good ends with its side named, its beam off before
/// it comes there, and the machine at rest.
///
/// # Panics
/// Where it is not so.
pub fn assert_stops_in_the_dark(boards: &mut dyn Boards, joint: JointForm, speed_m_per_min: f64) {
    let dark = Dark {
        side: 2,
        from_s_mm: DARK_FROM_MM,
        for_ms: None,
    };
    let scene = SceneFile {
        dark: vec![dark],
        ..SceneFile::default()
    };
    let ended = weld_through_pictures(boards, joint, scene, speed_m_per_min);
    let Some(error @ JobError::Tracker(TrackerFault::LostSeam { side: 1, .. })) = &ended.error else {
        panic!("{:?}", ended.error);
    };
    assert!(error.to_string().contains("side 2"), "{error}");
    let ticks = &ended.evaluation.ticks;
    let welded = || ticks.iter().filter(|tick| tick.beams[1]);
    let off_mm = welded().last().expect("a weld").along_mm;
    println!("beam 2 off at {off_mm:.1} mm");
    assert!(
        (DARK_FROM_MM - BEFORE_MM..DARK_FROM_MM).contains(&off_mm),
        "beam 2 on to {off_mm} mm"
    );
    let last = ticks.iter().last().expect("ticks");
    assert_eq!(last.beams, [false; SIDES]);
    assert!(last.speed_mm_s < 1.0, "{}", last.speed_mm_s);
    let deviation = welded()
        .filter_map(|tick| tick.deviation_mm[2])
        .fold(0.0, |max: f64, mm| max.max(mm.abs()));
    assert!(
        deviation < BLIND_DEVIATION_MM,
        "spot 2 was {deviation} mm off with its beam on"
    );
}
