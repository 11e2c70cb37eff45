//! How far a camera moves from capture to capture, and pictures that are measured again.

use super::*;
use camera::{Arrival, Camera, CameraError, Folder, Picture, PictureQueue, PictureWriter};
use config::machine::MachineFile;
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};
use world::{FieldOfView, RenderedCamera, RenderedWorld, SceneFile, View, ViewForm};

/// Cameras that see nothing.
struct Blind;

impl Camera for Blind {
    fn strobed(&mut self, _capture: u32, _time_us: u64) {}

    fn next(&mut self, _timeout: Duration, _picture: &mut Picture) -> Result<Arrival, CameraError> {
        Ok(Arrival::Nothing)
    }
}

impl PictureSource for Blind {
    fn open(&mut self, _side: usize) -> Result<Box<dyn Camera>, CameraError> {
        Ok(Box::new(Self))
    }
}

fn images() -> Images {
    let text = include_str!("../../../../machines/dual-beam-gantry.toml");
    let unit = MachineFile::parse("m.toml", text).unwrap().tracking.unwrap();
    let heads = unit.board.heads().unwrap();
    let of = ImageCameras {
        calibrations: std::array::from_fn(|side| unit.cameras.nominal(side)),
        kept: None,
        noted: None,
        shown_every: None,
    };
    Images::begin(&of, Box::new(Blind), &unit, heads).unwrap()
}

fn capture(number: u32, s_mm: f64, u1_mm: f64) -> Capture {
    Capture {
        number,
        time_us: 0,
        motion_time_us: 0,
        s_mm,
        path_id: 1,
        slides_mm: [u1_mm, 0.0, 0.0, 0.0],
        truth_mm: None,
    }
}

/// A bend of 500 mm radius: the camera, 10 mm ahead, swings out.
fn pose(s: f64) -> Pose {
    let (sin, cos) = (s / 500.0).sin_cos();
    Pose {
        position: Vector3::new(500.0 * sin, 500.0 * (1.0 - cos), 0.0),
        tangent: Vector3::new(cos, sin, 0.0),
        normal: Vector3::z(),
    }
}

#[test]
fn a_camera_moves_with_path_bend_and_slides() {
    let mut images = images();
    images.strobe(capture(0, 0.0, 0.0), 0, Some(pose(0.0)));
    let moved = images.moved(0, &pose(0.75), &capture(1, 0.75, 0.2)).unwrap();
    // Camera 1 looks along the skin's normal, u to the left: the bend swings it left by 10 mm · 0.75 / 500 + 0.0006,
    // the slide carries it by U, 30° off the skin, to the right and down.
    let (sin, cos) = 30f64.to_radians().sin_cos();
    assert!((moved.travel_mm - 0.75).abs() < 0.01, "{moved:?}");
    assert!(
        (moved.lateral_mm - (0.0144 - 0.2 * cos)).abs() < 1e-3,
        "{moved:?}"
    );
    assert!((moved.height_mm.abs() - 0.2 * sin).abs() < 1e-3, "{moved:?}");
}

#[test]
fn nothing_is_known_of_a_way_that_is_too_far_or_begins_nowhere() {
    let mut images = images();
    let way = |images: &Images, s: f64| images.moved(0, &pose(s), &capture(2, s, 0.0));
    images.strobe(capture(0, 30.0, 0.0), 0, None);
    assert_eq!(way(&images, 30.0), None);
    images.strobe(capture(1, 30.0, 0.0), 5_000, Some(pose(30.0)));
    assert!(way(&images, 30.75).is_some());
    assert_eq!(way(&images, 40.0), None);
}

/// What comes of 60 strobes of a camera; `tell` is called after each.
fn seen(camera: Box<dyn Camera>, unit: &TrackingUnit, tell: impl Fn(u32)) -> Vec<MeasuredStrobe> {
    seen_by(camera, unit, 0.0, Moved::default(), tell)
}

/// The same of a camera that is so much further ahead than the tracker was told, and moves on before it exposes.
fn seen_by(
    camera: Box<dyn Camera>,
    unit: &TrackingUnit,
    ahead_mm: f64,
    goes_on: Moved,
    tell: impl Fn(u32),
) -> Vec<MeasuredStrobe> {
    let calibration = unit.cameras.nominal(0);
    let (optics, noise) = (calibration.optics, calibration.photon_transfer);
    let detector = Detector::new(optics, noise, calibration.profile).unwrap();
    let observer = Observer::new(detector, ObserverConfig::default(), Joint::Gap);
    let geometry = Geometry {
        calibration,
        ahead_mm,
        reach_mm: 0.9,
    };
    let worker = Worker::start(0, camera, observer, geometry, Looks::Always, None);
    let strobe = |capture: u32| {
        let way = Moved {
            travel_mm: 0.4,
            ..Moved::default()
        };
        worker.strobe(Strobe {
            capture,
            time_us: 5_000 * u64::from(capture),
            moved: Some(way),
            goes_on,
            ends: false,
            passed_over: false,
        });
        tell(capture);
        worker.wait(PATIENCE).unwrap()
    };
    (0..60).map(strobe).collect()
}

/// What the camera sees at one of these strobes, of work that is so much too high \[mm\].
fn view(capture: u32, height_mm: f64) -> FieldOfView {
    let along_mm = 0.4 * f64::from(capture);
    FieldOfView::Seam(View {
        along_mm,
        lateral_mm: 0.1 * (0.3 * along_mm).sin(),
        height_mm,
        form: ViewForm::Plate {
            pitch: 0.0,
            roll: 0.01,
            yaw_rad: 0.0,
        },
    })
}

/// The tracking unit of the shipped machine, and the rendered camera of its side 1.
fn rendered(scene: &SceneFile) -> (TrackingUnit, RenderedCamera, Sender<FieldOfView>) {
    let text = include_str!("../../../../machines/dual-beam-gantry.toml");
    let unit = MachineFile::parse("m.toml", text).unwrap().tracking.unwrap();
    let heads = unit.board.heads().unwrap();
    let (camera, tell) = RenderedWorld::new(scene, &unit.cameras, &heads, 1).camera(0);
    (unit, camera, tell)
}

/// The map of the tracker reaches only some pictures ahead of the spot.
#[test]
fn after_a_while_without_the_seam_its_place_is_told_from_the_first_picture_on() {
    let (unit, camera, tell) = rendered(&SceneFile::default());
    let unseen = 30..36;
    let all = seen(Box::new(camera), &unit, |capture| {
        let height_mm = if unseen.contains(&capture) { 5.0 } else { 0.05 };
        tell.send(view(capture, height_mm)).unwrap();
    });
    for strobe in &all[3..] {
        let should = !unseen.contains(&strobe.capture);
        assert_eq!(strobe.seen.is_some(), should, "{strobe:?}");
        assert_eq!(strobe.measurement.is_some(), should, "{strobe:?}");
    }
}

/// The tracker latches where the camera is at the strobe, and has one lead for both.
#[test]
fn what_is_seen_counts_for_where_the_camera_was_at_the_strobe() {
    let goes_on = Moved {
        travel_mm: 0.3,
        lateral_mm: 0.02,
        height_mm: -0.01,
    };
    let run = |ahead_mm, goes_on| {
        let (unit, camera, tell) = rendered(&SceneFile::default());
        let all = seen_by(Box::new(camera), &unit, ahead_mm, goes_on, |capture| {
            tell.send(view(capture, 0.05)).unwrap();
        });
        (unit, all)
    };
    let (unit, plain) = run(0.0, Moved::default());
    let (_, late) = run(0.2, goes_on);
    let map = unit.cameras.nominal(0).slides;
    let [u, v] = map.deltas(0.02, -0.01);
    let mut compared = 0;
    for (plain, late) in plain.iter().zip(&late) {
        assert_eq!(plain.observation, late.observation);
        for (plain, late) in [
            (plain.measurement, late.measurement),
            (plain.seen.map(|seen| seen.here), late.seen.map(|seen| seen.here)),
        ] {
            let (Some(plain), Some(late)) = (plain, late) else {
                continue;
            };
            compared += 1;
            assert!((late.along_mm - plain.along_mm - 0.5).abs() < 1e-12);
            assert!((late.delta_u_mm - plain.delta_u_mm - u).abs() < 1e-12);
            assert!((late.delta_v_mm - plain.delta_v_mm - v).abs() < 1e-12);
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn what_was_kept_is_measured_again_to_the_same_figures() {
    let (unit, camera, tell) = rendered(&SceneFile {
        lost_share: 0.1,
        ..SceneFile::default()
    });
    let folder = std::env::temp_dir().join(format!("seamwright-kept-{}", std::process::id()));
    let queue = PictureQueue::default();
    let writer = PictureWriter::start(&folder, queue.clone()).unwrap();
    let first = seen(
        Box::new(RecordingCamera::new(Box::new(camera), queue)),
        &unit,
        |capture| tell.send(view(capture, 0.05)).unwrap(),
    );
    let kept = writer.end();
    assert!(kept.error.is_none() && kept.dropped == 0, "{kept:?}");
    let arrived = first.iter().filter(|seen| seen.observation.is_some());
    assert_eq!(kept.pictures, arrived.count() as u32);
    assert!((40..60).contains(&kept.pictures), "{kept:?}");
    let again = seen(Box::new(Folder::open(&folder).unwrap()), &unit, |_| {});
    let contents = |seen: &[MeasuredStrobe]| -> Vec<_> {
        seen.iter()
            .map(|seen| (seen.capture, seen.observation, seen.measurement))
            .collect()
    };
    assert_eq!(contents(&first), contents(&again));
    let measured = first.iter().filter(|seen| seen.measurement.is_some()).count();
    assert!(measured > 40, "{measured}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Simulated cameras that lose every picture at once, or never answer; which of them were wanted.
#[derive(Clone, Default)]
struct Asked {
    answers: bool,
    strobed: VecDeque<u32>,
    wanted: Arc<Mutex<Vec<u32>>>,
}

impl Camera for Asked {
    fn strobed(&mut self, capture: u32, _time_us: u64) {
        self.strobed.push_back(capture);
    }

    fn next(&mut self, _timeout: Duration, _picture: &mut Picture) -> Result<Arrival, CameraError> {
        let next = self.strobed.pop_front().filter(|_| self.answers);
        Ok(next.map_or(Arrival::Nothing, |capture| Arrival::Lost { capture }))
    }
}

impl PictureSource for Asked {
    fn open(&mut self, _side: usize) -> Result<Box<dyn Camera>, CameraError> {
        Ok(Box::new(self.clone()))
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn tell(
        &mut self,
        side: usize,
        capture: &Capture,
        _at: Option<(&MachineGeometry, &MachinePosition)>,
        wanted: bool,
    ) {
        if wanted && side == 0 {
            self.wanted.lock().unwrap().push(capture.number);
        }
    }
}

/// The captures, 5 ms apart, whose pictures anybody looks at where they are only shown, every 100 ms. Where the camera
/// `answers`, the next strobe waits for it.
fn shown(answers: bool) -> Vec<u32> {
    let text = include_str!("../../../../machines/dual-beam-gantry.toml");
    let file = MachineFile::parse("m.toml", text).unwrap();
    let machine = MachineGeometry::build(&file.motion).unwrap();
    let unit = file.tracking.unwrap();
    let of = ImageCameras {
        calibrations: std::array::from_fn(|side| unit.cameras.nominal(side)),
        kept: None,
        noted: None,
        shown_every: Some(Duration::from_millis(100)),
    };
    let source = Asked {
        answers,
        ..Asked::default()
    };
    let wanted = Arc::clone(&source.wanted);
    let mut images = Images::begin(&of, Box::new(source), &unit, unit.board.heads().unwrap()).unwrap();
    for number in 0..=60 {
        let strobe_us = 5_000 * u64::from(number);
        images.strobe(capture(number, 0.0, 0.0), strobe_us, None);
        loop {
            // Long after it was due: whoever waited for it would wait here.
            let at = Moment {
                machine: &machine,
                now_us: strobe_us + 10_000_000,
                position: &|_| None,
            };
            assert!(images.answer(at).unwrap().is_none());
            if !answers || images.sides.iter().all(|side| side.waiting.is_empty()) {
                break;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(images.next_due_us(), None);
    }
    wanted.lock().unwrap().clone()
}

#[test]
fn pictures_that_are_only_shown_are_thinned_and_never_waited_for() {
    assert_eq!(shown(true), [0, 20, 40, 60]);
    // One that does not come keeps others from being made, and nobody from anything.
    assert_eq!(shown(false), [0]);
}
