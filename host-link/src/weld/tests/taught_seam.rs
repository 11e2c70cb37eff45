//! A seam beside its drawing: taught from a wrong start, planned, and welded with tracking on.

use super::*;
use crate::plan::{DualBeamPlan, PlanOptions, TaughtSeams, plan_dual_beam};
use crate::seam::SeamPoint;
use crate::teach::seam::{
    Cameras, Drawing, Ended as Lesson, Head, SeamFile, SeamTeaching, Stance, read_seam_points,
};
use nalgebra::Vector3;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

const LENGTH: f64 = 240.0;
/// The real seam is straight up to here, then it bends for 100 mm with a radius of 400 mm.
const STRAIGHT: f64 = 120.0;

/// The weld of the feet of a 4 mm rib.
fn plan(main: &[SeamPoint], other: &[Vector3<f64>], machine: &MachineFile) -> DualBeamPlan {
    let options = PlanOptions {
        title: "rib".into(),
        speed_m_min: 5.0,
        power_w: [2000.0; 2],
        paper: false,
    };
    plan_dual_beam(main, other, machine, &options).unwrap()
}

/// The drawing: both feet straight along X on a flat skin.
fn drawn(machine: &MachineFile) -> DualBeamPlan {
    let foot = |y: f64| (0..=12).map(move |i| Vector3::new(900.0 + 20.0 * f64::from(i), y, 100.0));
    let normal = Vector3::z();
    let main: Vec<SeamPoint> = foot(898.0)
        .map(|position| SeamPoint { position, normal })
        .collect();
    plan(&main, &foot(902.0).collect::<Vec<_>>(), machine)
}

/// The real rib stands 2 mm to the left of the drawing and 0.6 mm above it, and bends to the left.
fn real() -> Rc<Deviation> {
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
    for row in -80..=600 {
        let s = 0.5 * f64::from(row);
        let bend = (s - STRAIGHT).clamp(0.0, 100.0);
        let left = 2.0 + bend * bend / 800.0 + 0.25 * (s - STRAIGHT - 100.0).max(0.0);
        let up = 0.6;
        let row = [
            s,
            -left * cos - up * sin,
            left * sin - up * cos,
            -left * cos + up * sin,
            -left * sin - up * cos,
        ];
        text += &(row.map(|x| format!("{x:.6}")).join(",") + "\n");
    }
    Rc::new(Deviation::parse("seam.csv", &text).unwrap())
}

fn head() -> Head {
    Head {
        machine: "dual-beam-gantry".into(),
        part: "rib".into(),
    }
}

/// Says that it is enough when the lesson has come to this point.
struct Enough(&'static str, bool);

impl Progress for Enough {
    fn phase(&mut self, text: &str) {
        self.1 |= text == self.0;
    }

    fn travel(&mut self, _done_mm: f64, _length_mm: f64) {}

    fn line(&mut self) -> Option<Line> {
        self.1.then(|| Line::Said("done".into()))
    }
}

/// Teaches into `output`, or goes on there, from a start that is wrong by some mm and degrees.
fn teach(
    machine: &MachineFile,
    drawing: &DualBeamPlan,
    output: &Path,
    progress: &mut dyn Progress,
) -> TaughtSeam {
    let cameras = Cameras::of(machine.tracking.as_ref().unwrap()).unwrap();
    let mut start = Stance::before(drawing, &cameras);
    start.pose = shared::geometry::Pose::new(
        start.pose.position + Vector3::new(-1.5, 1.2, -0.7),
        Vector3::new(1.0, 0.02, 0.01),
        Vector3::new(0.0, 0.03, 1.0),
    )
    .unwrap();
    let opened = SeamFile::open(output, &head(), false).unwrap();
    let lesson = SeamLesson {
        start,
        drawing: Some(Drawing::of(drawing)),
        config: SeamTeaching::default(),
        cameras,
        points: opened.points,
        file: RefCell::new(opened.file),
        head: head(),
        by_jog: false,
    };
    let program = interpret(&drawing.program, Options::default()).unwrap();
    let job = Job {
        work: Work::TeachSeam(&lesson),
        ..beside(machine, &program, &program)
    };
    let interrupted = AtomicBool::new(false);
    let mut boards = SimulatedBoards::default();
    let ended = run(&mut boards, &job, &interrupted, progress).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    assert_off(&mut boards);
    ended.taught.seam.unwrap()
}

/// A job beside the real seam.
fn beside<'a>(machine: &'a MachineFile, program: &'a Program, drawing: &'a Program) -> Job<'a> {
    Job {
        surroundings: Surroundings {
            seam: Some(real()),
            drawing: Some(drawing),
            ..Surroundings::default()
        },
        ..job(machine, program, None)
    }
}

fn fresh() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("seamwright-taught-seam-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("taught.csv");
    if file.exists() {
        std::fs::remove_file(&file).unwrap();
    }
    file
}

#[test]
fn a_seam_taught_from_a_wrong_start_in_two_goes_is_welded_as_well_as_a_drawn_one() {
    let machine = machine();
    let drawing = drawn(&machine);
    let output = fresh();
    let first = teach(
        &machine,
        &drawing,
        &output,
        &mut Enough("teaching point 5", false),
    );
    assert_eq!(first.ended, Lesson::Operator);
    // Something cuts the file in the middle of a row.
    let text = std::fs::read_to_string(&output).unwrap();
    std::fs::write(&output, &text[..text.len() - 30]).unwrap();
    let second = teach(&machine, &drawing, &output, &mut Silent);
    assert_eq!(second.ended, Lesson::Drawn);
    assert!(second.points > first.points);

    let points = read_seam_points(&output).unwrap();
    assert_eq!(points.len(), second.points);
    let x = |place: &Vector3<f64>| place.x - 900.0;
    assert!(x(&points[0].1.middle()).abs() < 0.1, "{}", points[0].1.middle());
    assert!((x(&points[points.len() - 1].1.middle()) - LENGTH).abs() < 0.1);
    let inside = |from: f64, to: f64| {
        let inside = points
            .iter()
            .filter(|(_, p)| (from..to).contains(&x(&p.middle())));
        inside.count() as f64 / (to - from)
    };
    let (straight, bent) = (
        inside(20.0, STRAIGHT - 5.0),
        inside(STRAIGHT + 5.0, STRAIGHT + 95.0),
    );
    assert!(bent > 1.7 * straight, "{straight} and {bent} points a mm");

    let seams = TaughtSeams::through(&points, 0.5).unwrap();
    assert!(
        seams.fit.iter().all(|fit| fit.largest_mm < 0.02),
        "{:?}",
        seams.fit
    );
    let taught = plan(&seams.main, &seams.other, &machine);
    let read = |plan: &DualBeamPlan| interpret(&plan.program, Options::default()).unwrap();
    let (program, of_drawing) = (read(&taught), read(&drawing));
    let job = beside(&machine, &program, &of_drawing);
    let mut boards = SimulatedBoards::default();
    let ended = run(&mut boards, &job, &AtomicBool::new(false), &mut Silent).unwrap();
    assert!(ended.error.is_none(), "{:?}", ended.error);
    for max in ended.evaluation.max_deviation_mm {
        assert!(max.unwrap() <= 0.03, "{:?}", ended.evaluation.max_deviation_mm);
    }
    assert!(ended.report.weld_length_mm > LENGTH);
    std::fs::remove_dir_all(output.parent().unwrap()).unwrap();
}
