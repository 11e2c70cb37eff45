//! Events of a running job, for any number of subscribers.

mod phase;
mod stream;

pub use phase::{Next, Phase, Question};
pub use stream::{Events, Interest, NoEvent, Received, Subscription};

use serde::{Deserialize, Serialize};
use shared::protocol::{
    Capture, Identity, Measurement, MotionSample, MotionStatus, SideMeasurement, TrackerSample, TrackerStatus,
};
use shared::state::{Fault, TrackerFault};
use std::sync::Arc;
use std::time::Duration;

/// Something that happened in a job, or that a board reported.
#[derive(Clone, Debug)]
pub enum Event {
    /// The boards are connected.
    Connected {
        /// The motion board.
        motion: Option<Identity>,
        /// The tracker board, where the machine has one.
        tracker: Option<Identity>,
    },
    /// The state of the boards, some times a second.
    Status {
        /// The motion board.
        motion: Box<MotionStatus>,
        /// The tracker board, where the machine has one; its latest answer.
        tracker: Option<TrackerStatus>,
    },
    /// Ticks of the motion board, oldest first.
    MotionSamples(Arc<[MotionSample]>),
    /// Ticks of the tracker board, oldest first.
    TrackerSamples(Arc<[TrackerSample]>),
    /// The tracker board has strobed the cameras.
    Capture(Capture),
    /// A picture, and what was measured in it. Only for subscribers with an interest in pictures.
    Picture(Arc<MeasuredPicture>),
    /// A measurement has gone to the tracker board.
    Measurement {
        /// What was sent.
        measurement: Measurement,
        /// When the cameras were strobed, and when it was sent, by the motion board's clock \[µs\].
        strobe_us: u64,
        /// See `strobe_us`.
        sent_us: u64,
    },
    /// A new part of the job begins.
    Phase(Phase),
    /// The machine is on a path.
    Progress {
        /// How far it is along the path \[mm\].
        done_mm: f64,
        /// Length of the path \[mm\].
        length_mm: f64,
    },
    /// The machine stands until a command answers this.
    Question(Question),
    /// An answer to what the operator asked in a lesson.
    Message(String),
    /// The motion board has stopped the machine.
    MotionFault(Fault),
    /// The tracker board has stopped the weld, or wants the beams off.
    TrackerFault(TrackerFault),
    /// The job has ended.
    End {
        /// Why it ended early, as a sentence.
        error: Option<String>,
        /// How long it took, by the clock of the boards' session.
        duration: Duration,
    },
}

/// What [`Event::End`] says where the operator has stopped the job.
pub const STOPPED: &str = "stopped by the operator; beams are off and the machine is at rest";

impl Event {
    /// Whether many of its kind come every second. A subscriber that is slow loses the oldest of these; all others
    /// are never lost.
    pub fn is_sample(&self) -> bool {
        match self {
            Self::Status { .. }
            | Self::MotionSamples(_)
            | Self::TrackerSamples(_)
            | Self::Capture(_)
            | Self::Picture(_)
            | Self::Measurement { .. }
            | Self::Progress { .. } => true,
            Self::Connected { .. }
            | Self::Phase(_)
            | Self::Question(_)
            | Self::Message(_)
            | Self::MotionFault(_)
            | Self::TrackerFault(_)
            | Self::End { .. } => false,
        }
    }
}

/// A picture of one camera, 8 bits a pixel, and what was measured in it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredPicture {
    /// The camera, 0 or 1.
    pub side: usize,
    /// Number of the capture.
    pub capture: u32,
    /// Rows of pixels, from the top.
    pub rows: usize,
    /// Pixels a row.
    pub columns: usize,
    /// The pixels, row after row.
    pub pixels: Vec<u8>,
    /// The seam, if one is accepted.
    pub seam: Option<SeamInPicture>,
    /// Where the seam is from the spot, as the tracker is told it.
    pub measurement: Option<SideMeasurement>,
    /// How sharp it is.
    pub focus: Focus,
}

/// How sharp a picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Focus {
    /// Nothing is sharp, or nobody has looked.
    #[default]
    Nothing,
    /// Nothing is sharp: the work is higher than what the picture shows.
    TooHigh,
    /// Nothing is sharp: the work is lower than what the picture shows.
    TooLow,
    /// There is a sharp band.
    Band {
        /// Energy of its texture over the noise.
        contrast: f64,
        /// n of the seam: how far it is out of focus, towards the camera, where one is measured \[mm\].
        defocus_mm: Option<f64>,
    },
}

/// A seam in a picture, in the camera's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeamInPicture {
    /// Across travel, u \[mm\].
    pub lateral_mm: f64,
    /// Along travel, a \[mm\].
    pub travel_mm: f64,
    /// Out of the work, n, in the mean of the latest pictures \[mm\].
    pub height_mm: Option<f64>,
    /// Width of a gap \[mm\]; 0 of a closed corner.
    pub width_mm: f64,
    /// 0…1.
    pub quality: f64,
    /// Where the edges of the seam are in the picture, each from one end to the other: \[row, column\] from the top left pixel's
    /// middle. A closed corner has the same twice.
    pub edges: [[[f32; 2]; 2]; 2],
}
