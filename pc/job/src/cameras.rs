//! What a job needs to know of what sees the seams.

use crate::images::ImagesError;
use crate::joint::SeenSeam;
use camera::{Camera, CameraError, OpenCamera};
use host_link::boards::Waker;
use host_link::events::Events;
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use serde::Serialize;
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::protocol::{Capture, Measurement, MotionSample};

/// The cameras of a session, whatever they are: captures in, measurements out.
pub trait SeamCameras: Send {
    /// Who waits for answers is woken by `waker`, if by anything; pictures are told by `events`.
    fn attach(&mut self, _waker: Option<Waker>, _events: &Events) {}

    /// Takes a capture of the tracker board; `strobe_us` is when by the motion board's clock, `pose` what was planned for
    /// that time, if it is known.
    fn strobe(&mut self, capture: Capture, strobe_us: u64, pose: Option<Pose>);

    /// Takes what the motion board told, tick by tick.
    fn motion(&mut self, _samples: &[MotionSample]) {}

    /// From now on answers tell, or do not tell, where the seams end in the pictures that are strobed.
    fn look_for_ends(&mut self, _wanted: bool) {}

    /// When the next answer is due by the motion board's clock \[µs\]; `None` if nothing is waited for.
    fn next_due_us(&self) -> Option<u64>;

    /// The next answer, if there is one now.
    ///
    /// # Errors
    /// [`ImagesError`] where a camera gives no pictures any more.
    fn answer(&mut self, at: Moment) -> Result<Option<Answer>, ImagesError>;

    /// Captures without an answer, since nothing was known of their time.
    fn given_up(&self) -> u32;

    /// What became of the pictures of each camera; `None` without pictures.
    fn figures(&self) -> Option<[CameraFigures; SIDES]>;
}

/// What is known when cameras are asked for their answers.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The machine.
    pub machine: &'a MachineGeometry,
    /// The motion board's clock now \[µs\].
    pub now_us: u64,
    /// Where the machine was at a time of that clock, if the boards have told.
    pub position: &'a dyn Fn(u64) -> Option<MachinePosition>,
}

/// An answer to a capture.
#[derive(Clone, Debug)]
pub struct Answer {
    /// For the tracker board.
    pub measurement: Measurement,
    /// What was seen in the pictures, where there are some.
    pub seams: [Option<SeenSeam>; SIDES],
    /// When the later of its pictures was here, by the motion board's clock \[µs\]; a rendered one not before it is due. `None`
    /// without pictures, and where time stands still while they are waited for.
    pub arrived_us: Option<u64>,
}

impl From<Measurement> for Answer {
    fn from(measurement: Measurement) -> Self {
        Self {
            measurement,
            seams: [None; SIDES],
            arrived_us: None,
        }
    }
}

/// What became of the pictures of a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CameraFigures {
    /// Strobes.
    pub pictures: u32,
    /// Pictures with a seam that was believed.
    pub measured: u32,
    /// Pictures with a seam that was not where or as it should be.
    pub refused: u32,
    /// Pictures that arrived and showed no seam, as all that are taken away from the work.
    pub without_seam: u32,
    /// Pictures that never arrived.
    pub lost: u32,
    /// Pictures that arrived late.
    pub late: u32,
    /// Times that the seam was believed at another place or width from then on.
    pub relocked: u32,
}

/// Where the pictures of both cameras come from.
pub trait PictureSource: Send {
    /// Opens the camera of a side (0 or 1); the tracker board does not strobe yet.
    ///
    /// # Errors
    /// [`CameraError`].
    fn open(&mut self, side: usize) -> Result<Box<dyn Camera>, CameraError>;

    /// Whether the pictures are made of where the machine truly was: then each is due after the time that a real camera and
    /// computer would take, and is waited for. Pictures of real cameras are never waited for.
    fn is_simulated(&self) -> bool {
        false
    }

    /// How long after the strobe of `capture` the simulated camera of `side` exposes \[µs\].
    fn delay_us(&self, _capture: u32, _side: usize) -> u64 {
        0
    }

    /// Tells simulated cameras what the motion board told, tick by tick: what was burnt can then be seen.
    fn motion(&mut self, _samples: &[MotionSample]) {}

    /// How much later than others a simulated picture comes \[µs\].
    fn late_us(&self, _capture: u32, _side: usize) -> u64 {
        0
    }

    /// Tells the simulated camera of `side` where the machine truly was when it exposed for `capture`; `None` if nobody knows any
    /// more. A picture that is not `wanted` may be lost.
    fn tell(
        &mut self,
        _side: usize,
        _capture: &Capture,
        _at: Option<(&MachineGeometry, &MachinePosition)>,
        _wanted: bool,
    ) {
    }
}

/// Real cameras, as the machine file names them.
impl PictureSource for OpenCamera {
    fn open(&mut self, side: usize) -> Result<Box<dyn Camera>, CameraError> {
        self(side)
    }
}
