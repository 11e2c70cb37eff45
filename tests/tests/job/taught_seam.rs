//! A seam beside its drawing: taught from a wrong start, planned, and welded with tracking on.

use super::*;
use dual_beam::{DualBeamPlan, PlanOptions, SeamPoint, TaughtSeams, plan_dual_beam};
use job::{ImageCameras, SeamLesson};
use nalgebra::Vector3;
use std::path::Path;
use std::sync::Mutex;
use teach::seam::{
    Cameras, Ended as Lesson, Head, SeamFile, SeamPoint as Taught, SeamTeaching, read_seam_points,
};
use world::{CameraChoice, PictureChoice};

/// How long the real seam bends to the left, and its radius there \[mm\].
const BEND: f64 = 100.0;
const RADIUS: f64 = 400.0;

/// What is taught and welded.
struct Case {
    machine: MachineFile,
    cameras: CameraChoice,
    config: SeamTeaching,
    /// Of the drawing \[mm\].
    length: f64,
    /// The real seam is straight up to here, then it bends \[mm\].
    straight: f64,
    /// How far the tip begins from where it should, by the drawing \[mm\].
    start: [f64; 3],
}

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

impl Case {
    /// The drawing: both feet straight along X on a flat skin.
    fn drawn(&self) -> DualBeamPlan {
        let count = (self.length / 20.0) as i32;
        let foot = |y: f64| (0..=count).map(move |i| Vector3::new(900.0 + 20.0 * f64::from(i), y, 100.0));
        let normal = Vector3::z();
        let main: Vec<SeamPoint> = foot(898.0)
            .map(|position| SeamPoint { position, normal })
            .collect();
        plan(&main, &foot(902.0).collect::<Vec<_>>(), &self.machine)
    }

    /// The real rib stands 2 mm to the left of the drawing and 0.6 mm above it, is 1 mm thicker, and bends to the left.
    fn real(&self) -> Arc<Deviation> {
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
        for row in -80..=600 {
            let s = 0.5 * f64::from(row);
            let bend = (s - self.straight).clamp(0.0, BEND);
            let beyond = (s - self.straight - BEND).max(0.0);
            let first = 2.0 + (bend / 2.0 + beyond) * bend / RADIUS;
            let second = first + 1.0;
            let up = 0.6;
            let row = [
                s,
                -first * cos - up * sin,
                first * sin - up * cos,
                -second * cos + up * sin,
                -second * sin - up * cos,
            ];
            text += &(row.map(|x| format!("{x:.6}")).join(",") + "\n");
        }
        Arc::new(Deviation::parse("seam.csv", &text).unwrap())
    }

    /// A job beside the real seam.
    fn job<'a>(&'a self, program: &'a Program, drawing: &'a Program) -> Job<'a> {
        Job {
            surroundings: Surroundings {
                seam: Some(self.real()),
                drawing: Some(Arc::new(drawing.clone())),
                cameras: self.cameras.clone(),
                ..Surroundings::default()
            }
            .into(),
            ..job(&self.machine, program, None)
        }
    }

    /// Teaches into `output`, or continues there, from a start that is wrong by some mm and degrees.
    fn teach(&self, output: &Path, operator: &mut dyn Operator) -> Ended {
        let drawing = self.drawn();
        let cameras = Cameras::of(self.machine.tracking.as_ref().unwrap()).unwrap();
        let mut start = drawing.stance_before(cameras.heads.camera_lead());
        start.pose = shared::geometry::Pose::new(
            start.pose.position + Vector3::from(self.start),
            Vector3::new(1.0, 0.02, 0.01),
            Vector3::new(0.0, 0.03, 1.0),
        )
        .unwrap();
        let opened = SeamFile::open(output, &head(), false).unwrap();
        let lesson = SeamLesson {
            start,
            drawing: Some(drawing.drawing()),
            config: self.config,
            cameras,
            points: opened.points,
            file: Mutex::new(opened.file),
            head: head(),
            by_jog: false,
        };
        let program = interpret(&drawing.program, Options::default()).unwrap();
        let job = Job {
            work: Work::TeachSeam(&lesson),
            ..self.job(&program, &program)
        };
        let mut boards = SimulatedBoards::default();
        let ended = run(&mut boards, &job, operator).unwrap();
        assert_off(&mut boards);
        ended
    }

    /// Plans what was taught into `output`, and welds it with tracking on.
    fn weld(&self, output: &Path) -> Ended {
        let points = read_seam_points(output).unwrap();
        let seams = TaughtSeams::through(&points, 0.5).unwrap();
        assert!(
            seams.fit.iter().all(|fit| fit.largest_mm < 0.02),
            "{:?}",
            seams.fit
        );
        let taught = plan(&seams.main, &seams.other, &self.machine);
        let read = |plan: &DualBeamPlan| interpret(&plan.program, Options::default()).unwrap();
        let (program, of_drawing) = (read(&taught), read(&self.drawn()));
        let job = self.job(&program, &of_drawing);
        let mut boards = SimulatedBoards::default();
        run(&mut boards, &job, &mut NoOperator).unwrap()
    }

    /// From its beginning to its end as drawn, and denser where it bends; welded as well as a drawn one.
    fn assert_taught_and_welded(&self, output: &Path) {
        let points = read_seam_points(output).unwrap();
        let x = |point: &(usize, Taught)| point.1.middle().x - 900.0;
        let (first, last) = (&points[0], &points[points.len() - 1]);
        assert!(x(first).abs() < 0.1, "{}", x(first));
        assert!((x(last) - self.length).abs() < 0.1, "{}", x(last));
        let longest = |from: f64, to: f64| {
            let steps = points.windows(2).map(|pair| [x(&pair[0]), x(&pair[1])]);
            let inside = steps.filter(|step| step[0] >= from && step[1] <= to);
            inside.map(|step| step[1] - step[0]).fold(0.0, f64::max)
        };
        let straight = longest(0.0, self.straight + 1.0);
        let bent = longest(self.straight + 5.0, self.straight + BEND);
        assert!(straight > 1.4 * bent && bent > 1.0, "{straight} and {bent} mm");

        let ended = self.weld(output);
        assert!(ended.error.is_none(), "{:?}", ended.error);
        for max in ended.evaluation.max_deviation_mm {
            assert!(max.unwrap() <= 0.03, "{:?}", ended.evaluation.max_deviation_mm);
        }
        let (bend, beyond) = (
            BEND.min(self.length - self.straight),
            self.length - self.straight - BEND,
        );
        let slope = bend / RADIUS;
        let length = self.length + slope * slope * (bend / 6.0 + beyond.max(0.0) / 2.0);
        let welded = ended.report.weld_length_mm;
        assert!((welded - length).abs() < 0.25, "{welded} and not {length} mm");
    }
}

fn head() -> Head {
    Head {
        machine: "dual-beam-gantry".into(),
        part: "rib".into(),
    }
}

/// Says that it is enough when the lesson has come to this point.
struct Enough(Phase);

impl Operator for Enough {
    fn event(&mut self, event: &Event, remote: &Remote) {
        if let Event::Phase(phase) = event
            && *phase == self.0
        {
            remote.send(Command::Answer("done".into())).unwrap();
        }
    }
}

/// The operator presses Ctrl-C when the lesson has come to this point.
struct Stops(Phase);

impl Operator for Stops {
    fn event(&mut self, event: &Event, remote: &Remote) {
        if let Event::Phase(phase) = event
            && *phase == self.0
        {
            remote.send(Command::Stop).unwrap();
        }
    }
}

#[test]
fn a_seam_taught_from_a_wrong_start_in_two_goes_is_welded_as_well_as_a_drawn_one() {
    let case = Case {
        machine: machine(),
        cameras: CameraChoice::Geometric,
        config: SeamTeaching::default(),
        length: 240.0,
        straight: 120.0,
        start: [-1.5, 1.2, -0.7],
    };
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("taught.csv");
    let mut enough = Enough(Phase::TeachingSeam { number: 5 });
    let taught = case.teach(&output, &mut enough).taught;
    let first = taught.seam.unwrap();
    assert_eq!(first.ended, Lesson::Operator);
    // Something cuts the file in the middle of a row.
    let text = std::fs::read_to_string(&output).unwrap();
    std::fs::write(&output, &text[..text.len() - 30]).unwrap();
    let second = case.teach(&output, &mut NoOperator);
    assert!(second.error.is_none(), "{:?}", second.error);
    let second = second.taught.seam.unwrap();
    assert_eq!(second.ended, Lesson::Drawn);
    assert!(second.points > first.points);
    assert_eq!(read_seam_points(&output).unwrap().len(), second.points);
    case.assert_taught_and_welded(&output);
}

/// Cameras see a band 0.4 mm deep and 1.4 mm wide: no place of the machine has both seams in it.
#[test]
fn a_seam_is_taught_and_welded_through_pictures_as_well_after_an_interruption() {
    let machine = machine();
    let cameras = &machine.tracking.as_ref().unwrap().cameras;
    let pictures = ImageCameras {
        calibrations: cameras.calibrations(Path::new("")).unwrap(),
        kept: None,
        noted: None,
        shown_every: None,
    };
    let case = Case {
        cameras: CameraChoice::Images(Box::new(pictures), PictureChoice::Rendered(Box::default())),
        config: SeamTeaching {
            // Each millisecond on the way has to be rendered.
            speed_m_min: 5.0,
            ..SeamTeaching::default()
        },
        machine,
        length: 60.0,
        straight: 30.0,
        start: [-1.0, 1.2, 0.3],
    };
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("taught.csv");
    let first = case.teach(&output, &mut Stops(Phase::TeachingSeam { number: 4 }));
    assert!(
        matches!(first.error, Some(JobError::Interrupted)),
        "{:?}",
        first.error
    );
    assert_eq!(read_seam_points(&output).unwrap().len(), 3);
    let second = case.teach(&output, &mut NoOperator);
    assert!(second.error.is_none(), "{:?}", second.error);
    assert_eq!(second.taught.seam.unwrap().ended, Lesson::Drawn);
    case.assert_taught_and_welded(&output);
}
