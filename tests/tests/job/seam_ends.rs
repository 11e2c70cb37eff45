//! Plates that begin after the drawn seam does and end before it, a tack that closes the gap: taught through pictures, planned, and
//! welded from there to there.

use super::*;
use dual_beam::{DualBeamPlan, PlanOptions, SeamPoint, TaughtSeams, plan_dual_beam, plan_taught};
use job::{ImageCameras, SeamLesson};
use nalgebra::Vector3;
use std::path::Path;
use std::sync::Mutex;
use teach::seam::{
    Cameras, Ended as Lesson, Head, SeamEnd, SeamFile, SeamPoint as Taught, SeamTeaching, read_seam_points,
};
use world::{CameraChoice, PictureChoice, SceneFile};

/// Where the plates begin, and where they end or a tack begins, on side 1 and 2, from where the drawing begins \[mm\].
const BEGIN: [f64; 2] = [5.3, 5.3];
const END: [f64; 2] = [34.2, 33.7];

fn options() -> PlanOptions {
    PlanOptions {
        title: "rib".into(),
        speed_m_min: 5.0,
        power_w: [2000.0; 2],
        paper: false,
    }
}

/// Both feet straight along X on a flat skin.
fn drawn(machine: &MachineFile) -> DualBeamPlan {
    let foot = |y: f64| (0..=4).map(move |i| Vector3::new(900.0 + 10.0 * f64::from(i), y, 100.0));
    let normal = Vector3::z();
    let main: Vec<SeamPoint> = foot(898.0)
        .map(|position| SeamPoint { position, normal })
        .collect();
    plan_dual_beam(&main, &foot(902.0).collect::<Vec<_>>(), machine, &options()).unwrap()
}

/// What the cameras see: on side 1 plates that begin and end, on side 2 plates that begin and a tack.
fn scene() -> SceneFile {
    let [begin_1, begin_2] = BEGIN;
    let [end_1, end_2] = END;
    let text = format!(
        "[[plate]]\nside = 1\nmissing = true\nto_s_mm = {begin_1}\n\
         [[plate]]\nside = 1\nmissing = true\nfrom_s_mm = {end_1}\n\
         [[plate]]\nside = 2\nmissing = true\nto_s_mm = {begin_2}\n\
         [[tack]]\nside = 2\nwidth_mm = 0.4\nbrightness = 0.7\nfrom_s_mm = {end_2}\n"
    );
    SceneFile::parse("scene.toml", &text).unwrap()
}

/// The real seam lies 0.4 mm beside its drawing.
fn real() -> Arc<Deviation> {
    let text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n-40,0.3,0.2,0.35,-0.15\n100,0.3,0.2,0.35,-0.15\n";
    Arc::new(Deviation::parse("seam.csv", text).unwrap())
}

fn job_before<'a>(machine: &'a MachineFile, program: &'a Program, drawing: &Program) -> Job<'a> {
    let cameras = &machine.tracking.as_ref().unwrap().cameras;
    let pictures = ImageCameras {
        calibrations: cameras.calibrations(Path::new("")).unwrap(),
        kept: None,
        noted: None,
        shown_every: None,
    };
    Job {
        surroundings: Surroundings {
            seam: Some(real()),
            drawing: Some(Arc::new(drawing.clone())),
            cameras: CameraChoice::Images(Box::new(pictures), PictureChoice::Rendered(Box::new(scene()))),
            ..Surroundings::default()
        }
        .into(),
        ..job(machine, program, None)
    }
}

fn teach(machine: &MachineFile, output: &Path) -> Ended {
    let drawing = drawn(machine);
    let cameras = Cameras::of(machine.tracking.as_ref().unwrap()).unwrap();
    let head = Head {
        machine: "dual-beam-gantry".into(),
        part: "rib".into(),
    };
    let opened = SeamFile::open(output, &head, false).unwrap();
    let lesson = SeamLesson {
        start: drawing.stance_before(cameras.heads.camera_lead()),
        drawing: Some(drawing.drawing()),
        config: SeamTeaching {
            // Each millisecond on the way has to be rendered.
            speed_m_min: 5.0,
            ..SeamTeaching::default()
        },
        cameras,
        points: opened.points,
        file: Mutex::new(opened.file),
        head,
        by_jog: false,
    };
    let program = interpret(&drawing.program, Options::default()).unwrap();
    let job = Job {
        work: Work::TeachSeam(&lesson),
        ..job_before(machine, &program, &program)
    };
    let mut boards = SimulatedBoards::default();
    let ended = run(&mut boards, &job, &mut NoOperator).unwrap();
    assert_off(&mut boards);
    ended
}

#[test]
fn a_seam_is_taught_and_welded_from_where_its_plates_begin_to_where_they_end() {
    let machine = machine();
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("taught.csv");
    let lesson = teach(&machine, &output);
    assert!(lesson.error.is_none(), "{:?}", lesson.error);
    let told = lesson.taught.seam.unwrap();
    let Lesson::SeamEnds { ends, missing_mm, .. } = told.ended else {
        panic!("{:?}", told.ended)
    };
    assert_eq!(ends, [Some(SeamEnd::Plate), Some(SeamEnd::Tack)]);
    let missing = missing_mm.unwrap();
    assert!(
        (missing - (40.0 - (END[0] + END[1]) / 2.0)).abs() < 0.03,
        "{missing}"
    );
    let (begins, after) = told.begins.unwrap();
    assert_eq!(begins, [Some(SeamEnd::Plate); 2]);
    assert!((after - BEGIN[0]).abs() < 0.03, "{after}");
    let points = read_seam_points(&output).unwrap();
    let x = |point: &(usize, Taught), side: usize| point.1.feet[side].position.x - 900.0;
    for side in 0..2 {
        let (begin, end) = (x(&points[0], side), x(&points[points.len() - 1], side));
        assert!((begin - BEGIN[side]).abs() < 0.03, "side {side}: {begin}");
        assert!((end - END[side]).abs() < 0.03, "side {side}: {end}");
    }

    let seams = TaughtSeams::through(&points, 0.5).unwrap();
    let taught = plan_taught(&seams, &machine, &options()).unwrap();
    let read = |plan: &DualBeamPlan| interpret(&plan.program, Options::default()).unwrap();
    let (program, drawing) = (read(&taught), read(&drawn(&machine)));
    let mut boards = SimulatedBoards::default();
    let ended = run(
        &mut boards,
        &job_before(&machine, &program, &drawing),
        &mut NoOperator,
    )
    .unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_off(&mut boards);
    for max in ended.evaluation.max_deviation_mm {
        assert!(max.unwrap() <= 0.03, "{:?}", ended.evaluation.max_deviation_mm);
    }
    let length = END[0] - BEGIN[0];
    let welded = ended.report.weld_length_mm;
    assert!((welded - length).abs() < 0.2, "{welded} and not {length} mm");
    assert!(ended.report.unwelded.is_empty(), "{:?}", ended.report.unwelded);
    let from = taught.points[0].pose.position.x - 900.0;
    for side in 0..2 {
        let on = ended.evaluation.ticks.iter().filter(|tick| tick.beams[side]);
        let on: Vec<f64> = on.map(|tick| from + tick.s_mm).collect();
        // A millisecond at 5 m/min.
        assert!((on[0] - BEGIN[side]).abs() < 0.1, "side {side}: {}", on[0]);
        let last = on[on.len() - 1];
        assert!((last - END[side]).abs() < 0.1, "side {side}: {last}");
    }
}
