//! Cameras outside of the session: their frames come late, unasked and numbered by the camera, some never.

use super::*;
use camera::{Arrival, Camera, CameraError, Match, Matching, Picture, Strobe};
use host_link::geometry::MachineGeometry;
use host_link::record::Record;
use job::ImageCameras;
use shared::io::SIDES;
use shared::protocol::Capture;
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Condvar, Mutex};
use world::{
    CameraChoice, FieldOfView, PictureChoice, RenderedCamera, RenderedWorld, SceneFile, Standpoint,
    TrueSeams, View,
};

/// So many strobes later a frame is with the session at the latest.
const LATE: u64 = 4;
/// Every such frame is lost on its way.
const LOST: u64 = 37;
/// Longest wait for a frame that is on its way.
const PATIENCE: Duration = Duration::from_secs(60);

/// Waves from the run-in on, which the cameras can see without a search.
fn waves() -> Arc<Deviation> {
    let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
    for s in (-60..=220).map(f64::from) {
        let wave = (s / 100.0 * std::f64::consts::TAU).sin();
        text += &format!(
            "{s},{},{},{},{}\n",
            0.3 * wave,
            0.15 * wave,
            -0.2 * wave,
            -0.1 * wave
        );
    }
    Arc::new(Deviation::parse("waves.csv", &text).unwrap())
}

/// What the wire to a camera does where a beam has come to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wire {
    /// Nothing: it stays.
    Whole,
    /// No frame comes any more, without an error.
    Silent { side: usize, from_s_mm: f64 },
    /// The camera reports that it was lost.
    Gone { side: usize, from_s_mm: f64 },
}

/// How many frames the session has measured, or has no need of.
#[derive(Default)]
struct Done(Mutex<u64>, Condvar);

impl Done {
    fn set(&self, frame: u64) {
        *self.0.lock().unwrap() = frame;
        self.1.notify_all();
    }

    fn wait(&self, frame: u64) {
        let done = self.0.lock().unwrap();
        let waited = self.1.wait_timeout_while(done, PATIENCE, |done| *done < frame);
        let over = waited.unwrap().1;
        assert!(!over.timed_out(), "frame {frame} is not measured");
    }
}

/// A frame as it comes from a camera.
enum Frame {
    Of { number: u64, picture: Picture },
    Gone,
}

/// The session's end of a camera.
struct Outside {
    matching: Matching,
    frames: Receiver<Frame>,
    /// Came before its strobe was notified.
    early: Option<(u64, Picture)>,
    given: u64,
    done: Arc<Done>,
}

impl Camera for Outside {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        self.matching.strobed(Strobe { capture, time_us });
    }

    fn next(&mut self, timeout: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        self.done.set(self.given);
        if let Some(capture) = self.matching.lost() {
            return Ok(Arrival::Lost { capture });
        }
        let (number, pixels) = match self.early.take() {
            Some(early) => early,
            None => match self.frames.recv_timeout(timeout) {
                Ok(Frame::Of { number, picture }) => (number, picture),
                Ok(Frame::Gone) => {
                    return Err(CameraError::Gone {
                        camera: "192.168.10.12".to_owned(),
                        reason: "its cable was cut".to_owned(),
                    });
                }
                Err(RecvTimeoutError::Timeout) => return Ok(Arrival::Nothing),
                Err(RecvTimeoutError::Disconnected) => panic!("the world has ended before the session"),
            },
        };
        match self.matching.frame(number) {
            Match::Of(strobe) => {
                self.given = number;
                *picture = pixels;
                (picture.capture, picture.time_us) = (strobe.capture, strobe.time_us);
                Ok(Arrival::Picture)
            }
            Match::After(capture) => {
                self.early = Some((number, pixels));
                Ok(Arrival::Lost { capture })
            }
            Match::NotYet => {
                self.early = Some((number, pixels));
                Ok(Arrival::Nothing)
            }
            Match::Stray => panic!("every strobe is told"),
        }
    }
}

impl Drop for Outside {
    fn drop(&mut self) {
        self.done.set(u64::MAX);
    }
}

/// The world's end of a camera.
struct Lens {
    strobes: Sender<(u64, FieldOfView)>,
    frames: Sender<Frame>,
    done: Arc<Done>,
}

/// A camera, both ends of it, and a thread that takes its pictures.
fn camera(camera: (RenderedCamera, Sender<FieldOfView>)) -> (Lens, Outside) {
    let (mut rendered, tell) = camera;
    let (strobes, strobed) = channel();
    let (frames, came) = channel();
    let to_session = frames.clone();
    std::thread::spawn(move || {
        for (number, field_of_view) in strobed {
            rendered.strobed(number as u32, 5_000 * number);
            tell.send(field_of_view).unwrap();
            let mut picture = Picture::default();
            let taken = rendered.next(PATIENCE, &mut picture).unwrap();
            assert_eq!(taken, Arrival::Picture);
            // A session that has ended hears nothing.
            if number % LOST != 0 && to_session.send(Frame::Of { number, picture }).is_err() {
                return;
            }
        }
    });
    let done = Arc::<Done>::default();
    let lens = Lens {
        strobes,
        frames,
        done: done.clone(),
    };
    let outside = Outside {
        matching: Matching::default(),
        frames: came,
        early: None,
        given: 0,
        done,
    };
    (lens, outside)
}

/// Simulated boards, and a world that sees what they send to the PC.
struct World {
    boards: SimulatedBoards,
    file: MachineFile,
    machine: MachineGeometry,
    seams: TrueSeams,
    record: Record,
    lenses: [Lens; SIDES],
    /// Strobes of which it is not known yet where the machine was.
    strobed: VecDeque<Capture>,
    /// Strobes so far; cameras count their frames from 1.
    frames: u64,
    wire: Wire,
    cut: Option<usize>,
}

impl World {
    /// A world with the cameras of `machine` before the seams that deviate from `program`, and the session's cameras.
    fn new(file: &MachineFile, program: &Program, wire: Wire) -> (Self, [Outside; SIDES]) {
        let unit = file.tracking.as_ref().unwrap();
        let heads = unit.board.heads().unwrap();
        let planner = Planner::build(file).unwrap();
        let paths = planner
            .program(program, &file.planning.park_axes(), None)
            .unwrap();
        let rendered = RenderedWorld::new(&SceneFile::default(), &unit.cameras, &heads, 1);
        let [(lens_1, camera_1), (lens_2, camera_2)] = [0, 1].map(|side| camera(rendered.camera(side)));
        let world = Self {
            boards: SimulatedBoards::default(),
            file: file.clone(),
            machine: MachineGeometry::build(&file.motion).unwrap(),
            seams: TrueSeams::beside(heads, &paths, &waves()),
            record: Record::default(),
            lenses: [lens_1, lens_2],
            strobed: VecDeque::new(),
            frames: 0,
            wire,
            cut: None,
        };
        (world, [camera_1, camera_2])
    }

    fn see(&mut self, datagram: &Datagram) {
        match datagram {
            Datagram::Capture(capture) => self.strobed.push_back(*capture),
            Datagram::MotionTelemetry(telemetry) => {
                self.record.add_motion(&telemetry.samples);
                let beam_at = |from: f64| telemetry.samples.iter().any(|s| s.beams[0] && s.s_mm >= from);
                match self.wire {
                    Wire::Silent { side, from_s_mm } if beam_at(from_s_mm) => self.cut = Some(side),
                    Wire::Gone { side, from_s_mm } if self.cut.is_none() && beam_at(from_s_mm) => {
                        self.cut = Some(side);
                        self.lenses[side].frames.send(Frame::Gone).unwrap();
                    }
                    Wire::Whole | Wire::Silent { .. } | Wire::Gone { .. } => {}
                }
                self.photograph();
            }
            _ => {}
        }
    }

    /// Takes the pictures of the strobes of which it is known by now where the machine was.
    fn photograph(&mut self) {
        while let Some(capture) = self.strobed.front() {
            let Some((position, _)) = self.record.machine_at(capture.motion_time_us) else {
                return;
            };
            self.frames += 1;
            let slides = capture.truth_mm.expect("simulated slides");
            for (side, lens) in self.lenses.iter().enumerate() {
                if self.cut == Some(side) {
                    continue;
                }
                let cameras = &self.file.tracking.as_ref().unwrap().cameras;
                let standpoint = Standpoint {
                    side,
                    slides_mm: [slides[2 * side], slides[2 * side + 1]],
                    lead_mm: self.seams.heads().camera_lead(),
                    turned: 0.0,
                };
                let view = View::of(cameras, &self.machine, &self.seams, None, &position, &standpoint);
                let field_of_view = view.map_or(FieldOfView::Nothing, FieldOfView::Seam);
                lens.strobes.send((self.frames, field_of_view)).unwrap();
            }
            self.strobed.pop_front();
        }
    }
}

impl Boards for World {
    pass_on!(boards: request, send, now, identity, path_states_target);

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        // Time continues only if the pictures keep pace; the boards are much faster than the cameras.
        for (side, lens) in self.lenses.iter().enumerate() {
            if self.cut != Some(side) {
                lens.done.wait(self.frames.saturating_sub(LATE));
            }
        }
        let received = self.boards.receive(timeout)?;
        if let Some((_, datagram)) = &received {
            self.see(datagram);
        }
        Ok(received)
    }
}

/// Welds with cameras that are outside; a session without the true seam does not judge its distance.
fn weld_outside(wire: Wire, told: Option<Arc<Deviation>>) -> (Ended, World) {
    let machine = machine();
    let program = interpret(PROGRAM, Options::default()).unwrap();
    let (mut world, cameras) = World::new(&machine, &program, wire);
    let cameras = Mutex::new(cameras.map(Some));
    let open = move |side: usize| -> Result<Box<dyn Camera>, CameraError> {
        let camera = cameras.lock().unwrap()[side].take();
        Ok(Box::new(camera.expect("each is opened once")))
    };
    let unit = machine.tracking.as_ref().unwrap();
    let mut job = job(&machine, &program, None);
    let images = ImageCameras {
        calibrations: std::array::from_fn(|side| unit.cameras.nominal(side)),
        kept: None,
        noted: None,
        shown_every: None,
    };
    job.surroundings = Surroundings {
        cameras: CameraChoice::Images(Box::new(images), PictureChoice::Real(Arc::new(open))),
        ..around(told)
    }
    .into();
    let ended = run(&mut world, &job, &mut NoOperator).unwrap();
    (ended, world)
}

#[test]
fn a_seam_is_followed_in_frames_that_come_late_unasked_and_not_all() {
    let (ended, _) = weld_outside(Wire::Whole, Some(waves()));
    assert!(ended.error.is_none(), "{:?}\n{}", ended.error, ended.report);
    let seam = seam_of(&ended.report);
    for (slide, most) in ended.evaluation.max_deviation_mm.iter().enumerate() {
        let most = most.expect("welded");
        assert!(most <= 0.03, "slide {slide}: {most} mm\n{}", ended.report);
    }
    for figures in seam.pictures.expect("pictures") {
        // Only the last few may not have come.
        let lost = figures.pictures / LOST as u32;
        assert!((lost - 1..=lost + 1).contains(&figures.lost), "{figures:?}");
        assert!(figures.measured > 400 && figures.late == 0, "{figures:?}");
    }
}

#[test]
fn nobody_has_to_tell_where_a_seam_is_that_real_cameras_see() {
    let (ended, _) = weld_outside(Wire::Whole, None);
    assert!(ended.error.is_none(), "{:?}\n{}", ended.error, ended.report);
    assert_eq!(ended.evaluation.max_deviation_mm, [None; 4]);
    assert_eq!(ended.evaluation.unknown_ticks, 0);
    let accepted = seam_of(&ended.report).measurements.accepted;
    assert!(accepted.iter().all(|count| *count > 400), "{accepted:?}");
}

#[test]
fn a_camera_that_falls_silent_ends_the_weld_with_its_side_named_and_the_machine_at_rest() {
    let silent = Wire::Silent {
        side: 1,
        from_s_mm: 100.0,
    };
    let (ended, mut world) = weld_outside(silent, Some(waves()));
    let Some(error @ JobError::Tracker(TrackerFault::LostSeam { side: 1, .. })) = &ended.error else {
        panic!("{:?}", ended.error);
    };
    assert!(error.to_string().contains("side 2 lost the seam"), "{error}");
    assert_stopped_on_path(&ended, 130.0);
    assert_off(&mut world);
}

#[test]
fn a_camera_that_is_gone_ends_the_weld_with_its_name_and_the_machine_at_rest() {
    let gone = Wire::Gone {
        side: 1,
        from_s_mm: 100.0,
    };
    let (ended, mut world) = weld_outside(gone, Some(waves()));
    let error = ended.error.as_ref().expect("a camera is gone").to_string();
    assert_eq!(
        error,
        "camera 2: camera 192.168.10.12 was lost: its cable was cut; check its power and its cable, then restart the \
         job"
    );
    assert_stopped_on_path(&ended, 130.0);
    assert_off(&mut world);
}
