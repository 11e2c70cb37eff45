//! The thread that turns the pictures of one camera into measurements.

use super::ends::SeamEnds;
use super::shown;
use super::sightings::{Sighting, SightingLog};
use crate::joint::{SeenEnd, SeenSeam};
use camera::{Arrival, Camera, CameraError, Picture};
use config::calibration::Calibration;
use host_link::boards::Waker;
use host_link::events::Events;
use shared::protocol::SideMeasurement;
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use vision::{DetectorError, ImageError, Moved, Observation, Observer};

/// How long a camera is waited for before new captures are looked for.
const PATIENCE: Duration = Duration::from_millis(2);

/// A strobe of the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strobe {
    pub capture: u32,
    /// By the motion board's clock \[µs\].
    pub time_us: u64,
    /// How far the camera moved since the strobe before; `None` if what was seen before tells nothing any more.
    pub moved: Option<Moved>,
    /// How far it moves from the strobe to the exposure.
    pub goes_on: Moved,
    /// Whether it is asked where the seam ends in its picture.
    pub ends: bool,
    /// Nobody looks at its picture, nor is it shown.
    pub passed_over: bool,
}

/// The result of one strobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredStrobe {
    /// Number of the capture.
    pub capture: u32,
    /// What the picture says; `None` if it was lost.
    pub observation: Option<Observation>,
    /// The seam, if it is believed, and where this picture shows it.
    pub seen: Option<SeenSeam>,
    /// What the tracker is told: the mean of the latest pictures, or each of the first of a seam that is found, or found again.
    pub measurement: Option<SideMeasurement>,
    /// When its picture had arrived here, or was known to be lost.
    pub arrived: Instant,
}

/// Why there are no more measurements. Reads as one sentence.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The camera has trouble.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// Its pictures cannot be measured.
    #[error(transparent)]
    Detector(#[from] DetectorError),
    /// Its pictures are none.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The tracker would believe nothing that is seen so far from where it was told.
    #[error(
        "its calibration says that it is {is_mm:.3} mm ahead of its spot, and the machine file says {told_mm:.3}: put that lead, or the mean of both cameras, into camera_lead_mm"
    )]
    Lead {
        /// By the calibration \[mm\].
        is_mm: f64,
        /// By the machine file \[mm\].
        told_mm: f64,
    },
    /// The thread is gone, or hangs.
    #[error("the thread that measures its pictures has ended: please report this, with the command line")]
    Gone,
}

/// Where answers and pictures are announced.
struct Outlet {
    waker: Option<Waker>,
    events: Events,
}

/// How a camera's pictures lie to what the tracker knows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry {
    pub calibration: Calibration,
    /// How much further ahead it is than the tracker was told \[mm\].
    pub ahead_mm: f64,
    /// How far ahead of it the tracker believes what it is told \[mm\].
    pub reach_mm: f64,
}

/// At which pictures anybody looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Looks {
    /// At all of them.
    Always,
    /// At those in which ends are asked for.
    ForEnds,
    /// At none.
    Never,
}

impl Looks {
    fn at(self, ends: bool) -> bool {
        match self {
            Self::Always => true,
            Self::ForEnds => ends,
            Self::Never => false,
        }
    }
}

/// A camera, its observer, and a thread for both.
pub(super) struct Worker {
    outlet: Arc<OnceLock<Outlet>>,
    looks: Looks,
    strobes: Option<Sender<Strobe>>,
    answers: Receiver<Result<MeasuredStrobe, WorkerError>>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread.
    pub fn start(
        side: usize,
        camera: Box<dyn Camera>,
        observer: Observer,
        geometry: Geometry,
        looks: Looks,
        noted: Option<SightingLog>,
    ) -> Self {
        let (strobes, told) = channel();
        let (answer, answers) = channel();
        let outlet = Arc::<OnceLock<Outlet>>::default();
        let mut work = Work {
            side,
            outlet: Arc::clone(&outlet),
            camera,
            observer,
            geometry,
            looks,
            noted,
            waiting: VecDeque::new(),
            moved: Some(Moved::default()),
            picture: Picture::default(),
            ends: SeamEnds::new(geometry.reach_mm),
        };
        let thread = std::thread::spawn(move || {
            // The end of the session is no error.
            if let Err(error) = work.run(&told, &answer) {
                drop(answer.send(Err(error)));
                work.wake();
            }
        });
        Self {
            outlet,
            looks,
            strobes: Some(strobes),
            answers,
            thread: Some(thread),
        }
    }

    /// Answers and pictures are announced there from now on.
    pub fn attach(&self, waker: Option<Waker>, events: &Events) {
        let events = events.clone();
        // A session has one.
        let _ = self.outlet.set(Outlet { waker, events });
    }

    /// Whether it looks at a picture, in which ends are asked for or not.
    pub fn wants(&self, ends: bool) -> bool {
        self.looks.at(ends)
    }

    /// Tells of a strobe. If the thread has ended, its error is the next answer.
    pub fn strobe(&self, strobe: Strobe) {
        if let Some(strobes) = &self.strobes {
            let _ = strobes.send(strobe);
        }
    }

    /// The next answer, which there is exactly one of for every strobe, in their order.
    pub fn wait(&self, timeout: Duration) -> Result<MeasuredStrobe, WorkerError> {
        self.answers
            .recv_timeout(timeout)
            .unwrap_or(Err(WorkerError::Gone))
    }

    /// The next answer, if it is there.
    pub fn poll(&self) -> Result<Option<MeasuredStrobe>, WorkerError> {
        match self.answers.try_recv() {
            Ok(answer) => answer.map(Some),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(WorkerError::Gone),
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.strobes = None;
        if let Some(thread) = self.thread.take() {
            // A panic in it was told there.
            drop(thread.join());
        }
    }
}

/// What the thread has.
struct Work {
    side: usize,
    outlet: Arc<OnceLock<Outlet>>,
    camera: Box<dyn Camera>,
    observer: Observer,
    geometry: Geometry,
    looks: Looks,
    noted: Option<SightingLog>,
    /// Strobes without an answer.
    waiting: VecDeque<Strobe>,
    /// Since the last picture that arrived.
    moved: Option<Moved>,
    picture: Picture,
    ends: SeamEnds,
}

impl Work {
    /// Goes on until nobody strobes or listens any more.
    fn run(
        &mut self,
        strobes: &Receiver<Strobe>,
        answer: &Sender<Result<MeasuredStrobe, WorkerError>>,
    ) -> Result<(), WorkerError> {
        loop {
            let next = if self.waiting.is_empty() {
                strobes.recv().map_err(|_| RecvTimeoutError::Disconnected)
            } else {
                strobes.recv_timeout(Duration::ZERO)
            };
            match next {
                Ok(strobe) => {
                    self.camera.strobed(strobe.capture, strobe.time_us);
                    self.waiting.push_back(strobe);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            let arrival = self.camera.next(PATIENCE, &mut self.picture)?;
            let at = Instant::now();
            let capture = match arrival {
                Arrival::Nothing => continue,
                Arrival::Picture => self.picture.capture,
                Arrival::Lost { capture } => capture,
            };
            // A camera that never answered a strobe has lost its picture.
            while let Some(strobe) = self.waiting.pop_front() {
                self.note(strobe.moved);
                let arrived = strobe.capture == capture && arrival == Arrival::Picture && !strobe.passed_over;
                let seen = if arrived {
                    self.look(at, &strobe)?
                } else {
                    MeasuredStrobe {
                        capture: strobe.capture,
                        observation: None,
                        seen: None,
                        measurement: None,
                        arrived: at,
                    }
                };
                if answer.send(Ok(seen)).is_err() {
                    return Ok(());
                }
                self.wake();
                if let (true, Some(outlet)) = (arrived, self.outlet.get()) {
                    let optics = &self.geometry.calibration.optics;
                    shown::tell(&outlet.events, self.side, &self.picture, &seen, optics);
                }
                if strobe.capture == capture {
                    break;
                }
            }
        }
    }

    /// Whoever waits for the answer looks at once.
    fn wake(&self) {
        if let Some(waker) = self.outlet.get().and_then(|outlet| outlet.waker.as_ref()) {
            waker.wake();
        }
    }

    /// Sums up how far the camera moved.
    fn note(&mut self, moved: Option<Moved>) {
        self.moved = match (self.moved, moved) {
            (Some(sum), Some(more)) => Some(Moved {
                travel_mm: sum.travel_mm + more.travel_mm,
                lateral_mm: sum.lateral_mm + more.lateral_mm,
                height_mm: sum.height_mm + more.height_mm,
            }),
            (None, _) | (_, None) => None,
        };
    }

    /// Measures the picture of `strobe` that arrived at `arrived`, and looks for ends of the seam in it if they are asked for.
    fn look(&mut self, arrived: Instant, strobe: &Strobe) -> Result<MeasuredStrobe, WorkerError> {
        let moved = self.moved.replace(Moved::default());
        if !self.looks.at(strobe.ends) {
            return Ok(MeasuredStrobe {
                capture: self.picture.capture,
                observation: None,
                seen: None,
                measurement: None,
                arrived,
            });
        }
        if moved.is_none() {
            self.observer.forget();
            self.ends.forget();
        }
        let moved = moved.unwrap_or_default();
        let observation = self.observer.observe(&self.picture.image()?, moved)?;
        let seen_ends = if strobe.ends {
            self.ends.look(self.observer.detector(), &observation, &moved)
        } else {
            self.ends.forget();
            [None; 2]
        };
        if let Some(noted) = &self.noted {
            noted.push(Sighting {
                capture: self.picture.capture,
                status: observation.report.status,
                measured: observation.report.seam().copied(),
                ends: seen_ends,
            });
        }
        // Seen from where the camera was at the strobe, of which the tracker knows where it was.
        let Strobe { goes_on, .. } = strobe;
        let to_side = |(lateral, travel, height)| {
            self.geometry.calibration.side_measurement(
                lateral + goes_on.lateral_mm,
                travel + goes_on.travel_mm + self.geometry.ahead_mm,
                height + goes_on.height_mm,
            )
        };
        let both = observation.seam.zip(observation.report.measured);
        let seen = both.map(|(seam, measured)| SeenSeam {
            seam,
            here: to_side((seam.lateral_mm, seam.travel_mm, measured.height_mm)),
            ends: seen_ends.map(|end| {
                let end = end?;
                Some(SeenEnd {
                    kind: end.kind,
                    here: to_side((end.lateral_mm, end.travel_mm, end.height_mm)),
                })
            }),
        });
        // Before there is a mean its own place, a little less exactly: who has not seen the seam for a while has to know where it
        // is at once.
        let place = both.map(|(seam, measured)| match seam.mean {
            Some(mean) => (mean.lateral_mm, mean.travel_mm, mean.height_mm),
            None => (seam.lateral_mm, seam.travel_mm, measured.height_mm),
        });
        Ok(MeasuredStrobe {
            capture: self.picture.capture,
            observation: Some(observation),
            seen,
            measurement: self
                .ends
                .told(place, observation.seam.is_some(), &moved)
                .map(to_side),
            arrived,
        })
    }
}
